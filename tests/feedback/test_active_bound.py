"""The active bound against other routes: a semidefinite programme, a delay line in discrete time, the spectrum."""

import cvxpy as cp
import numpy as np
import pytest
import scipy.linalg
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import susp_ss as ss
from susp_ss.feedback.plant import plant
from susp_ss.feedback.preview import Law, optimal, variances
from susp_ss.feedback.shaping import shaping
from susp_ss.roads.colours import colours

ROAD = ss.Road.iso8608("B", speed=20.0)
APART = ss.Road(tracks="independent", delay=False)
ROADS = [
    ss.Road(),
    ss.Road(tracks="isotropic"),
    ss.Road(cutoff=0.01),
    ss.Road(tracks="isotropic", contact_length=0.1, cutoff=0.02),
    ss.Road(waviness=1.7),
    ss.Road(waviness=2.4, tracks="isotropic", delay=False),
]


def own_limits(car, road, *names, factor=1.0):
    """The passive car's own metrics as limits, by place."""
    metrics = ss.ride_metrics(car, road)
    limits = {}
    for name in names:
        data = metrics[name]
        places = data[data.dims[0]].values if data.dims else [""]
        limits |= {
            f"{name}@{p}" if p else name: factor * float(x) for p, x in zip(places, data.values.flat, strict=True)
        }
    return limits


def by_semidefinite_programme(car, road, minimise, limits):
    """Least RMS over X and Y = K X, on white velocity without a delay, by cvxpy: nothing of the feedback room."""
    system = car.state_space(input="velocity", actuators=True)
    wheels, n = len(car.wheels), system.nstates - car.layout().warps
    A, B, W = system.A[:n, :n], system.B[:n, wheels:], system.B[:n, :wheels]
    # Left and right see processes of their own; those of one side see one and the same.
    sides = sorted({wheel.side for wheel in car.wheels.values()})
    W = W @ np.array([[wheel.side == side for side in sides] for wheel in car.wheels.values()], dtype=float)
    Q = road.intensity * W @ W.T
    size = np.sqrt(np.diag(scipy.linalg.solve_continuous_lyapunov(A, -Q)))
    A, B, Q = A / size[:, None] * size, B / size[:, None], Q / np.outer(size, size)
    X, Y = cp.Variable((n, n), symmetric=True), cp.Variable((B.shape[1], n))
    unit = 1e3
    flow = A @ X + unit * B @ Y
    holds = [flow + flow.T + Q << 0]

    def variance(name):
        row = system.output_labels.index(name.replace("@", "_"))
        c, d = system.C[[row], :n] * size, system.D[[row], wheels:]
        scale = np.linalg.norm(c)
        S = cp.Variable((1, 1))
        z = (c @ X + unit * d @ Y) / scale
        holds.append(cp.bmat([[S, z], [z.T, X]]) >> 0)
        return S[0, 0], scale

    goal, scale = variance(minimise)
    for name, limit in limits.items():
        S, own = variance(name)
        holds.append(S * (own / limit) ** 2 <= 1.0)
    problem = cp.Problem(cp.Minimize(goal), holds)
    problem.solve(solver="CLARABEL")
    return float(np.sqrt(problem.value) * scale)


@pytest.mark.filterwarnings("ignore:Solution may be inaccurate")
@pytest.mark.parametrize(
    ("car", "road", "minimise", "close"),
    [(ss.QuarterCar(), ROAD, "bacc", 2e-4), (ss.FullCar(), APART, "bacc@cg", 5e-3)],
)
def test_the_bound_is_that_of_the_semidefinite_programme(car, road, minimise, close):
    limits = own_limits(car, road, "sws", "dtl")
    bound = ss.active_bound(car, road, minimise, limits, certify="clarabel")
    least = by_semidefinite_programme(car, road, minimise, limits)
    assert bound.least == pytest.approx(least, rel=5e-5)
    assert least * (1.0 - 1e-4) <= bound.bound <= least * (1.0 + close)
    # What is left is as far as forces have a weight, and said so.
    assert bound.bound * (1.0 - bound.unresolved) == pytest.approx(least, rel=3e-4)


