"""Laws against python-control, written out by hand, and their closed loops wherever a vehicle may stand."""

import control as ct
import numpy as np
import pytest
import xarray as xr

import susp_ss as ss
from susp_ss.feedback.tuning import Dampers, remade

ROAD = ss.Road()
CAR = ss.QuarterCar(cs=900.0)
WEIGHTS = {"bacc": 1.0, "sws": 1e4, "dtl": 1e-6}


def h2(A, W, c, road=ROAD):
    return ct.norm(ct.ss(A, W, c, 0.0), 2) * np.sqrt(road.intensity)


def test_the_regulator_is_that_of_python_control():
    system = CAR.state_space(input="velocity", actuators=True)
    A, B, C, D = system.A, system.B[:, [1]], system.C, system.D[:, [1]]
    rows = [system.output_labels.index(name) for name in WEIGHTS]
    W = np.diag([*WEIGHTS.values()])
    K, *_ = ct.lqr(A, B, C[rows].T @ W @ C[rows], D[rows].T @ W @ D[rows], C[rows].T @ W @ D[rows])
    law = ss.lqr(CAR, ROAD, WEIGHTS)
    np.testing.assert_allclose(law.gain, -K, rtol=1e-8)
    for name in WEIGHTS:
        row = system.output_labels.index(name)
        expected = h2(A - B @ K, system.B[:, [0]], C[[row]] - D[[row]] @ K)
        assert float(law.metrics[name]) == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("lag", [0.0, 0.01])
def test_hybrid_written_out(lag):
    law = ss.hybrid(CAR, ROAD, sky=1500.0, ground=300.0, lag=lag)
    system = CAR.state_space(input="velocity", actuators=True)
    A, W, B = system.A, system.B[:, [0]], system.B[:, [1]]
    k = np.array([[300.0 if name == "dz_u" else -1500.0 if name == "dz_s" else 0.0 for name in system.state_labels]])
    for name in ("bacc", "sws", "dtl"):
        row = system.output_labels.index(name)
        c, d = system.C[[row]], system.D[[row]][:, [1]]
        if lag:
            whole = np.block([[A, B], [k / lag, np.array([[-1.0 / lag]])]])
            expected = h2(whole, np.vstack([W, [[0.0]]]), np.hstack([c, d]))
        else:
            expected = h2(A + B @ k, W, c + d @ k)
        assert float(law.metrics[name]) == pytest.approx(expected, rel=1e-8)
    assert (law.gain is None) == (lag > 0.0)


def test_a_sky_and_a_ground_alone_are_hybrids():
    car = ss.FullCar(cs=900.0)
    for one, other in [
        (ss.skyhook(car, ss.DEFAULT_ROAD, 1200.0), ss.hybrid(car, ss.DEFAULT_ROAD, 1200.0, 0.0)),
        (ss.groundhook(car, ss.DEFAULT_ROAD, 400.0), ss.hybrid(car, ss.DEFAULT_ROAD, 0.0, 400.0)),
    ]:
        xr.testing.assert_allclose(one.metrics, other.metrics)


def test_good_sensors_bring_the_estimate_to_the_regulator():
    law = ss.lqr(CAR, ROAD, WEIGHTS)
    errors = [
        float(ss.lqg(CAR, ROAD, WEIGHTS, {"bacc": noise, "sws": 0.01 * noise}).metrics.bacc / law.metrics.bacc) - 1.0
        for noise in (1e-2, 1e-4, 1e-6)
    ]
    assert abs(errors[2]) < 1e-3 < abs(errors[0])


def test_the_estimator_written_out():
    """The controller around the plant by python-control's interconnection gives the same metrics."""
    law = ss.lqg(CAR, ROAD, WEIGHTS, {"bacc": 0.01, "sws": 1e-4})
    plant = CAR.state_space(input="velocity", actuators=True)
    loop = ct.interconnect([plant, law.controller], inputs="dz_r", outputs=plant.output_labels)
    again = ss.ride_metrics(ss.LinearVehicle(loop, like=CAR), ROAD)
    for name in ("bacc", "sws", "dtl"):
        assert float(again[name]) == pytest.approx(float(law.metrics[name]), rel=1e-7)


