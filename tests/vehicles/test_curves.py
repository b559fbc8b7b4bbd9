"""Force laws: their Gaussian means against plain integrals, where they may stand, and what they may not be."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss

TABLE = ss.DamperCurve(velocity=[-1.0, -0.3, 0.0, 0.1, 0.6], force=[-1500.0, -900.0, 100.0, 250.0, 500.0])
DIGRESSIVE = ss.DamperCurve.digressive(bump=900.0, rebound=2600.0, knee=0.2, final=0.3)
STOPS = ss.SpringCurve.with_stops(ks=18e3, stop=150e3, bump=0.03, rebound=0.05)


def means(curve, sigma, mean, kinks):
    """E[f] and its derivatives by integrals of f alone, under Hermite's polynomials."""
    at = [mean + sigma * u for u in (-9.0, 9.0)]
    inside = sorted({min(max(k, at[0]), at[1]) for k in (*kinks, mean)})

    nodes, weights = np.polynomial.legendre.leggauss(400)

    def expected(weight):
        total = 0.0
        for a, b in zip([at[0], *inside], [*inside, at[1]], strict=True):
            x = a + 0.5 * (b - a) * (1.0 + nodes)
            u = (x - mean) / sigma
            density = np.exp(-0.5 * u**2) / (np.sqrt(2.0 * np.pi) * sigma)
            total += 0.5 * (b - a) * np.sum(weights * curve.force(x) * weight(u) * density)
        return total

    hermite = (lambda u: 1.0, lambda u: u, lambda u: u**2 - 1.0, lambda u: u**3 - 3.0 * u)
    return [expected(weight) / sigma**n for n, weight in enumerate(hermite)]


@given(
    rises=st.lists(st.tuples(st.floats(0.02, 0.5), st.floats(0.0, 800.0)), min_size=2, max_size=5),
    share=st.floats(0.1, 0.9),
    sigma=st.floats(0.05, 1.0),
    mean=st.floats(-0.4, 0.4),
)
@settings(max_examples=15)
def test_means_of_tables(rises, share, sigma, mean):
    steps, climbs = np.array(rises).T
    x, force = np.concatenate([[0.0], np.cumsum(steps)]), np.concatenate([[0.0], np.cumsum(climbs + 1.0)])
    x -= share * x[-1]
    curve = ss.SpringCurve(x, force)
    assert float(curve.force(0.0)) == 0.0
    expected = means(curve, sigma, mean, x)
    scale = [force[-1] / sigma**n for n in range(4)]
    for got, want, size in zip(curve.means(sigma, mean), expected, scale, strict=True):
        assert got == pytest.approx(want, rel=1e-8, abs=1e-9 * size)


@pytest.mark.parametrize("sigma", [0.01, 0.2, 3.0])
@pytest.mark.parametrize("curve", [TABLE, DIGRESSIVE, 1.7 * DIGRESSIVE, ss.DamperCurve.two_slopes(800.0, 2400.0)])
def test_means_of_dampers(curve, sigma):
    expected = means(curve, sigma, 0.0, (-0.3, 0.0, 0.1))
    for n, (got, want) in enumerate(zip(curve.means(sigma), expected, strict=True)):
        assert got == pytest.approx(want, rel=1e-7, abs=1e-6 * abs(expected[1]) / sigma ** (n - 1))


@given(bump=st.floats(100.0, 5e3), ratio=st.floats(0.2, 6.0), sigma=st.floats(1e-3, 2.0))
def test_two_slopes_in_closed_form(bump, ratio, sigma):
    """The equivalent rate is the mean of both slopes, the mean force their difference times sigma over sqrt(2 pi)."""
    rebound = ratio * bump
    got = ss.DamperCurve.two_slopes(bump, rebound).means(sigma)
    assert got.slope == pytest.approx(0.5 * (bump + rebound), rel=1e-14)
    assert got.force == pytest.approx((bump - rebound) * sigma / np.sqrt(2.0 * np.pi), rel=1e-12, abs=1e-9)