@pytest.mark.parametrize("solver", ["clarabel", "scs"])
@pytest.mark.parametrize("car", [ss.QuarterCar(), ss.PitchHalfCar(), ss.FullCar()])
def test_both_solvers_certify_the_bound(car, solver):
    """With limited forces the least is reached: two routes that share nothing agree."""
    name = "bacc" if isinstance(car, ss.QuarterCar) else "bacc@cg"
    limits = own_limits(car, APART, "sws", "dtl") | {"force": np.array([150.0, 300.0])}
    front = ss.active_bound(car, APART, name, limits, certify=solver)
    np.testing.assert_allclose(front.least, front.bound, rtol=1e-6 if solver == "clarabel" else 2e-4)
    assert front.points[1].least == float(front.least[1])


def test_quarter_and_full_car_fall_to_known_values():
    car = ss.QuarterCar()
    assert ss.active_bound(car, ROAD, "bacc", own_limits(car, ROAD, "sws", "dtl")).bound == pytest.approx(
        0.601, abs=5e-4
    )
    full = ss.FullCar()
    assert ss.active_bound(full, APART, "bacc@cg", own_limits(full, APART, "sws", "dtl")).bound == pytest.approx(
        0.317, abs=1e-3
    )


@pytest.mark.parametrize("weighting", [None, "Wk"])
@pytest.mark.parametrize("car", [ss.QuarterCar(), ss.RollHalfCar(), ss.FullCar()])
def test_the_closed_loop_reaches_the_bound_by_ride_metrics(car, weighting):
    name = "bacc" if isinstance(car, ss.QuarterCar) else "bacc@cg"
    bound = ss.active_bound(car, APART, name, own_limits(car, APART, "sws", "dtl"), weighting=weighting)
    again = ss.ride_metrics(bound.closed, APART, weighting=weighting)
    for metric in ("bacc", "sws", "dtl", "force", "damper_power"):
        np.testing.assert_allclose(again[metric], bound.metrics[metric], rtol=1e-8)
    assert (bound.metrics.sws <= bound.passive.sws * (1.0 + 1e-5)).all()


@pytest.mark.parametrize("weighting", [None, "Wk"])
@pytest.mark.parametrize("road", ROADS, ids=lambda road: road.describe()[24:])
def test_without_a_law_variances_are_those_of_ride_metrics(road, weighting):
    car = ss.FullCar(cs=ss.Corners.axles(front=1300.0, rear=1700.0))
    known = plant(car, road, weighting, "a test")
    found = known.metrics(known.variances(Law(known.no_force)))
    expected = ss.ride_metrics(car, road, weighting=weighting)
    for name in expected:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-7, atol=1e-6)


def test_a_gain_without_preview_is_evaluated_as_by_ride_metrics():
    car, road = ss.PitchHalfCar(), ss.Road()
    limits = own_limits(car, road, "sws", "dtl")
    blind, seeing = (ss.active_bound(car, road, "bacc@cg", limits, preview=preview) for preview in (False, True))
    again = ss.ride_metrics(blind.closed, road)
    np.testing.assert_allclose(again.bacc, blind.metrics.bacc, rtol=1e-8)
    assert all(
        float(blind.metrics[n].sel(corner=e)) <= limits[f"{n}@{e}"] * 1.0001 for n in ("sws", "dtl") for e in "fr"
    )
    assert blind.multipliers == {}
    assert seeing.bound < blind.bound < float(blind.passive.bacc.sel(point="cg"))
    assert seeing.closed is None