PLAIN = ss.Road(tracks="isotropic")
COSTS = {"bacc": 1.0, "sws": 1e3, "force": 1e-7}


def robust(car):
    """H-infinity control of the body's acceleration above the wheels, from accelerometers there."""
    system = car.state_space(input="velocity", actuators=True)
    felt = [system.output_labels.index(f"bacc_{corner}") for corner in car.wheels]
    # No force moves the warp of the road.
    n, moved = len(felt), slice(system.nstates - car.layout().warps)
    C, D = system.C[felt, moved], system.D[felt][:, n:]
    road, push = 0.1 * system.B[moved, :n], system.B[moved, n:]
    nothing, eye = np.zeros((n, n)), np.eye(n)
    plant = ct.ss(
        system.A[moved, moved],
        np.hstack([road, 0.0 * road, push]),
        np.vstack([C, 0.0 * C, C]),
        np.block([[nothing, nothing, D], [nothing, nothing, 1e-3 * eye], [nothing, 0.05 * eye, D]]),
        inputs=[*(f"w{i}" for i in range(2 * n)), *system.input_labels[n:]],
        outputs=[*(f"z{i}" for i in range(2 * n)), *(f"bacc_{corner}" for corner in car.wheels)],
    )
    return ss.h_infinity(plant, [f"bacc_{corner}" for corner in car.wheels], system.input_labels[n:])


LAWS = {
    "lqr": lambda car: ss.lqr(car, PLAIN, COSTS),
    "lqg": lambda car: ss.lqg(car, PLAIN, COSTS, {"bacc@cg": 0.01, "sws": 1e-3}),
    "skyhook": lambda car: ss.skyhook(car, PLAIN, 1500.0),
    "groundhook": lambda car: ss.groundhook(car, PLAIN, 400.0),
    "hybrid": lambda car: ss.hybrid(car, PLAIN, 1500.0, 300.0, lag=0.005),
    "bound": lambda car: ss.active_bound(
        car, ss.Road(tracks="independent", delay=False), "bacc@cg", {"sws": 0.006, "dtl": 450.0, "force": 300.0}
    ),
    "h_infinity": lambda car: robust(car).on(car, PLAIN),
}


@pytest.mark.parametrize("kind", LAWS)
@pytest.mark.parametrize("car", [ss.PitchHalfCar(), ss.FullCar()], ids=lambda car: type(car).__name__)
def test_a_closed_loop_stands_wherever_a_vehicle_may(car, kind):
    law = LAWS[kind](car)
    loop = law.closed
    assert isinstance(loop, ss.LinearVehicle)
    exact, spectral = (ss.ride_metrics(loop, PLAIN, method=method) for method in ("covariance", "spectral"))
    for name in ("bacc", "sws", "dtl", "force", "damper_power"):
        np.testing.assert_allclose(spectral[name], exact[name], rtol=2e-3)

    assert (loop.modes().damping_ratio > 0.0).all()
    response = ss.frequency_response(loop, np.array([0.5, 1.5, 10.0]))
    assert np.isfinite(response).all()
    assert ss.plots.bode({"loop": response.isel(input=0).sel(output=["bacc_cg"])}).axes

    time = np.linspace(0.0, 0.5, 251)
    flat = dict.fromkeys(car.wheels, 0.01 * np.sin(20.0 * time))
    assert np.isfinite(ss.simulate(loop, flat, time).bacc).all()
    ride = ss.comfort(loop, PLAIN)
    weighted = ss.ride_metrics(loop, PLAIN, weighting="Wk")
    np.testing.assert_allclose(ride.metrics.bacc, weighted.bacc, rtol=1e-9)


