"""Spectra in one-third octaves: integrals over each band, their sum, and the limits of 1985 as printed."""

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import quad

import susp_ss as ss
from susp_ss.metrics.third_octaves import BANDS, FATIGUE, reduced_comfort

POINTS = {"driver": (0.3, 0.4)}
ROAD = ss.Road(tracks="isotropic")

# Vertical RMS acceleration in m/s^2 by one-third octave, 8 h, fatigue-decreased proficiency: ISO 2631:1974, table 1.
PRINTED = {
    1.0: 0.63, 1.25: 0.56, 1.6: 0.50, 2.0: 0.45, 2.5: 0.40, 3.15: 0.355, 4.0: 0.315, 5.0: 0.315, 6.3: 0.315, 8.0: 0.315,
    10.0: 0.40, 12.5: 0.50, 16.0: 0.63, 20.0: 0.80, 25.0: 1.0, 31.5: 1.25, 40.0: 1.60, 50.0: 2.0, 63.0: 2.5, 80.0: 3.15,
}  # fmt: skip


@pytest.mark.parametrize("band", [0, 11, 18, 30])
def test_a_band_is_its_integral(band):
    def density(f):
        S = ss.psd(ss.QuarterCar(), ss.Road(), np.array([f])).sel(output="bacc").item()
        return S * abs(ss.weighting("Wk")(2j * np.pi * f)) ** 2

    low, high = BANDS[band] * 10.0**-0.05, BANDS[band] * 10.0**0.05
    expected = np.sqrt(quad(density, low, high)[0])
    bands = ss.third_octaves(ss.QuarterCar(), ss.Road(), weighting="Wk").sel(output="bacc")
    assert float(bands[band]) == pytest.approx(expected, rel=1e-9)


def test_bands_add_up():
    by_output = {"bacc": "Wk", "pitch_acc": "We"}
    bands = ss.third_octaves(ss.FullCar(), ROAD, weighting=by_output, points=POINTS)
    ride = ss.ride_metrics(ss.FullCar(), ROAD, weighting=by_output, points=POINTS)
    total = np.sqrt((bands**2).sum("frequency"))
    assert total.sel(output="bacc_driver") == pytest.approx(float(ride.bacc.sel(point="driver")), rel=1e-4)
    assert total.sel(output="pitch_acc") == pytest.approx(float(ride.pitch_acc), rel=1e-3)
    assert bands.sizes["frequency"] == 31
    assert bands.frequency.attrs["units"] == "Hz"


def test_a_sweep_and_curves():
    cs = xr.DataArray(np.array([900.0, 1500.0]), dims="cs")
    many = ss.third_octaves(ss.QuarterCar(cs=cs), ss.Road())
    one = ss.third_octaves(ss.QuarterCar(cs=900.0), ss.Road())
    assert many.dims == ("cs", "output", "frequency")
    np.testing.assert_allclose(many.isel(cs=0), one, rtol=1e-12)
    curved = ss.QuarterCar(cs=ss.DamperCurve([-1.0, 0.0, 1.0], [-1500.0, 0.0, 1500.0]))
    straight = ss.third_octaves(ss.QuarterCar(cs=1500.0), ss.Road())
    np.testing.assert_allclose(ss.third_octaves(curved, ss.Road()), straight, rtol=1e-8)


def test_the_limits_are_those_that_were_printed():
    frequency, fatigue = np.array(list(PRINTED.items())).T
    np.testing.assert_allclose(reduced_comfort(frequency, "8 h"), fatigue / 3.15, rtol=0.02)
    longest_first = [reduced_comfort(5.0, exposure) for exposure in FATIGUE][::-1]
    assert longest_first == sorted(longest_first)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: ss.third_octaves(None, ROAD), TypeError, "vehicle must be"),
        (lambda: ss.third_octaves(ss.QuarterCar(), None), TypeError, "road must be a Road"),
        (lambda: ss.third_octaves(ss.QuarterCar(), ROAD, weighting="Wx"), ValueError, "no weighting named 'Wx'"),
        (lambda: ss.third_octaves(ss.QuarterCar(), ROAD, points=POINTS), ValueError, "moves as one point"),
    ],
)
def test_what_has_no_bands(call, error, words):
    with pytest.raises(error, match=words):
        call()