def test_preview_is_the_limit_of_a_delay_line_in_discrete_time():
    """Front and rear noise through a line of N steps, its regulator by SciPy's discrete Riccati equation."""
    car, road = ss.PitchHalfCar(), ss.Road()
    known = plant(car, road, None, "a test")
    names = known.layout.outputs.names
    costs = np.zeros(len(known.system.C))
    for name, cost in {
        "bacc_cg": 1.0,
        "sws_f": 1e3,
        "sws_r": 2e3,
        "dtl_f": 1e-6,
        "force_f": 1e-7,
        "force_r": 1e-7,
    }.items():
        costs[names.index(name)] = cost
    law = optimal(known.system, costs)
    exact = costs @ variances(known.system, known.noises, law)

    (noise,) = known.noises
    errors = []
    for steps in (20, 40):
        h = noise.delays[1] / steps
        A, B, C, D = known.system
        n, k = len(A), B.shape[1]
        grown = scipy.linalg.expm(h * np.block([[A, B], [np.zeros((k, n + k))]]))
        line = np.eye(steps, k=-1)
        front, rear = noise.entries
        first, last = np.eye(steps)[0], np.eye(steps)[-1]
        big = scipy.linalg.block_diag(grown[:n, :n], line)
        big[:n, n:] = np.outer(grown[:n, :n] @ rear, last)
        pushed = np.vstack([grown[:n, n:], np.zeros((steps, k))])
        # The middle of a step is where its cost is taken, with what of the line falls into it half there.
        half = scipy.linalg.expm(0.5 * h * np.block([[A, B], [np.zeros((k, n + k))]]))
        Cm, Dm = C @ half[:n, :n], C @ half[:n, n:] + D
        Cb = np.hstack([Cm, np.outer(Cm @ rear, last)])
        Q, S, R = h * (Cb.T * costs @ Cb), h * (Cb.T * costs @ Dm), h * (Dm.T * costs @ Dm)
        P = scipy.linalg.solve_discrete_are(big, pushed, 0.5 * (Q + Q.T), R, s=S)
        # A unit of noise falls on the axle at once and stands for the line's first place one step later.
        start = np.append(front, first)
        errors.append(start @ P @ start / exact - 1.0)
    assert abs(errors[1]) < 0.6 * abs(errors[0])
    assert abs(errors[1] - (errors[0] - errors[1])) < 0.003


@pytest.mark.parametrize("road", ROADS[1:], ids=lambda road: road.describe()[24:])
def test_the_filter_behind_a_road_has_its_spectrum(road):
    spectrum = colours(road, 0.5, -1, np.array([1.446]))
    found = shaping(spectrum)
    omega = np.geomspace(0.5, 500.0, 40)
    a, low, high = (np.real(part[0]) for part in spectrum[1:])
    power = spectrum.level[0, 0] + ((low * a**2 + high * omega[:, None] ** 2) / (a**2 + omega[:, None] ** 2)).sum(
        axis=1
    )
    factor = found.direct + (found.gains / (found.rates + 1j * omega[:, None])).sum(axis=1)
    np.testing.assert_allclose(abs(factor) ** 2, power, rtol=1e-6)


@settings(max_examples=5)
@given(st.floats(0.8, 1.3), st.floats(0.9, 1.3))
def test_no_gain_comes_below_the_bound(travel, load):
    car = ss.QuarterCar()
    limits = {"sws": travel * 0.0055, "dtl": load * 412.7}
    try:
        bound = ss.active_bound(car, ROAD, "bacc", limits)
    except ValueError:
        return
    for damping in (600.0, 1500.0, 3000.0):
        law = ss.lqr(car, ROAD, {"bacc": 1.0, "sws": 1e7 / damping, "dtl": damping * 1e-9})
        if float(law.metrics.sws) <= limits["sws"] and float(law.metrics.dtl) <= limits["dtl"]:
            assert float(law.metrics.bacc) >= bound.bound * (1.0 - 1e-6)


def test_multipliers_are_the_slope_of_the_bound():
    limits = {"sws": 0.005, "dtl": 450.0}
    middle = ss.active_bound(ss.QuarterCar(), ROAD, "bacc", limits)
    for name, limit in limits.items():
        up, down = (
            ss.active_bound(ss.QuarterCar(), ROAD, "bacc", limits | {name: limit * s}).bound for s in (1.001, 0.999)
        )
        assert middle.multipliers[name] == pytest.approx((down - up) / (0.002 * limit), rel=1e-3)


