"""Moments of spectra against closed forms, a matrix logarithm and dense integrals of the oracle's spectra."""

import numpy as np
import pytest
import scipy.linalg

import models
import oracles
import susp_ss as ss
from susp_ss.responses.covariance.spectral_moments import spectral_moments
from susp_ss.responses.excitation import spanned


def moments(vehicle, road):
    """By name of the output: m0, m1, m2, m4 of one design."""
    space, flat, ground = spanned(vehicle, road)
    table = vehicle.layout().outputs
    rows = np.arange(len(table))[table.public]
    found = spectral_moments(flat, space, ground, rows, np.arange(space.size))
    return {table.names[row]: np.array([m[0, i] for m in found]) for i, row in enumerate(rows)}


def dense(vehicle, road):
    f = np.geomspace(1e-4, 1e7, 16001)
    levelled = 1.0 + (2.0 * np.pi * f / road.speed * road.contact_length) ** 2
    spectra = oracles.psd(models.oracle(vehicle), models.oracle_road(road), f)
    return {
        name: [np.trapezoid(S / levelled * (2.0 * np.pi * f) ** k * f, np.log(f)) for k in (0, 1, 2, 4)]
        for name, S in spectra.items()
    }


CASES = {
    "quarter": (ss.QuarterCar(), ss.Road(contact_length=0.1)),
    "quarter, tyre damping": (ss.QuarterCar(ct=150.0), ss.Road(contact_length=0.1)),
    "quarter, waviness": (ss.QuarterCar(), ss.Road(contact_length=0.15, waviness=2.5)),
    "pitch half, cut-off": (ss.PitchHalfCar(ks=(16e3, 22e3)), ss.Road(contact_length=0.1, cutoff=0.02)),
    "full, independent": (ss.FullCar(**models.UNEQUAL), ss.Road(contact_length=0.1, tracks="independent", cutoff=0.01)),
    "full, isotropic": (ss.FullCar(arb_front=1e4), ss.Road(contact_length=0.1, tracks="isotropic")),
}
# Outputs that have these moments; the others have none, as a rate of the road's velocity is in them.
FINITE = {"bacc": 4, "sws": 4, "dtl": 3}


@pytest.mark.parametrize("case", CASES)
def test_moments_are_the_integrals_of_spectra(case):
    vehicle, road = CASES[case]
    found, integrals = moments(vehicle, road), dense(vehicle, road)
    # The fit of the coherence is good to 1e-4, and so are trapezia where axles interfere ever faster.
    rtol = 5e-4 if road.tracks == "isotropic" else 2e-4
    for name, own in found.items():
        kind = name.partition("_")[0]
        if kind not in FINITE:
            continue
        known = FINITE[kind] - (2 if "damping" in case and kind == "dtl" else "damping" in case and kind == "bacc")
        np.testing.assert_allclose(own[:known], integrals[name][:known], rtol=rtol, err_msg=name)
        assert np.isinf(own[known:]).all(), name


def test_a_quarter_car_has_the_moments_of_closed_forms():
    car, road = ss.QuarterCar(), ss.Road()
    q = road.intensity
    m0, _, m2, m4 = moments(car, road)["sws"]
    assert m0 == pytest.approx(oracles.quarter_deflection_variance(car.ms, car.mu, car.cs, q), rel=1e-12)
    assert m2 == pytest.approx(oracles.quarter_deflection_rate_variance(car.cs, car.kt, q), rel=1e-12)
    assert np.isfinite(m4)
    assert np.isinf(moments(car, road)["dtl"][1:]).all()


@pytest.mark.parametrize("cs", [300.0, 1500.0, 9000.0])
def test_the_first_moment_is_a_matrix_logarithm(cs):
    # With R(t) = y e^(A t) X y' the first moment is -(2/pi) int R'(t)/t dt = (2/pi) y A ln(-A) X y'.
    car, road = ss.QuarterCar(cs=cs), ss.Road()
    A = np.array(
        [
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [-(car.ks + car.kt) / car.mu, car.ks / car.mu, -cs / car.mu, cs / car.mu],
            [car.ks / car.ms, -car.ks / car.ms, cs / car.ms, -cs / car.ms],
        ]
    )
    b = np.array([-1.0, -1.0, 0.0, 0.0])
    X = scipy.linalg.solve_continuous_lyapunov(A, -road.intensity * np.outer(b, b))
    found = moments(car, road)
    for name, y in {"sws": np.array([1.0, -1.0, 0.0, 0.0]), "bacc": A[3]}.items():
        m1 = 2.0 / np.pi * y @ A @ np.real(scipy.linalg.logm(-A)) @ X @ y
        assert found[name][1] == pytest.approx(m1, rel=2e-9), name


def test_designs_and_systems_have_the_moments_of_one_by_one():
    cs, road = np.array([800.0, 2200.0]), ss.Road(contact_length=0.1)
    space, flat, ground = spanned(ss.QuarterCar(cs=cs), road)
    together = spectral_moments(flat, space, ground, np.arange(3), np.arange(2))
    for i, one in enumerate(cs):
        alone = list(moments(ss.QuarterCar(cs=float(one)), road).values())
        np.testing.assert_allclose([m[i] for m in together], np.transpose(alone), rtol=1e-9)
    car = ss.PitchHalfCar(cs=(1200.0, 1700.0))
    of_system = moments(ss.LinearVehicle(car.state_space(input="velocity"), like=car), road)
    for name, own in moments(car, road).items():
        np.testing.assert_allclose(of_system[name], own, rtol=1e-7, err_msg=name)
