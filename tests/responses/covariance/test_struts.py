"""More struts than two, by polynomials: against matrices, halves, multiple precision, and a truck against scipy."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings

import models
import oracles
import susp_ss as ss
from models import ROADS, VEHICLES, WHEEL_ROADS
from susp_ss.responses.covariance import digits, polynomials, routes, struts, symmetric, whole
from susp_ss.responses.excitation import processes, spanned
from susp_ss.vehicles.half import corners
from susp_ss.vehicles.linkage import Linkage, Wheel, coordinates
from susp_ss.vehicles.vehicle import Vehicle

ON_STRUTS = {name: vehicle for name, vehicle in VEHICLES.items() if name != "rigid tyre"}


def by_struts(vehicle, road):
    """Variances (outputs, N), and which designs (N,) are left to matrices, where nothing is split."""
    space, flat, flat_road = spanned(vehicle, road)
    return whole.whole_variances([flat.whole()], flat, flat_road, space.size)


def by_matrices(vehicle, road):
    space, flat, flat_road = spanned(vehicle, road)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Vehicle, "halves", lambda _: ())
        patch.setattr(Vehicle, "whole", lambda _: None)
        return routes.covariance_variances(flat, space, flat_road).T


@pytest.mark.parametrize("road", [*ROADS, *WHEEL_ROADS])
@pytest.mark.parametrize("vehicle", ON_STRUTS)
def test_every_vehicle_on_every_road_agrees_with_its_matrices(vehicle, road):
    car, where = ON_STRUTS[vehicle], {**ROADS, **WHEEL_ROADS}[road]
    if where.wheels is not None and not set(where.wheels) <= set(car.wheels):
        pytest.skip("names wheels of a full car")
    values, left = by_struts(car, where)
    if not left.any():
        np.testing.assert_allclose(values, by_matrices(car, where), rtol=2e-11, atol=1e-25)
    else:
        # One wheel of an axle warps the road without bound; a damped tyre whose wheel sees none has a finite load.
        assert where.wheels is not None


@given(models.full_cars, models.roads)
@settings(max_examples=60)
def test_full_cars_and_their_matrices_agree(car, road):
    values, left = by_struts(car, road)
    if not left.any():
        np.testing.assert_allclose(values, by_matrices(car, road), rtol=3e-9, atol=0.0)


@pytest.mark.parametrize("waviness", [1.3, 2.0, 2.6, 3.4])
@pytest.mark.parametrize("tracks", ["identical", "isotropic"])
@pytest.mark.parametrize("contact", [0.0, 0.1])
def test_a_symmetric_car_is_the_same_whole_as_in_halves_on_any_road(waviness, tracks, contact):
    car, road = (
        ss.FullCar(arb_front=20e3, arb_rear=8e3),
        ss.Road(waviness=waviness, tracks=tracks, contact_length=contact),
    )
    _, flat, flat_road = spanned(car, road)
    halves, left = symmetric.symmetric_variances(flat.halves(), flat, flat_road, 1)
    assert not left.any()
    # Terms of a fitted spectrum cancel one another: so many digits it has in either.
    rtol = 1e-6 if waviness > 3.0 else 2e-7 if contact else 1e-11
    values, _ = by_struts(car, road)
    # On identical steep tracks long waves leave roll undecided: it is left to matrices, which find it zero.
    values[np.isnan(values) & (halves == 0.0)] = 0.0
    np.testing.assert_allclose(values, halves, rtol=rtol, atol=1e-20)


@pytest.mark.parametrize("speed", [0.1, 1.0, 4.0])
@pytest.mark.parametrize("tracks", ["identical", "independent", "isotropic"])
def test_long_delays(speed, tracks):
    car, road = VEHICLES["full, unequal corners, bars, tyre damping"], ss.Road(tracks=tracks, speed=speed)
    values, left = by_struts(car, road)
    assert not left.any()
    np.testing.assert_allclose(values, by_matrices(car, road), rtol=3e-11)


def test_a_delay_that_is_too_long_leaves_only_its_own_designs():
    kt, road = np.array([192e3, 192e7, 180e3]), ss.Road(speed=0.3)
    ks = ss.Corners(fr=16e3, fl=18e3, rr=21e3, rl=24e3)
    values, left = by_struts(ss.FullCar(ks=ks, kt=kt), road)
    assert left.tolist() == [False, True, False]
    np.testing.assert_allclose(values[:, ~left], by_matrices(ss.FullCar(ks=ks, kt=kt[~left]), road), rtol=1e-10)


def apart(share):
    """A full car whose corners differ by so much, with bars."""
    steps = (1.0 + share) ** np.array([[0.4, -0.5, 0.1, 0.3], [-0.2, 0.5, 0.4, -0.5], [0.5, 0.1, -0.5, -0.2]])
    ks, cs, kt = (
        ss.Corners(**dict(zip(models.CORNERS, value * row, strict=True)))
        for value, row in zip((18e3, 1500.0, 192e3), steps, strict=True)
    )
    return ss.FullCar(
        ks=ks, cs=cs, kt=kt, mu=ss.Corners(fr=41.0, fl=44.0, rr=47.0, rl=52.0), arb_front=9e3, arb_rear=4e3
    )


@pytest.mark.parametrize(("share", "delay"), [(0.05, True), (0.3, False), (1.0, True)])
def test_corners_apart_against_multiple_precision(share, delay):
    car, road = apart(share), oracles.RoadCase(speed=20.0, delay=delay)
    metrics = ss.ride_metrics(car, ss.Road(delay=delay))
    oracle = models.oracle(car, digits=50)
    exact = oracles.metrics(oracle, oracles.variance_lyapunov_delay(oracle, road, digits=50))
    found = {"roll_acc": metrics.roll_acc, "pitch_acc": metrics.pitch_acc, "bacc_cg": metrics.bacc.sel(point="cg")}
    for corner in models.CORNERS:
        found |= {f"{name}_{corner}": metrics[name].sel(corner=corner) for name in ("sws", "dtl")}
    for name, value in found.items():
        np.testing.assert_allclose(float(value), float(exact[name]), rtol=2e-12, err_msg=name)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("spread", [10.0, 30.0])
def test_extreme_corners_keep_six_digits_or_are_left(spread, seed):
    rng = np.random.default_rng(seed)

    def far(value):
        return ss.Corners(**{name: value * spread ** rng.uniform(-1.0, 1.0, 40) for name in models.CORNERS})

    cars = ss.FullCar(mu=far(45.4), ks=far(18e3), cs=far(1500.0), kt=far(192e3), arb_front=5e3)
    values, left = by_struts(cars, ss.Road(tracks="isotropic"))
    exact = by_matrices(cars, ss.Road(tracks="isotropic"))
    np.testing.assert_allclose(values[:, ~left], exact[:, ~left], rtol=1e-6)


def test_a_sweep_over_speed_is_each_of_its_speeds():
    car, speeds = apart(0.3), np.array([3.0, 12.0, 40.0])
    together = ss.ride_metrics(car, ss.Road(speed=speeds, tracks="isotropic"))
    for i, speed in enumerate(speeds):
        alone = ss.ride_metrics(car, ss.Road(speed=float(speed), tracks="isotropic"))
        for name in alone:
            np.testing.assert_allclose(together[name].isel(design=i), alone[name], rtol=1e-10)


@pytest.mark.parametrize("share", [1e-3, 0.05, 0.3])
def test_wheels_that_hop_alike_and_long_keep_their_digits_or_are_left(share):
    rng, road = np.random.default_rng(0), ss.Road(tracks="isotropic")

    def near(value):
        return ss.Corners(**{name: value * (1.0 + share) ** rng.uniform(-1.0, 1.0, 40) for name in models.CORNERS})

    for damping, kept in ((0.5, 1e-10), (0.3, 2e-9), (0.1, 5e-9), (0.01, 5e-9)):
        cars = ss.FullCar(mu=near(45.4), ks=near(18e3), cs=near(1500.0 * damping), kt=near(192e3), arb_front=5e3)
        values, left = by_struts(cars, road)
        assert not (damping == 0.5 and left.any())
        np.testing.assert_allclose(values[:, ~left], by_matrices(cars, road)[:, ~left], rtol=kept)


def test_what_polynomials_cannot_hold_is_left():
    uneven = ss.Corners(fr=17e3, fl=18e3, rr=19e3, rl=20e3)
    undamped = ss.FullCar(ks=uneven, cs=ss.Corners(fr=0.0, fl=1e3, rr=1e3, rl=1e3), ct=np.array([0.0, 50.0]))
    assert by_struts(undamped, ss.Road())[1].tolist() == [True, False]
    assert by_struts(ss.FullCar(ks=uneven, ct=50.0), ss.Road(contact_length=0.1))[1].all()
    assert by_struts(ss.FullCar(ks=uneven), ss.Road(wheels=("fr",), cutoff=0.02))[1].all()
    steep = ss.Road(tracks="independent", waviness=3.2)
    assert by_struts(ss.FullCar(ks=uneven), steep)[1].all()


@pytest.mark.parametrize("ks", [18e3, ss.Corners(fr=17e3, fl=18e3, rr=19e3, rl=20e3)])
def test_steep_independent_tracks_are_refused(ks):
    with pytest.raises(ValueError, match="warp of the road under the wheels has no finite variance"):
        ss.ride_metrics(ss.FullCar(ks=ks), ss.Road(tracks="independent", waviness=3.2))


def test_roll_is_zero_by_symmetry_and_small_beside_it():
    rolls = []
    for share in (0.0, 1e-7, 1e-5):
        ks = ss.Corners(fr=18e3 * np.array([1.0 + share, 1.1]), fl=18e3, rr=18e3, rl=18e3)
        rolls.append(float(ss.ride_metrics(ss.FullCar(ks=ks), ss.Road()).roll_acc[0]))
    assert rolls[0] == 0.0
    # Roll is of first order in what sets both sides apart.
    np.testing.assert_allclose(rolls[1] / rolls[2], 1e-2, rtol=1e-4)


def test_minors_are_determinants():
    rng = np.random.default_rng(0)
    for S in (2, 3, 5):
        M = rng.normal(size=(S, S, 5, 1))
        minors = np.ones((1, 1, 1))
        for k, table in enumerate(struts.expansions(S)):
            minors = struts.expanded(M[S - 1 - k], minors, table, 0)
        at = 0.7 ** np.arange(4 * S + 1)
        exact = np.linalg.det((M[..., 0] * at[:5]).sum(axis=-1))
        np.testing.assert_allclose((minors[0, :, 0] * at).sum(), exact, rtol=1e-12)


@pytest.mark.parametrize("times", [0, 3, 8])
def test_powers_squared_are_those_of_the_companion(times):
    D = polynomials.product(*(np.array([[w**2], [2.0 * z * w], [1.0]]) for z, w in ((0.3, 8.0), (0.2, 60.0))))
    drifting = np.concatenate([np.zeros((2, 1)), D])
    p = polynomials.delay_operator(drifting, np.array([0.01]), 0)
    companion = np.eye(6, k=1)
    companion[-1] = -drifting[:-1, 0]
    found = struts.squared(p, D, times)[:, :, 0]
    scale = 60.0 ** np.subtract.outer(np.arange(6), np.arange(6))
    exact = scipy.linalg.expm(companion * 0.01 * 2**times)
    np.testing.assert_allclose(found / scale, exact / scale, atol=1e-9)


@dataclass(frozen=True, kw_only=True, eq=False)
class Truck(Vehicle):
    """Three axles under a rigid body: six struts, whose wheels three warps of the road set apart."""

    mb: Any = 9000.0
    ixx: Any = 6000.0
    iyy: Any = 40e3
    a: Any = 2.8
    b: Any = 1.4
    c: Any = 1.0
    mu: Any = 450.0
    ks: Any = 250e3
    cs: Any = 12e3
    kt: Any = 900e3
    ct: Any = 0.0
    arb_front: Any = 60e3

    wheels: ClassVar[dict[str, Wheel]] = {
        f"{axle}{side}": Wheel(axle=int(axle > 1), side=-1 if side == "r" else 1) for axle in (1, 2, 3) for side in "rl"
    }

    def linkage(self):
        *wheels, heave, pitch, roll = coordinates(*(f"z_{name}" for name in self.wheels), "z_b", "theta", "phi")
        lift = {1: heave - self.a * pitch, 2: heave + self.b * pitch, 3: heave + (self.b + 1.3) * pitch}
        side = {"r": -self.c * roll, "l": self.c * roll}
        # No two corners are alike.
        mounts = {name: lift[int(name[0])] + side[name[1]] for name in self.wheels}
        at = corners(self, wheels, mounts)
        return Linkage(
            masses={**dict.fromkeys(wheels, self.mu), heave: self.mb, pitch: self.iyy, roll: self.ixx},
            corners=at,
            points={"cg": heave, **mounts},
            rotations={"pitch_acc": pitch, "roll_acc": roll},
            bars={("1r", "1l"): self.arb_front},
        )

    def at_wheels(self, name):
        return (
            tuple(getattr(self, name) * (1.0 + 0.05 * i) for i in range(6))
            if name in ("ks", "cs", "kt")
            else super().at_wheels(name)
        )


@pytest.mark.parametrize("tracks", ["identical", "independent"])
@pytest.mark.parametrize("delay", [False, True])
def test_a_truck_on_six_struts_against_scipy(tracks, delay):
    truck, road = Truck(), ss.Road(tracks=tracks, delay=delay)
    values, left = by_struts(truck, road)
    assert not left.any()
    model = truck.assemble()
    A, B, Y, _ = model.velocity_form()
    side = np.array([wheel.side for wheel in truck.wheels.values()], dtype=float)
    rear = np.array([wheel.axle for wheel in truck.wheels.values()], dtype=float)
    tau = (truck.a + truck.b) / road.speed
    exact = np.zeros(len(Y))
    processes = [(np.ones(6), 1.0)] if tracks == "identical" else [(np.ones(6), 0.5), (side, 0.5)]
    for weights, share in processes:
        q = share * road.intensity
        if not delay:
            front = B @ weights
            exact += np.einsum(
                "oi,ij,oj->o", Y, scipy.linalg.solve_continuous_lyapunov(A, -q * np.outer(front, front)), Y
            )
            continue
        at_once = weights * (1.0 - rear)
        front, back = B @ at_once, B @ (weights * rear)
        free = scipy.linalg.expm(A * tau) @ front
        cross = np.outer(free, back)
        Q = q * (np.outer(front, front) + np.outer(back, back) + cross + cross.T)
        X = scipy.linalg.solve_continuous_lyapunov(A, -Q)
        # Heights of the front wheels less those a delay before stretch the links; E[x warp] in closed form.
        stretched = model.elongation @ (model.R @ model.G + model.N) @ at_once
        with_warp = np.linalg.solve(A, free - front) * q
        exact += np.einsum("oi,ij,oj->o", Y, X, Y) + 2.0 * stretched * (Y @ with_warp) + stretched**2 * q * tau
    exact[np.abs(exact) < 1e-20] = 0.0
    # Six wheels hop nearly alike, so that degree 18 keeps ten digits of their loads; which ones the kernel decides.
    np.testing.assert_allclose(values[:, 0], exact, rtol=2e-10, atol=1e-18)


SEATS = {"driver": ss.Seat(x=0.3, y=0.4), "child": ss.Seat(x=-0.6, y=-0.35, mass=20.0, ks=12e3, cs=250.0)}

MORE = {
    "three axles": ss.ThreeAxleTruck(arb_rear=2e5),
    "three axles, unequal": ss.ThreeAxleTruck(ks=(2.3e5, 2.6e5, 5e5, 5.6e5, 5.2e5, 6.1e5), middle=-0.3),
    "quarter with a seat": ss.QuarterCarWithSeat(),
    "pitch half with a seat": ss.PitchHalfCar().with_seats({"driver": ss.Seat(x=0.3)}),
    "full with seats": ss.FullCar(arb_front=9e3).with_seats(SEATS),
    "full, unequal corners, with seats": VEHICLES["full, unequal corners"].with_seats(SEATS),
}


@pytest.mark.parametrize("road", ROADS.values(), ids=ROADS.keys())
@pytest.mark.parametrize("vehicle", MORE.values(), ids=MORE.keys())
def test_more_axles_and_seats_agree_with_their_matrices(vehicle, road):
    values, left = by_struts(vehicle, road)
    # Of six wheels that hop nearly alike, two systems of units agree to nine digits, or matrices answer.
    truck = len(vehicle.axles) > 2
    assert truck or not left.any()
    if not left.any():
        np.testing.assert_allclose(values, by_matrices(vehicle, road), rtol=2e-9 if truck else 1e-10, atol=1e-22)


def test_trucks_near_and_far_from_any_keep_nine_digits():
    rng, road, N = np.random.default_rng(5), ss.Road(tracks="independent"), 60
    for factor in (1.2, 3.0):

        def about(value, factor=factor):
            return value * factor ** rng.uniform(-1.0, 1.0, N)

        each = {
            name: tuple(about(value) for value in values)
            for name, values in {
                "mu": (270.0, 540.0, 540.0),
                "ks": (250e3, 550e3, 550e3),
                "cs": (10e3, 15e3, 15e3),
                "kt": (0.9e6, 1.8e6, 1.8e6),
            }.items()
        }
        trucks = ss.ThreeAxleTruck(mb=about(21e3), iyy=about(12e4), **each)
        values, left = by_struts(trucks, road)
        assert left.mean() < 0.2
        exact = by_matrices(trucks, road)
        np.testing.assert_allclose(values[:, ~left], exact[:, ~left], rtol=3e-9, atol=1e-22)


@pytest.mark.parametrize("road", ROADS.values(), ids=ROADS.keys())
def test_trucks_whose_sides_are_alike_go_by_halves(road):
    rng = np.random.default_rng(2)
    cs = tuple(value * 3.0 ** rng.uniform(-1.0, 1.0, 20) for value in (10e3, 15e3, 15e3))
    trucks = ss.ThreeAxleTruck(mb=21e3 * 1.5 ** rng.uniform(-1.0, 1.0, 20), cs=cs, arb_middle=2e5)
    space, flat, flat_road = spanned(trucks, road)
    mean, difference = flat.halves()
    assert [len(half.struts) for half in (mean, difference)] == [3, 3]
    values, left = whole.whole_variances([mean, difference], flat, flat_road, space.size)
    assert not left.any()
    np.testing.assert_allclose(values, by_matrices(trucks, road), rtol=1e-11, atol=1e-22)


def test_a_truck_is_a_vehicle_like_any_other():
    metrics = ss.ride_metrics(Truck(cs=np.array([10e3, 12e3])), ss.Road(tracks="isotropic"))
    assert metrics.sws.corner.values.tolist() == list(Truck.wheels)
    assert np.isfinite(metrics.dtl).all()
    with pytest.raises(ValueError, match="feels the height of the road"):
        ss.ride_metrics(Truck(), ss.Road(), method="spectral")


def test_a_rigid_tyre_or_matrices_of_its_own_take_matrices():
    from test_contracts import with_feedback

    assert ss.RigidTyreQuarterCar().whole() is None
    assert with_feedback(K=1e3)().whole() is None
    assert ss.FullCar().whole() is not None


def test_bounds_on_turns_hold():
    _, flat, _ = spanned(apart(1.0), ss.Road())
    problem = whole.problem(flat.whole(), flat, ss.Road(), 1, processes(flat, ss.Road()))
    roots = np.roots(struts.linked(problem.chassis).D[::-1, 0])
    (tau,) = problem.delays.values()
    bound = digits.turns(problem.stiffened(), problem.compliance(), tau)
    assert np.abs(roots).max() * tau <= bound <= 3.0 * np.abs(roots).max() * tau


@pytest.mark.parametrize("waviness", [3.2, 3.45, 3.7])
def test_a_truck_on_steep_roads_is_what_its_spectrum_says(waviness):
    truck, road = ss.ThreeAxleTruck(), ss.Road(waviness=waviness, tracks="isotropic")
    metrics, spectral = (ss.ride_metrics(truck, road, method=method) for method in ("covariance", "spectral"))
    for name, data in spectral.items():
        np.testing.assert_allclose(metrics[name], data, rtol=1e-5)
    slopes = ss.sensitivity(truck, road, ["roughness"])
    np.testing.assert_allclose(2.0 * road.roughness * slopes.sws[0], metrics.sws, rtol=1e-5)