def test_a_limit_is_used_to_its_end_however_small_its_multiplier():
    """Where it must be lower than it would be, it is no lower than its limit."""
    car, road = ss.QuarterCar(), ss.Road()
    limits = {"sws": 15.0 * float(ss.ride_metrics(car, road).sws)}
    free = ss.active_bound(car, road, "bacc", limits).metrics.dtl
    limits["dtl"] = float(free) * (1.0 - 3e-4)
    bound = ss.active_bound(car, road, "bacc", limits)
    assert float(bound.metrics.dtl) == pytest.approx(limits["dtl"], rel=1e-5)


@pytest.mark.parametrize("car", [ss.PitchHalfCar(), ss.FullCar()])
def test_a_point_of_a_front_is_that_by_itself_whatever_is_before_it(car):
    limits = own_limits(car, APART, "sws", "dtl")
    alone = ss.active_bound(car, APART, "bacc@cg", limits).bound
    shares = np.array([0.05, 0.2, 0.7, 1.0])
    front = ss.active_bound(car, APART, "bacc@cg", {name: shares * limit for name, limit in limits.items()})
    assert float(front.bound[-1]) == pytest.approx(alone, rel=1e-4)


def test_a_front_falls_over_its_limits():
    sws = xr.DataArray(np.linspace(0.003, 0.008, 3), dims="travel", coords={"travel": [3, 5.5, 8]})
    front = ss.active_bound(ss.QuarterCar(), ROAD, "bacc", {"sws": sws, "dtl": np.array([20.0, 800.0])})
    assert set(front.bound.dims) == {"travel", "limit"}
    assert front.bound.sel(limit=0).isnull().all()
    met = front.bound.isel(limit=1)
    assert (met.diff("travel") < 0.0).all()
    alone = ss.active_bound(ss.QuarterCar(), ROAD, "bacc", {"sws": 0.003, "dtl": 800.0})
    assert float(met[0]) == pytest.approx(alone.bound, rel=1e-6)
    assert "3 of 6 points" in repr(front)


CAR = ss.FullCar()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((CAR, ROAD, "bacc"), "at one place, got 'bacc'; available: bacc@cg"),
        ((CAR, ROAD, "bacc@xy"), "no 'bacc@xy', available: bacc@cg"),
        ((CAR, ROAD, None), "minimise must be the name of an output"),
        ((CAR, ROAD, "roll_acc"), "roll_acc is at rest on this road"),
        ((CAR, None, "bacc@cg"), "road must be a Road"),
        ((None, ROAD, "bacc@cg"), "vehicle must be one of"),
        ((CAR, ROAD, "bacc@cg", 3.0), "limits must be a mapping"),
        ((CAR, ROAD, "bacc@cg", {"sws": None}), "sws must be a root mean square > 0"),
        ((CAR, ROAD, "bacc@cg", {"sws": float("nan")}), "sws must be finite and > 0"),
        ((CAR, ROAD, "bacc@cg", {"sws": [0.01, -1.0]}), "sws must be finite and > 0"),
        ((CAR, ROAD, "bacc@cg", {"bacc@cg": 0.1}), "is what is minimised"),
        ((CAR, ROAD, "bacc@cg", {"sws": xr.DataArray([0.01], dims="sws")}), "rename it, sws_limit"),
        ((CAR, ROAD, "bacc@cg", {"sws": [0.01, 0.02], "dtl": [400.0] * 3}), "arrays of one length, got 2, 3"),
        ((CAR, ROAD, "bacc@cg", {}, None, True, "clarabel"), "certify: a semidefinite programme needs"),
        ((ss.QuarterCar(), ROAD, "bacc", {}, None, True, "mosek"), "certify must be 'clarabel' or 'scs', got 'mosek'"),
        ((ss.QuarterCar(ct=50.0), ROAD, "dtl"), "dtl has no finite variance"),
        ((ss.QuarterCar(ks=[1e4, 2e4]), ROAD), "needs one number for every parameter"),
        ((ss.QuarterCar(), ROAD, "bacc", {"dtl": 200.0, "sws": 0.003}), r"dtl <= 200 N, which is \d+(\.\d+)? at least"),
    ],
)
def test_wrong_arguments_are_refused_in_one_line(arguments, said):
    with pytest.raises((TypeError, ValueError), match=said):
        ss.active_bound(*arguments)