def test_digressive_goes_along_two_lines_that_meet_at_the_knee():
    law = ss.DamperCurve.digressive(bump=1000.0, rebound=1000.0, knee=0.2, final=0.25)
    assert float(law.force(1e-6)) == pytest.approx(1e-3, rel=1e-6)
    far, farther = law.force([3.0, 4.0])
    assert farther - far == pytest.approx(250.0)
    assert far - 250.0 * 3.0 == pytest.approx((1000.0 - 250.0) * 0.2)


def test_a_number_or_an_array_times_a_curve():
    valve = xr.DataArray([0.5, 1.0, 2.0], dims="valve")
    sweep = ss.ride_metrics(ss.QuarterCar(cs=TABLE * valve), ss.Road())
    assert sweep.bacc.dims == ("valve",)
    for i, factor in enumerate(valve.values):
        one = ss.ride_metrics(ss.QuarterCar(cs=factor * TABLE), ss.Road())
        xr.testing.assert_allclose(one, sweep.isel(valve=i), rtol=1e-9)


def test_the_rate_for_small_motion_is_what_a_setting_gives():
    assert TABLE.rate == pytest.approx(0.5 * (1000.0 / 0.3 + 1500.0))
    assert TABLE.with_rate(1000.0).rate == pytest.approx(1000.0)
    stiffer = STOPS.with_rate(20e3)
    assert float(stiffer.force(0.06)) == pytest.approx(20e3 * 0.06 + 150e3 * 0.03)
    car = ss.FullCar(cs=ss.Corners.axles(front=TABLE, rear=1500.0), ks=STOPS)
    response = ss.Response(car, ss.Road.iso8608("C", speed=20.0), "sws", "fr", inputs=("ks", "cs_fr"))
    assert response.own("cs_fr") == TABLE.rate
    own = ss.ride_metrics(car, ss.Road.iso8608("C", speed=20.0)).sws.sel(corner="fr")
    assert response([[18e3, TABLE.rate]])[0] == pytest.approx(float(own), rel=1e-9)
    set_there = car.replaced(ks=20e3, cs_front=1000.0)
    other = ss.ride_metrics(set_there, ss.Road.iso8608("C", speed=20.0)).sws.sel(corner="fr")
    assert ss.Response(car, ss.Road.iso8608("C", speed=20.0), "sws", "fr", inputs=("ks", "cs_fr", "cs_fl"))(
        [[20e3, 1000.0, 1000.0]]
    )[0] == pytest.approx(float(other), rel=1e-9)