def test_modes_of_a_loop_are_those_of_its_state_space():
    """A skyhook on a quarter car, written out: eigenvalues, and eigenvectors in the vehicle's own states."""
    law = ss.skyhook(CAR, ROAD, 1500.0)
    system = CAR.state_space(input="velocity", actuators=True)
    k = np.array([[-1500.0 if name == "dz_s" else 0.0 for name in system.state_labels]])
    A = system.A + system.B[:, [1]] @ k
    modes = law.closed.modes()
    assert len(modes) == 2
    for _, mode in modes.iterrows():
        pole = 2.0 * np.pi * mode.frequency * complex(-mode.damping_ratio, np.sqrt(1.0 - mode.damping_ratio**2))
        assert list(mode["shape"].index) == system.state_labels
        np.testing.assert_allclose(A @ mode["shape"], pole * mode["shape"], atol=1e-9 * np.linalg.norm(A))


def test_a_controller_is_closed_around_a_vehicle_by_names():
    """Loops by python-control's interconnection, and signals that the vehicle does not have."""
    car = ss.PitchHalfCar()
    found = robust(car)
    law = found.on(car, ROAD)
    system = car.state_space(input="velocity", actuators=True)
    loop = ct.interconnect([system, found.controller], inputs=["dz_r_f", "dz_r_r"], outputs=system.output_labels)
    again = ss.ride_metrics(ss.LinearVehicle(loop, like=car), ROAD)
    for name in again:
        np.testing.assert_allclose(law.metrics[name], again[name], rtol=1e-7)
    assert (law.metrics.bacc < law.passive.bacc).all()
    with pytest.raises(ValueError, match="the controller measures 'bacc_f', none of the vehicle's outputs"):
        found.on(ss.FullCar(), ROAD)
    with pytest.raises(TypeError, match="vehicle must be one of"):
        found.on(None, ROAD)


def test_a_loop_far_faster_than_its_filter_is_parted():
    """Gains that make modes a million times as fast as those of the weighting once kept `LinearVehicle` for ever."""
    law = ss.lqr(CAR, ROAD, {"bacc": 1.0, "sws": 1e3, "dtl": 1e-6, "force": 1e-12}, weighting="Wk")
    assert 0.0 < float(law.metrics.bacc) < float(law.passive.bacc)


def test_tuning_finds_the_best_of_a_grid():
    limit = 1.01 * float(ss.ride_metrics(CAR, ROAD).dtl)

    def law(gain):
        return ss.skyhook(CAR, ROAD, gain)

    best = ss.tuned(law, {"gain": 800.0}, "bacc", {"dtl": limit})
    grid = [law(float(gain)).metrics for gain in np.linspace(100.0, 6000.0, 20)]
    met = [float(metrics.bacc) for metrics in grid if float(metrics.dtl) <= limit]
    assert float(best.metrics.bacc) <= min(met) * (1.0 + 1e-6)
    assert float(best.metrics.dtl) <= limit * (1.0 + 1e-6)
    assert repr(best).startswith("skyhook, gain ")


UNEQUAL = ss.FullCar(cs=ss.Corners.axles(front=900.0, rear=1100.0))


@pytest.mark.parametrize(
    ("law", "at"),
    [
        (
            ss.hybrid(UNEQUAL, PLAIN, 1500.0, 300.0),
            {"sky": 1700.0, "ground": 200.0, "cs_front": 1000.0, "cs_rr": 1200.0},
        ),
        (
            ss.hybrid(UNEQUAL, ss.Road(tracks="independent"), 1500.0, 300.0, lag=0.01, weighting="Wk"),
            {"sky": 1700.0, "lag": 0.008, "cs_rear": 1000.0},
        ),
        (ss.groundhook(CAR, ROAD, 300.0, lag=0.01), {"gain": 400.0, "cs": 1000.0}),
    ],
    ids=lambda case: getattr(case, "kind", ""),
)
def test_slopes_of_a_law_are_the_limits_of_differences(law, at):
    """What a search is told of each number, by values and slopes, is what the law itself gives, made anew."""
    metrics = [name for name in law.table().index if name.partition("@")[0] in ("bacc", "sws", "dtl", "force")]
    made, exact = remade(law, list(at)), Dampers.of(law, list(at), metrics)

    def measured(**numbers):
        found = made(**at | numbers)
        return np.array([found.value(name) for name in metrics])

    np.testing.assert_allclose(exact.values(at), measured(), rtol=1e-9)
    expected = [
        (measured(**{name: 1.0001 * x}) - measured(**{name: 0.9999 * x})) / (2e-4 * x) for name, x in at.items()
    ]
    np.testing.assert_allclose(
        exact.slopes(at, exact.values(at)).T, expected, rtol=1e-5, atol=1e-7 * np.abs(expected).max()
    )


