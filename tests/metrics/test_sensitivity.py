"""Sensitivities beside extrapolated differences, hand-made derivatives of closed forms, and dimensional analysis."""

import dataclasses

import numpy as np
import pytest
import xarray as xr
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import models
import oracles
import susp_ss as ss
from models import ROADS, VEHICLES, WHEEL_ROADS
from susp_ss.roads.colours import COHERENCE_RATES

OF_ROAD = ("roughness", "speed", "cutoff")

# Steps of h, h/2 and h/4 to both sides, and the weights that cancel the errors in h^2 and h^4.
STEPS = np.array([1.0, -1.0, 0.5, -0.5, 0.25, -0.25])
WEIGHTS = np.array([1.0, -1.0, -40.0, 40.0, 256.0, -256.0]) / 90.0


def leaves(vehicle, name):
    """Where a name such as ``ks``, ``ks_fr`` or ``mb`` points: field, wheels, values."""
    field, _, wheel = name.rpartition("_")
    if field in vehicle.per_corner:
        return field, [wheel], [vehicle.at_wheels(field)[list(vehicle.wheels).index(wheel)]]
    if name in vehicle.per_corner:
        return name, list(vehicle.wheels), list(vehicle.at_wheels(name))
    return name, [], [getattr(vehicle, name)]


def changed(vehicle, name, by):
    field, wheels, values = leaves(vehicle, name)
    if not wheels:
        return dataclasses.replace(vehicle, **{field: values[0] + by})
    every = dict(zip(vehicle.wheels, vehicle.at_wheels(field), strict=True))
    every |= {wheel: value + by for wheel, value in zip(wheels, values, strict=True)}
    return dataclasses.replace(vehicle, **{field: ss.Corners(**every) if len(every) == 4 else tuple(every.values())})


def parameters(vehicle, road, least=0.0):
    """Every parameter that is not zero, with its size; tyre damping and anti-roll bars from ``least`` on."""
    names = [field.name for field in dataclasses.fields(vehicle)]
    names += [f"{name}_{wheel}" for name in vehicle.per_corner for wheel in vehicle.wheels]
    sizes = {name: min(leaves(vehicle, name)[2]) for name in names}
    sizes |= {name: getattr(road, name) for name in OF_ROAD}
    return {name: size for name, size in sizes.items() if size > (least if name.startswith(("ct", "arb")) else 0.0)}


def around(vehicle, road, name, step):
    """Ride metrics of the six designs about the one in question."""
    if name not in OF_ROAD:
        return ss.ride_metrics(changed(vehicle, name, step * STEPS), road)
    roads = [dataclasses.replace(road, **{name: getattr(road, name) + step * x}) for x in STEPS]
    return xr.concat([ss.ride_metrics(vehicle, other) for other in roads], "design")


def check_by_differences(vehicle, road, names, rounding):
    slopes, here, sizes = (
        ss.sensitivity(vehicle, road, names),
        ss.ride_metrics(vehicle, road),
        parameters(vehicle, road),
    )
    for name in names:
        step = 0.01 * sizes[name]
        metrics = around(vehicle, road, name, step)
        for kind, slope in slopes.sel(parameter=name, drop=True).items():
            # The squares of what is an RMS, which are smooth even where symmetry makes it zero.
            power, value = 1 if kind == "damper_power" else 2, here[kind].values
            moment = metrics[kind].transpose("design", ...).values ** power
            found = slope.values * power * value ** (power - 1)
            expected = WEIGHTS @ moment / step
            # What ride_metrics loses to rounding, over the step, is the noise of a difference.
            noise = rounding * np.abs(WEIGHTS).sum() * moment.max(axis=0) / step
            allowed = 1e-6 * np.abs(expected) + noise
            none = np.isnan(found) & (np.isinf(value) | (value == 0.0))
            assert (none | (np.abs(found - expected) <= allowed)).all(), (name, kind, found, expected)


CASES = [
    (vehicle, road) for vehicle in VEHICLES for road in (*ROADS, *(WHEEL_ROADS if vehicle.startswith("full") else ()))
]


@pytest.mark.filterwarnings("ignore:invalid value")
@pytest.mark.parametrize(("vehicle", "road"), CASES)
def test_sensitivities_are_the_limits_of_differences(vehicle, road):
    # Every sixth parameter, another sixth in each case: together they are all met on many roads.
    start = CASES.index((vehicle, road)) % 6
    vehicle, road = VEHICLES[vehicle], (ROADS | WHEEL_ROADS)[road]
    check_by_differences(vehicle, road, list(parameters(vehicle, road))[start::6] or ["ks"], rounding=1e-11)


