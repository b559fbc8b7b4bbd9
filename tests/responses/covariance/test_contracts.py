"""What a route needs is checked: symmetry, proof of damping, a share of the road for every stiffness."""

import dataclasses

import numpy as np
import pytest

import susp_ss as ss
from models import ROADS, VEHICLES


def with_feedback(K=0.0, C=0.0, shared=True):
    """A full car whose heave is pushed by its pitch: no symmetry remains."""

    class Fed(ss.FullCar):
        def assemble(self):
            model = super().assemble()
            heave, pitch = (model.layout.coordinates.index(name) for name in ("z_b", "theta"))
            pushed = np.zeros(model.K.shape[-2:])
            pushed[heave, pitch] = 1.0
            K_in = model.K_in + K * pushed @ model.G if shared else model.K_in
            return dataclasses.replace(model, K=model.K + K * pushed, C=model.C + C * pushed, K_in=K_in)

    return Fed


@pytest.mark.parametrize("feedback", [{"C": 5000.0}, {"C": -5000.0}, {"K": 60e3}, {"K": -40e3, "C": 3000.0}], ids=str)
@pytest.mark.parametrize("road", ["identical", "isotropic", "independent, cut-off"])
@pytest.mark.parametrize("corners", ["alike", "unequal"])
def test_matrices_without_symmetry_get_the_right_answer(feedback, road, corners):
    unequal = {} if corners == "alike" else {"ks": ss.Corners(fr=16e3, fl=18e3, rr=21e3, rl=24e3)}
    car, plain = with_feedback(**feedback)(**unequal), ss.FullCar(**unequal)
    assert not car.assemble().symmetric
    assert plain.assemble().symmetric
    exact, before = ss.ride_metrics(car, ROADS[road]), ss.ride_metrics(plain, ROADS[road])
    spectral = ss.ride_metrics(car, ROADS[road], method="spectral")
    for name, data in spectral.items():
        np.testing.assert_allclose(
            exact[name], data, rtol=1e-3 if "isotropic" in road else 1e-6, atol=1e-12, err_msg=name
        )
    assert float(abs(exact.bacc / before.bacc - 1.0).max()) > 3e-3


def test_matrices_without_symmetry_by_the_time_route():
    car, road = with_feedback(K=60e3, C=4000.0)(), ss.Road(tracks="isotropic")
    exact = ss.ride_metrics(car, road)
    simulated = ss.ride_metrics(car, road, method="time", duration=400.0, seed=1)
    for name, data in exact.items():
        assert (abs(simulated[name] - data) <= 5.0 * simulated[f"{name}_stderr"]).all(), name


def test_a_stiffness_without_its_share_of_the_road_is_refused():
    for method in ("covariance", "spectral", "time"):
        with pytest.raises(ValueError, match="feels the height of the road"):
            ss.ride_metrics(with_feedback(K=20e3, shared=False)(), ss.Road(), method=method)


def test_an_unstable_feedback_is_refused():
    with pytest.raises(ValueError, match="has a mode that no damper reaches"):
        ss.ride_metrics(with_feedback(C=-3e5)(), ss.Road())


def test_natural_frequencies_without_symmetry():
    """Of ``det(K - w^2 M) = 0``, by the determinant itself."""
    car = with_feedback(K=60e3)()
    model = car.assemble()
    for frequency in car.natural_frequencies():
        near = [
            np.linalg.det((model.K - (w * frequency * 2 * np.pi) ** 2 * np.diag(model.m)) / 1e5)
            for w in (0.999, 1.0, 1.001)
        ]
        assert abs(near[1]) < 1e-6 * max(abs(near[0]), abs(near[2]))


def test_sensitivities_without_symmetry():
    kind = with_feedback(K=30e3, C=2000.0)
    slope = ss.sensitivity(kind(), ss.Road(tracks="independent"), ["cs"]).bacc.squeeze("parameter")
    up, down = (ss.ride_metrics(kind(cs=1516.5 + h), ss.Road(tracks="independent")).bacc for h in (0.1, -0.1))
    np.testing.assert_allclose(slope, (up - down) / 0.2, rtol=1e-6)


@pytest.mark.parametrize("vehicle", VEHICLES.values(), ids=VEHICLES)
def test_a_vehicle_s_own_matrices_are_proved_damped_and_a_changed_copy_is_not(vehicle):
    model = vehicle.assemble()
    assert model.symmetric
    assert model.damped.all()
    assert dataclasses.replace(model, C=model.C).damped is None
    assert not dataclasses.replace(model, C=model.C).unstable()
    assert dataclasses.replace(model, C=-model.C).unstable()