WRONG = {
    "falls": (lambda: ss.DamperCurve([-1.0, 0.5, 1.0], [-10.0, 5.0, 4.0]), "must not fall, got 4 after 5 N at entry 2"),
    "not rising": (lambda: ss.SpringCurve([-1.0, 0.5, 0.5], [0.0, 1.0, 2.0]), "(deflection=...) must rise strictly"),
    "one side": (lambda: ss.DamperCurve([0.0, 1.0], [0.0, 1.0]), "must reach from below 0 to above 0 m/s, got 0 to 1"),
    "flat": (lambda: ss.DamperCurve([-1.0, 1.0], [3.0, 3.0]), "must rise somewhere"),
    "lengths": (lambda: ss.DamperCurve([-1.0, 0.0, 1.0], [-3.0, 3.0]), "one force for each velocity, got 2, 3"),
    "NaN": (lambda: ss.DamperCurve([-1.0, 0.0, np.nan], [-3.0, 0.0, 3.0]), "must be finite, got nan at entry 2"),
    "text": (lambda: ss.DamperCurve(["a", "b"], [0.0, 1.0]), "must be numbers in m/s"),
    "negative": (lambda: ss.DamperCurve.two_slopes(bump=-1.0, rebound=2.0), "two_slopes(bump=...) must be >= 0 N s/m"),
    "final": (lambda: ss.DamperCurve.digressive(1.0, 1.0, 0.2, 1.5), "(final=...) must be from 0 to 1, got 1.5"),
    "factor": (lambda: -1.0 * TABLE, "the factor of a DamperCurve must be > 0, got -1.0"),
    "clearance": (lambda: ss.SpringCurve.with_stops(1e4, 1e5, 0.0, 0.1), "with_stops(bump=...) must be > 0 m, got 0.0"),
    "softer": (
        lambda: ss.SpringCurve([-1.0, -0.5, 0.5, 1.0], [-3.0, -2.0, 2.0, 3.0]).with_rate(1.0),
        "let its force fall",
    ),
    "dead": (lambda: ss.DamperCurve([-1, -0.1, 0.1, 1], [-1, 0, 0, 1]).with_rate(1.0), "no force for small motion"),
    "spring for damper": (lambda: ss.QuarterCar(cs=STOPS), "QuarterCar(cs=...) takes a number or a DamperCurve, got"),
    "at a corner": (lambda: ss.FullCar(ks=ss.Corners.axles(front=1e4, rear=TABLE)), "(ks=...) at corner rr takes"),
    "for a mass": (lambda: ss.QuarterCar(ms=TABLE), "QuarterCar(ms=...) takes a number, got"),
}


@pytest.mark.parametrize(("make", "said"), WRONG.values(), ids=WRONG.keys())
def test_what_a_curve_may_not_be_is_said(make, said):
    with pytest.raises((ValueError, TypeError)) as refused:
        make()
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "use",
    [
        lambda car: car.state_space(),
        lambda car: car.modes(),
        lambda car: car.natural_frequencies(),
        lambda car: ss.frequency_response(car, [1.0, 2.0]),
        lambda car: ss.psd(car, ss.Road(), [1.0, 2.0]),
        lambda car: ss.covariance(car, ss.Road()),
        lambda car: ss.LinearVehicle(ss.FullCar().state_space(actuators=True), like=car),
    ],
)
def test_what_needs_numbers_says_how_to_get_them(use):
    with pytest.raises(ValueError, match=r"FullCar has a curve for cs where a number is needed; pass ss.linearised"):
        use(ss.FullCar(cs=ss.Corners.axles(front=TABLE, rear=1500.0)))
    use(ss.linearised(ss.FullCar(cs=TABLE), ss.Road()))


CSV = {
    "velocity,force\n-1,-100\n0,0\n1,50\n": None,
    "\ufeffforce,velocity\nkN,mm/s\n-0.1,-1000\n0,0\n\n0.05,1000\n": None,
    "velocity;force\nmm/s;kN\n-1.000,0;-0,1\n0;0\n1000;0,05\n": None,
    "speed,force\n-1,-100\n1,50\n": "line 1 must name the columns velocity, force, got speed, force",
    "velocity,force\nfurlong,N\n-1,-100\n1,50\n": "line 2: the unit of velocity must be one of m/s, km/h, mph, mm/s",
    "velocity,force\n-1,-100\n0,x\n1,50\n": "line 3 must have two numbers, got 0,x",
    "velocity,force\n-1,-100\n0,60\n1,50\n": "line 4: force must not fall, got 50 after 60 N",
    "velocity,force\n-1,-100\n": "needs at least two rows",
    "": "line 1 must name the columns velocity, force, got none",
}


@pytest.mark.parametrize(("text", "said"), CSV.items())
def test_tables_in_files(text, said, tmp_path):
    path = tmp_path / "damper.csv"
    path.write_text(text, encoding="utf-8")
    if said is None:
        assert ss.DamperCurve.from_csv(path).force([-0.5, 2.0]).tolist() == pytest.approx([-50.0, 100.0])
        return
    with pytest.raises(ValueError, match=r"damper.csv: ") as refused:
        ss.DamperCurve.from_csv(path)
    assert said in str(refused.value)