@pytest.mark.filterwarnings("ignore:invalid value")
@given(models.vehicles, models.roads, st.data())
@settings(max_examples=25)
def test_random_vehicles_on_random_roads(vehicle, road, data):
    names = sorted(parameters(vehicle, road, least=50.0))
    chosen = data.draw(st.lists(st.sampled_from(names), min_size=3, max_size=3, unique=True))
    try:
        # Wheels that hop almost alike cost a lightly damped car three digits of what it has else.
        check_by_differences(vehicle, road, chosen, rounding=1e-9)
    except ValueError as error:
        # Next to a symmetric car, what symmetry makes zero has too few digits to difference, and is refused.
        assume("fewer than six digits" not in str(error))
        raise


def test_quarter_car_is_its_closed_form_differentiated_by_hand():
    car, road = ss.QuarterCar(ms=300.0, mu=40.0, ks=17e3, cs=1300.0, kt=180e3), ss.Road(speed=15.0)
    ms, mu, k, c, kt, q, M = 300.0, 40.0, 17e3, 1300.0, 180e3, road.intensity, 340.0
    of_variance = {
        "bacc": {
            "ms": q / 2 * (-2 * kt * c / ms**3 + k**2 / (ms**2 * c) - 2 * M * k**2 / (ms**3 * c)),
            "mu": q / 2 * k**2 / (ms**2 * c),
            "ks": q * M * k / (ms**2 * c),
            "cs": q / 2 * (kt / ms**2 - M * k**2 / (ms**2 * c**2)),
            "kt": q / 2 * c / ms**2,
        },
        "sws": {"ms": q / (2 * c), "mu": q / (2 * c), "ks": 0.0, "cs": -q * M / (2 * c**2), "kt": 0.0},
        "dtl": {
            "ms": q / 2 * (3 * M**2 * k**2 / (ms**2 * c) - 2 * M**3 * k**2 / (ms**3 * c))
            + q / 2 * (-2 * mu * k * kt / (ms * c) + 2 * M * mu * k * kt / (ms**2 * c))
            + q / 2 * (2 * M * c * kt / ms**2 - 2 * M**2 * c * kt / ms**3),
            "mu": q / 2 * (3 * M**2 * k**2 / (ms**2 * c) - 2 * k * kt * (M + mu) / (ms * c))
            + q / 2 * (kt**2 / c + 2 * M * c * kt / ms**2),
            "ks": q / 2 * (2 * M**3 * k / (ms**2 * c) - 2 * M * mu * kt / (ms * c)),
            "cs": q / 2 * (-(M**3) * k**2 / (ms**2 * c**2) + 2 * M * mu * k * kt / (ms * c**2))
            + q / 2 * (-mu * kt**2 / c**2 + M**2 * kt / ms**2),
            "kt": q / 2 * (-2 * M * mu * k / (ms * c) + 2 * mu * kt / c + M**2 * c / ms**2),
        },
    }
    names = ["ms", "mu", "ks", "cs", "kt"]
    slopes, metrics = ss.sensitivity(car, road, names), ss.ride_metrics(car, road)
    for kind, by_name in of_variance.items():
        expected = np.array([by_name[name] for name in names]) / (2.0 * float(metrics[kind]))
        sizes = float(metrics[kind]) / np.array([ms, mu, k, c, kt])
        np.testing.assert_allclose(slopes[kind], expected, rtol=1e-10, atol=0.0 + 1e-12 * sizes.min())
    # Mean damper power is q kt / 2, whatever the masses, the spring and the damper are.
    np.testing.assert_allclose(slopes.damper_power, [0.0, 0.0, 0.0, 0.0, q / 2], atol=1e-12 * q * kt / c)


def test_comfort_optimal_damping_is_where_the_slope_vanishes():
    car = ss.QuarterCar()
    best = ss.QuarterCar(cs=oracles.comfort_optimal_damping(car.ms, car.mu, car.ks, car.kt))
    slope = ss.sensitivity(best, ss.Road(), ["cs"]).bacc.item()
    assert abs(slope) < 1e-12 * ss.ride_metrics(best, ss.Road()).bacc.item() / best.cs