@pytest.mark.parametrize("lag", [0.0, 0.01])
def test_tuning_by_exact_slopes_comes_where_differences_do(lag):
    start, limits = {"gain": 1500.0, "cs": 900.0}, {"dtl": 420.0}
    exact = ss.tuned(ss.skyhook(CAR, ROAD, 1500.0, lag=lag), start, "bacc", limits)

    def law(gain, cs):
        return ss.skyhook(ss.QuarterCar(cs=cs), ROAD, gain, lag=lag)

    other = ss.tuned(law, start, "bacc", limits)
    assert exact.value("bacc") == pytest.approx(other.value("bacc"), rel=1e-5)
    assert exact.value("dtl") <= limits["dtl"] * 1.0001
    # A law that was tuned can be tuned again, from where it is.
    again = ss.tuned(exact, {"gain": exact.numbers["gain"]}, "bacc", limits)
    assert again.value("bacc") <= exact.value("bacc") * (1.0 + 1e-6)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: ss.lqr(ss.FullCar(), ROAD, {"bacc@cg": 1.0}), "every one of the 4 forces cost something"),
        (lambda: ss.lqr(CAR, ROAD, {"bacc": -1.0}), "bacc must be finite and > 0, got -1.0"),
        (lambda: ss.lqr(CAR, ROAD, {"bac": 1.0}), "no output named 'bac', available: bacc"),
        (lambda: ss.lqr(CAR, ROAD, None), "weights must be a mapping"),
        (lambda: ss.lqg(CAR, ROAD, WEIGHTS, {}), "sensors must name at least one output"),
        (lambda: ss.lqg(CAR, ROAD, WEIGHTS, {"sws": 0.0}), "sws must be finite and > 0"),
        (lambda: ss.skyhook(CAR, ROAD, "1"), "must be a number >= 0, got '1'"),
        (lambda: ss.skyhook(CAR, ROAD, 1.0, lag=-1.0), "skyhook\\(lag=...\\) must be finite and >= 0"),
        (lambda: ss.skyhook(CAR, None, 1.0), "road must be a Road"),
        (lambda: ss.tuned(lambda gain: ss.skyhook(CAR, ROAD, gain), {}), "start must be a mapping of numbers > 0"),
        (lambda: ss.tuned(lambda gain: ss.skyhook(CAR, ROAD, gain), {"gain": 9.0}, "bac"), "no metric named 'bac'"),
        (
            lambda: ss.tuned(ss.skyhook(CAR, ROAD, 9.0), {"sky": 9.0}),
            "no 'sky' to tune, available: gain, lag",
        ),
        (
            lambda: ss.tuned(ss.lqr(CAR, ROAD, WEIGHTS), {"gain": 9.0}),
            "law must be a skyhook",
        ),
        (lambda: ss.tuned(None, {"gain": 9.0}), "law must be"),
        (
            lambda: ss.tuned(ss.skyhook(CAR, ROAD, 9.0), {"gain": 9.0}, "bacc", {"dtl": 9.0}),
            "keep dtl below 9; start",
        ),
        (lambda: ss.groundhook(CAR, ROAD, -1.0), "groundhook\\(gain=...\\) must be finite and >= 0"),
    ],
)
def test_wrong_arguments_are_refused_in_one_line(make, said):
    with pytest.raises((TypeError, ValueError), match=said):
        make()