# Exponents of (mass, length, time) in each parameter's unit. Angles have none; heights, and what rises with them, are
# in a unit of their own, as variances only scale with them. Of the road, G_d(n0) n0^2 counts: height^2 per length.
ALONG = {
    **dict.fromkeys(("ms", "mu", "mb"), (1, 0, 0)),
    **dict.fromkeys(("ixx", "iyy"), (1, 2, 0)),
    **dict.fromkeys(("a", "b", "c"), (0, 1, 0)),
    **dict.fromkeys(("ks", "kt", "arb", "arb_front", "arb_rear"), (1, 0, -2)),
    **dict.fromkeys(("cs", "ct"), (1, 0, -1)),
    "speed": (0, 1, -1),
    "roughness": (0, -1, 0),
    "cutoff": (0, -1, 0),
}
OF_METRICS = {
    "bacc": (0, 0, -2),
    "sws": (0, 0, 0),
    "dtl": (1, 0, -2),
    "pitch_acc": (0, -1, -2),
    "roll_acc": (0, -1, -2),
    "damper_power": (1, 0, -3),
    "tyre_deflection": (0, 0, 0),
    "sws_rate": (0, 0, -1),
}


@given(models.vehicles, models.roads)
@settings(max_examples=40)
def test_units_of_mass_length_and_time_are_free(vehicle, road):
    every = parameters(vehicle, road)
    names = [name for name in every if name in OF_ROAD or len(leaves(vehicle, name)[2]) == 1]
    fields = [name if name in OF_ROAD else leaves(vehicle, name)[0] for name in names]
    sizes = np.array([every[name] for name in names])
    slopes, metrics = ss.sensitivity(vehicle, road, names), ss.ride_metrics(vehicle, road)
    for kind, slope in slopes.items():
        value = metrics[kind].values
        if not np.isfinite(value).all() or (value == 0.0).any():
            continue
        # Near symmetry a rotation is a small difference of large motions, and has as many digits less.
        if kind in ("pitch_acc", "roll_acc") and value < 1e-3 * metrics.bacc.values.max():
            continue
        by_share = slope.transpose(..., "parameter").values * sizes
        for unit in range(3):
            terms = by_share * [ALONG[field][unit] for field in fields]
            error = np.abs(terms.sum(axis=-1) - OF_METRICS[kind][unit] * value)
            assert (error <= 1e-8 * (np.abs(terms).sum(axis=-1) + value)).all(), (unit, kind)


@given(models.vehicles, models.roads)
@settings(max_examples=15)
def test_a_common_change_is_the_sum_of_the_corners_changes(vehicle, road):
    for name in vehicle.per_corner:
        whole = ss.sensitivity(vehicle, road, [name])
        parts = ss.sensitivity(vehicle, road, [f"{name}_{wheel}" for wheel in vehicle.wheels])
        for kind, slope in whole.items():
            terms = parts[kind]
            allowed = 1e-9 * abs(terms).sum("parameter") + 1e-300
            equal = abs(terms.sum("parameter", skipna=False) - slope.squeeze("parameter")) <= allowed
            assert bool((equal | np.isnan(terms).any("parameter")).all()), (name, kind)


def test_a_sweep_is_each_of_its_designs():
    ks = xr.DataArray(np.linspace(15e3, 21e3, 12), dims="stiffness", coords={"stiffness": range(12)})
    cs = xr.DataArray(np.linspace(1100.0, 1900.0, 8), dims="damping")
    road, names = ss.Road(tracks="isotropic"), ("cs", "arb_front", "kt_rl", "speed")
    slopes = ss.sensitivity(ss.FullCar(ks=ks, cs=cs), road, names)
    assert slopes.bacc.dims == ("stiffness", "damping", "parameter", "point")
    assert slopes.dtl.dims == ("stiffness", "damping", "parameter", "corner")
    assert slopes.roll_acc.dims == ("stiffness", "damping", "parameter")
    for i, j in ((0, 0), (5, 3), (11, 7)):
        one = ss.sensitivity(ss.FullCar(ks=float(ks[i]), cs=float(cs[j])), road, names)
        for kind, slope in slopes.isel(stiffness=i, damping=j).items():
            np.testing.assert_allclose(slope, one[kind], rtol=1e-8, atol=1e-10 * float(abs(slope).max()))


def test_a_change_at_an_axle_is_the_sum_of_its_corners_changes():
    car, road = ss.FullCar(), ss.DEFAULT_ROAD
    slope = ss.sensitivity(car, road, ["cs_front", "cs_fr", "cs_fl"])
    for name in ("bacc", "dtl", "sws"):
        whole, right, left = (slope[name].sel(parameter=p) for p in slope.parameter.values)
        np.testing.assert_allclose(whole, right + left, rtol=1e-9)


def test_labels_tell_units_and_meaning():
    slopes = ss.sensitivity(ss.FullCar(), ss.Road(cutoff=0.01), ["mb", "cs_rr", "cutoff"])
    assert slopes.parameter.values.tolist() == ["mb", "cs_rr", "cutoff"]
    assert slopes.unit.values.tolist() == ["kg", "N s/m", "cycle/m"]
    assert slopes.sws.attrs == {
        "units": "m",
        "long_name": "derivative of RMS suspension deflection by each parameter",
    }
    assert slopes.damper_power.attrs["long_name"].startswith("derivative of mean power")
    assert slopes.sws.sel(parameter="mb", corner="fr").unit.item() == "kg"


def test_an_rms_that_is_zero_by_symmetry_has_a_slope_along_what_keeps_the_symmetry_alone():
    slopes = ss.sensitivity(ss.FullCar(), ss.Road(), ["ks", "c", "arb_front", "speed", "ks_fr", "mu_rl"])
    np.testing.assert_array_equal(slopes.roll_acc, [0.0, 0.0, 0.0, 0.0, np.nan, np.nan])
    assert np.isfinite(slopes.sws).all()
    # Alike at both ends and without a delay, a car does not pitch until its centre of gravity moves.
    even = ss.PitchHalfCar(a=1.2, b=1.2)
    slopes = ss.sensitivity(even, ss.Road(delay=False), ["ks", "iyy", "a", "cs_r"])
    np.testing.assert_array_equal(slopes.pitch_acc, [0.0, 0.0, np.nan, np.nan])


def test_what_is_infinite_or_becomes_so_has_no_slope():
    slopes = ss.sensitivity(ss.QuarterCar(), ss.Road(), ["ks", "ct"])
    assert np.isfinite(slopes.dtl[0])
    assert np.isnan(slopes.dtl[1])
    assert np.isfinite(slopes[["bacc", "sws", "damper_power"]].to_array()).all()
    assert np.isnan(ss.sensitivity(ss.QuarterCar(ct=50.0), ss.Road(), ["ks"]).dtl).all()
    rigid = ss.sensitivity(ss.RigidTyreQuarterCar(), ss.Road(), ["cs"])
    assert np.isnan(rigid[["bacc", "dtl", "damper_power"]].to_array()).all()
    np.testing.assert_allclose(rigid.sws, -0.5 * ss.ride_metrics(ss.RigidTyreQuarterCar(), ss.Road()).sws / 1516.5)


def test_arguments_are_left_as_they_were():
    car = ss.FullCar(ks=np.array([16e3, 18e3]))
    before = {field.name: np.array(getattr(car, field.name)) for field in dataclasses.fields(car)}
    ss.sensitivity(car, ss.Road(), ["ks", "b"])
    for name, value in before.items():
        np.testing.assert_array_equal(getattr(car, name), value)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (["ks", "stiffness"], r"no parameter named 'stiffness', available: ms, mu, ks, cs, kt, ct, roughness, speed$"),
        (["ks_fr"], "no parameter named 'ks_fr'"),
        (["cutoff"], "no parameter named 'cutoff'"),
        (["ks", "ks"], "different names, got .'ks', 'ks'."),
        ([], r"at least one name"),
    ],
)
def test_names_are_checked(parameters, message):
    with pytest.raises(ValueError, match=message):
        ss.sensitivity(ss.QuarterCar(), ss.Road(), parameters)


@pytest.mark.parametrize("parameters", ["ks", None, [1], {"ks"}])
def test_parameters_of_the_wrong_kind_are_refused(parameters):
    with pytest.raises(TypeError, match=r'parameters must be a sequence of names such as \("ks", "cs"\), got'):
        ss.sensitivity(ss.QuarterCar(), ss.Road(), parameters)


def test_what_the_covariance_refuses_is_refused():
    with pytest.raises(ValueError, match="no damper reaches"):
        ss.sensitivity(ss.QuarterCar(cs=0.0), ss.Road())
    with pytest.raises(ValueError, match="no finite variance"):
        ss.sensitivity(ss.FullCar(), ss.Road(wheels=("fr",)))
    with pytest.raises(TypeError, match="vehicle must be one of"):
        ss.sensitivity(3.0, ss.Road())
    with pytest.raises(ValueError, match="'parameter', which results use"):
        ss.sensitivity(ss.QuarterCar(ks=xr.DataArray([1e4, 2e4], dims="parameter")), ss.Road())


def test_a_cut_off_at_a_rate_of_the_coherence_keeps_its_slope():
    # The partial fractions of coincident rates are taken a little apart.
    car = ss.FullCar(arb_front=9e3)
    road = ss.Road(tracks="isotropic", cutoff=COHERENCE_RATES[2] / (4.0 * np.pi * car.c))
    at, beside = (ss.sensitivity(car, dataclasses.replace(road, cutoff=x * road.cutoff), ["c"]) for x in (1.0, 1.001))
    metrics = ss.ride_metrics(car, road)
    for kind, slope in at.items():
        assert bool((abs(slope - beside[kind]) < 1e-4 * metrics[kind] / car.c).all()), kind
