"""The reference results agree with each other, so that an error in one of them is found."""

import mpmath
import numpy as np
import pytest
import scipy.integrate
import scipy.linalg

import oracles
from oracles import RoadCase

TABLE = {"mu": 45.4, "ks": 18553.0, "cs": 1516.5, "kt": 192e3}
UNEQUAL = {
    "mu": (40.0, 44.0, 51.0, 47.0),
    "ks": (15e3, 17e3, 22e3, 24e3),
    "cs": (900.0, 1300.0, 1700.0, 2100.0),
    "kt": (180e3, 190e3, 205e3, 220e3),
}


def _pair(values):
    return {name: value[1:3] for name, value in values.items()}


FULL = {"mb": 1270.0, "iyy": 1067.22, "ixx": 220.45, "a": 0.961, "b": 1.504, "c": 0.723}
PITCH = {"mb": 635.0, "iyy": 533.61, "a": 0.961, "b": 1.504}
ROLL = {"mb": 635.0, "ixx": 110.225, "c": 0.723}
MODELS = {
    "rigid tyre": oracles.rigid_tyre_matrices(317.5, 18553.0, 1516.5),
    "quarter": oracles.quarter_matrices(317.5, **TABLE),
    "quarter, tyre damping": oracles.quarter_matrices(317.5, **TABLE, ct=300.0),
    "pitch": oracles.pitch_half_matrices(**PITCH, **_pair(UNEQUAL)),
    "roll": oracles.roll_half_matrices(**ROLL, **_pair(UNEQUAL), arb=7e3),
    "full": oracles.full_car_matrices(**FULL, **TABLE),
    "full, light damping": oracles.full_car_matrices(**FULL, **(TABLE | {"cs": 5.0})),
    "full, unequal": oracles.full_car_matrices(**FULL, **UNEQUAL, arb_front=8e3, arb_rear=3e3),
    "full, tyre damping": oracles.full_car_matrices(**FULL, **UNEQUAL, ct=(50.0, 100.0, 150.0, 200.0), arb_front=8e3),
}
models = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)


def agree(got, expected, rtol):
    assert got.keys() == expected.keys()
    scale = {name: max(v for v in expected.values() if np.isfinite(v)) for name in expected}
    for name, value in expected.items():
        assert float(got[name]) == pytest.approx(float(value), rel=rtol, abs=1e-18 * float(scale[name])), name


# ---------------------------------------------------------------------------------------------------- equations


@models
def test_forces_are_reciprocal_and_dissipative(model):
    for matrix in (model.K, model.C):
        np.testing.assert_allclose(matrix, matrix.T, rtol=0, atol=1e-12 * np.abs(matrix).max())
    assert np.linalg.eigvalsh(model.K).min() > 0
    assert np.linalg.eigvalsh(model.C).min() > -1e-9


@models
def test_a_rigid_road_lifts_the_car_without_force(model):
    """Heave, pitch and roll of a plane road are followed by wheels and body with no force."""
    body = np.array([[0.0 if name.startswith("z_u") else 1.0 for name in model.coordinates]])
    planes = []
    for tilt in range(1 + ("theta" in model.coordinates) + ("phi" in model.coordinates)):
        moved = ["z_b", *(name for name in ("theta", "phi") if name in model.coordinates)][tilt]
        z = {name: float(name == moved) for name in model.coordinates}
        road = [_point_above(model, wheel, z) for wheel in model.wheels]
        q = np.array([z[name] for name in model.coordinates]) * body[0]
        for i, name in enumerate(model.coordinates):
            if name.startswith("z_u"):
                q[i] = road[i]
        planes.append((q, road))
    for q, road in planes:
        np.testing.assert_allclose(model.K @ q, model.K_in @ road, rtol=0, atol=1e-12 * np.abs(model.K).max())
        np.testing.assert_allclose(model.C @ q, model.C_in @ road, rtol=0, atol=1e-12 * np.abs(model.C).max())


def _point_above(model, wheel, z):
    row = model.outputs[f"bacc_{wheel}" if wheel else "bacc"].a
    return float(row @ [z[name] for name in model.coordinates])


def test_stiffness_is_the_hessian_of_the_spring_energy():
    """2 U = sum k_s (z_u - z_s)^2 + k_t (z_r - z_u)^2 + arb (d_right - d_left)^2, second differences exact in U."""
    car, ks, kt = FULL, UNEQUAL["ks"], UNEQUAL["kt"]
    model = MODELS["full, unequal"]

    def energy(q, r):
        z_u, (z_b, theta, phi) = q[:4], q[4:]
        x, y = (-car["a"], -car["a"], car["b"], car["b"]), (-car["c"], car["c"], -car["c"], car["c"])
        d = [z_u[i] - (z_b + x[i] * theta + y[i] * phi) for i in range(4)]
        springs = sum(ks[i] * d[i] ** 2 + kt[i] * (r[i] - z_u[i]) ** 2 for i in range(4))
        return (springs + 8e3 * (d[0] - d[1]) ** 2 + 3e3 * (d[2] - d[3]) ** 2) / 2

    def mixed(u, v):
        return (energy((u + v)[:7], (u + v)[7:]) - energy((u - v)[:7], (u - v)[7:])) / 2

    unit = np.eye(11)
    hessian = np.array([[mixed(unit[i], unit[j]) for j in range(11)] for i in range(11)])
    np.testing.assert_allclose(hessian[:7, :7], model.K, rtol=0, atol=1e-9)
    np.testing.assert_allclose(hessian[:7, 7:], -model.K_in, rtol=0, atol=1e-9)


def test_half_cars_are_the_full_car_moved_alike_or_by_one_axle():
    full, pitch = MODELS["full"], oracles.pitch_half_matrices(**PITCH, **TABLE)
    alike = np.zeros((7, 4))
    alike[[0, 1], 0] = alike[[2, 3], 1] = alike[4, 2] = alike[5, 3] = 1.0
    both_tracks = np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0]])
    for name in ("M", "C", "K"):
        np.testing.assert_allclose(
            alike.T @ getattr(full, name) @ alike, 2 * getattr(pitch, name), rtol=1e-12, atol=1e-9
        )
    np.testing.assert_allclose(alike.T @ full.K_in @ both_tracks, 2 * pitch.K_in, rtol=1e-12)

    even = FULL | {"a": 1.2, "b": 1.2}
    full = oracles.full_car_matrices(**even, **TABLE, arb_front=4e3, arb_rear=4e3)
    roll = oracles.roll_half_matrices(**ROLL, **TABLE, arb=4e3)
    alike = np.zeros((7, 4))
    alike[[0, 2], 0] = alike[[1, 3], 1] = alike[4, 2] = alike[6, 3] = 1.0
    for name in ("M", "C", "K"):
        np.testing.assert_allclose(
            alike.T @ getattr(full, name) @ alike, 2 * getattr(roll, name), rtol=1e-12, atol=1e-9
        )


@models
def test_state_space_and_dynamic_stiffness_agree(model):
    f = np.array([0.3, 1.3, 9.0, 40.0])
    system, response = oracles.first_order(model), oracles.frequency_response(model, f)
    for i, s in enumerate(2j * np.pi * f):
        x = np.linalg.solve(s * np.eye(len(system.A)) - system.A, system.B)
        for name, row in system.C.items():
            scale = np.abs(response[name][:, i]).max()
            np.testing.assert_allclose(row @ x + system.D[name], response[name][:, i], rtol=1e-9, atol=1e-10 * scale)


def test_improper_outputs_are_left_out():
    assert set(oracles.first_order(MODELS["rigid tyre"]).C) == {"sws"}
    assert set(oracles.first_order(MODELS["quarter, tyre damping"]).C) == {"bacc", "sws", "sws_rate", "tyre_deflection"}
    assert len(oracles.first_order(MODELS["full, unequal"]).C) == len(MODELS["full"].outputs)


# ---------------------------------------------------------------------------------------------------- roads


def test_road_intensity_is_half_the_one_sided_velocity_density():
    f, roughness, speed = 3.0, 64e-6, 20.0
    displacement = roughness * (f / speed / 0.1) ** -2 / speed
    assert 2 * oracles.road_intensity(roughness, speed) == pytest.approx((2 * np.pi * f) ** 2 * displacement)


@pytest.mark.parametrize("waviness", [1.6, 2.0, 2.5])
@pytest.mark.parametrize("n", [0.003, 0.02, 0.1, 0.6])
def test_coherence_is_the_transform_of_an_isotropic_plane_spectrum(waviness, n):
    width = 1.446

    def plane(k):
        return (n**2 + k**2) ** (-(waviness + 1) / 2)

    together = scipy.integrate.quad(plane, 0, np.inf, epsabs=0, epsrel=1e-11)[0]
    across = scipy.integrate.quad(plane, 0, np.inf, weight="cos", wvar=2 * np.pi * width, epsabs=1e-9 * together)[0]
    assert oracles.coherence_isotropic(n, width, waviness) == pytest.approx(across / together, rel=1e-5)


@pytest.mark.parametrize("waviness", [1.6, 2.0, 2.5])
def test_coherence_against_multiple_precision(waviness):
    for x in (1e-6, 1e-3, 0.09, 0.11, 3.0):
        nu, h = mpmath.mpf(waviness) / 2, mpmath.mpf(x) / 2
        with mpmath.workdps(40):
            apart = 1 - 2 / mpmath.gamma(nu) * h**nu * mpmath.besselk(nu, 2 * h)
        got = oracles._incoherence_isotropic(np.array([x / (2 * np.pi)]), 1.0, waviness)[0]
        assert got == pytest.approx(float(apart), rel=1e-11)


# ---------------------------------------------------------------------------------------------------- variances


@models
@pytest.mark.parametrize("tracks", ["identical", "independent"])
@pytest.mark.parametrize("delay", [True, False])
@pytest.mark.parametrize(("speed", "cutoff"), [(4.0, 0.0), (20.0, 0.0), (20.0, 0.01)])
def test_lyapunov_and_spectral_agree(model, tracks, delay, speed, cutoff):
    road = RoadCase(speed=speed, cutoff=cutoff, tracks=tracks, delay=delay)
    exact, integral = oracles.variance_lyapunov_delay(model, road), oracles.variance_spectral(model, road)
    strong = {name: value for name, value in exact.items() if value > 1e-15}
    rtol = 1e-8 if model is MODELS["full, light damping"] else 1e-10
    agree({name: integral[name] for name in strong}, strong, rtol)
    assert all(integral[name] < 1e-15 for name in exact.keys() - strong.keys())


@pytest.mark.parametrize("wheels", [("fr", "rr"), ("fl", "rl"), ("fr", "fl", "rr", "rl")])
def test_one_track_excited(wheels):
    road = RoadCase(tracks="independent", wheels=wheels)
    model = MODELS["full, unequal"]
    agree(oracles.variance_spectral(model, road), oracles.variance_lyapunov_delay(model, road), 1e-10)


@pytest.mark.parametrize("tracks", ["independent", "four"])
def test_independent_sources_add(tracks):
    model = MODELS["full, unequal"]
    road = RoadCase(tracks=tracks, cutoff=0.01)
    sides = [("fr", "rr"), ("fl", "rl")] if tracks == "independent" else [(c,) for c in oracles.CORNERS]
    parts = [oracles.variance_lyapunov_delay(model, road._replace(wheels=side)) for side in sides]
    agree({n: sum(p[n] for p in parts) for n in parts[0]}, oracles.variance_lyapunov_delay(model, road), 1e-10)


def test_a_vanishing_cutoff_leads_to_none():
    """The plain states with a cut-off and the road-relative states with the warp: two derivations, one limit."""
    model = MODELS["full, unequal"]
    for tracks in ("identical", "independent"):
        without, with_cutoff = (
            oracles.variance_lyapunov_delay(model, RoadCase(tracks=tracks, cutoff=cutoff)) for cutoff in (0.0, 1e-7)
        )
        agree(with_cutoff, without, 2e-6)


@pytest.mark.parametrize("tracks", ["independent", "isotropic", "four"])
@pytest.mark.parametrize("route", [oracles.variance_lyapunov_delay, oracles.variance_spectral])
def test_a_drifting_warp_is_refused(tracks, route):
    with pytest.raises(ValueError, match=r"drifts|identical"):
        route(MODELS["full"], RoadCase(tracks=tracks, wheels=("fr",)))


def test_isotropic_tracks_lie_between_their_limits():
    model, road = MODELS["full, unequal"], RoadCase(tracks="isotropic")
    one = oracles.variance_spectral(model, road._replace(coherence=lambda n: np.ones_like(n)))
    two = oracles.variance_spectral(model, road._replace(coherence=lambda n: np.zeros_like(n)))
    agree(one, oracles.variance_lyapunov_delay(model, road._replace(tracks="identical")), 1e-10)
    agree(two, oracles.variance_lyapunov_delay(model, road._replace(tracks="independent")), 1e-10)
    isotropic = oracles.variance_spectral(model, road)
    assert one["roll_acc"] < isotropic["roll_acc"] < two["roll_acc"]
    assert two["bacc_cg"] < isotropic["bacc_cg"] < one["bacc_cg"]


@pytest.mark.parametrize("delay", [True, False])
def test_a_first_order_coherence_is_two_white_sources_and_a_coloured_one(delay):
    """gamma = 1/(1 + (n/n_1)^2) for the car whose sides are equal: mean and half difference act apart.

    The mean sees (1 + gamma)/2, the half difference (1 - gamma)/2 = (n/n_1)^2/(1 + (n/n_1)^2)/2: white velocity
    plus or minus the spectrum with the cut-off complement, 1 - n^2/(n^2 + n_1^2).
    """
    model, n_1 = MODELS["full"], 0.08
    road = RoadCase(delay=delay, cutoff=0.02)
    coherent = road._replace(tracks="isotropic", coherence=lambda n: 1 / (1 + (n / n_1) ** 2))
    got = oracles.variance_spectral(model, coherent)

    def part(density, sign):
        """Variances by adaptive quadrature of one source that enters both tracks with this sign."""
        F, R = np.array([[1.0], [sign], [0.0], [0.0]]), np.array([[0.0], [0.0], [1.0], [sign]])
        tau = model.wheelbase / road.speed if delay else 0.0

        def power(log_f):
            f = np.exp(log_f)
            n = f / road.speed
            G = road.roughness * (n / 0.1) ** -2 * n**2 / (n**2 + road.cutoff**2) / road.speed * density(n)
            h = oracles.frequency_response(model, f)
            Z = (F + R * np.exp(-2j * np.pi * f * tau))[:, 0]
            return f * G * np.array([abs(h[name][:, 0] @ Z) ** 2 for name in ("bacc_fr", "sws_rr", "roll_acc")])

        return scipy.integrate.quad_vec(power, np.log(1e-5), np.log(200.0), epsrel=1e-7, limit=400)[0]

    mean = part(lambda n: (1 + 1 / (1 + (n / n_1) ** 2)) / 2, 1.0)
    half_difference = part(lambda n: (1 - 1 / (1 + (n / n_1) ** 2)) / 2, -1.0)
    expected = mean + half_difference
    np.testing.assert_allclose([got[n] for n in ("bacc_fr", "sws_rr", "roll_acc")], expected, rtol=2e-5)


@pytest.mark.parametrize("waviness", [1.7, 2.0, 2.4])
@pytest.mark.parametrize("tracks", ["identical", "isotropic", "four"])
def test_densities_integrate_to_the_variance(waviness, tracks):
    model, road = MODELS["full, unequal"], RoadCase(waviness=waviness, tracks=tracks, cutoff=0.005)
    f = np.exp(np.linspace(np.log(1e-8), np.log(3e3), 30001))
    density, variance = oracles.psd(model, road, f), oracles.variance_spectral(model, road)
    for name in ("bacc_cg", "bacc_fl", "pitch_acc", "roll_acc", "sws_rr"):
        assert scipy.integrate.simpson(density[name] * f, x=np.log(f)) == pytest.approx(variance[name], rel=2e-4), name


def test_multiple_precision_agrees_and_repairs():
    road = RoadCase(tracks="independent")
    model = MODELS["pitch"]
    agree(oracles.variance_lyapunov_delay(model, road, digits=30), oracles.variance_lyapunov_delay(model, road), 1e-11)
    rng = np.random.default_rng(0)
    A = rng.normal(size=(5, 5)) - 4 * np.eye(5)
    Q = np.eye(5)
    X = oracles.variance_lyapunov_mpmath(A, Q).astype(float)
    np.testing.assert_allclose(X, scipy.linalg.solve_continuous_lyapunov(A, -Q), rtol=1e-11, atol=1e-13)

    # five decades between the masses: parameters given as exact numbers keep every digit
    ms, mu, ks, cs, kt = (mpmath.mpf(x) for x in (317.5, 1e-7, 1.0, 1e-4, 1e9))
    stiff = oracles.quarter_matrices(ms, mu, ks, cs, kt)
    exact = oracles.variance_lyapunov_delay(stiff, road, digits=80)
    q = oracles.road_intensity(road.roughness, road.speed)
    assert exact["sws"] == pytest.approx(oracles.quarter_deflection_variance(ms, mu, cs, q), rel=1e-15)
    assert exact["bacc"] == pytest.approx(oracles.quarter_body_acceleration_variance(ms, mu, ks, cs, kt, q), rel=1e-15)


# ---------------------------------------------------------------------------------------------------- closed forms


@pytest.mark.parametrize("factor", [0.3, 1.0, 3.0])
def test_quarter_car_closed_forms(factor):
    ms, mu, ks, cs, kt = 317.5, 45.4 * factor, 18553.0 / factor, 1516.5 * factor**2, 192e3
    road = RoadCase()
    q = oracles.road_intensity(road.roughness, road.speed)
    model = oracles.quarter_matrices(ms, mu, ks, cs, kt)
    expected = {
        "bacc": oracles.quarter_body_acceleration_variance(ms, mu, ks, cs, kt, q),
        "sws": oracles.quarter_deflection_variance(ms, mu, cs, q),
        "sws_rate": oracles.quarter_deflection_rate_variance(cs, kt, q),
        "dtl": oracles.quarter_tyre_force_variance(ms, mu, ks, cs, kt, q),
        "tyre_deflection": oracles.quarter_tyre_force_variance(ms, mu, ks, cs, kt, q) / kt**2,
    }
    agree(oracles.variance_lyapunov_delay(model, road), expected, 1e-11)
    agree(oracles.variance_spectral(model, road), expected, 1e-10)
    power = oracles.metrics(model, expected)["damper_power"]
    assert power == pytest.approx(oracles.quarter_damper_power(kt, q), rel=1e-14)


def test_rigid_tyre_closed_form_and_infinities():
    road, model = RoadCase(), MODELS["rigid tyre"]
    variance = oracles.variance_lyapunov_delay(model, road)
    q = oracles.road_intensity(road.roughness, road.speed)
    assert variance["sws"] == pytest.approx(oracles.rigid_tyre_deflection_variance(317.5, 1516.5, q), rel=1e-12)
    assert {name for name, value in variance.items() if value == np.inf} == {"bacc", "sws_rate", "dtl"}
    damped = oracles.variance_spectral(MODELS["full, tyre damping"], road)
    assert {name for name, value in damped.items() if value == np.inf} == {f"dtl_{c}" for c in oracles.CORNERS}


def test_comfort_optimal_damping_is_a_minimum():
    ms, mu, ks, kt = 317.5, 45.4, 18553.0, 192e3
    best = oracles.comfort_optimal_damping(ms, mu, ks, kt)
    here, below, above = (
        oracles.quarter_body_acceleration_variance(ms, mu, ks, best * x, kt, 1.0) for x in (1.0, 0.999, 1.001)
    )
    assert here < min(below, above)
    assert above - below == pytest.approx(0.0, abs=1e-8 * here)


@pytest.mark.parametrize("arb", [0.0, 5e3])
def test_heave_pitch_and_roll_of_the_even_car_are_quarter_cars(arb):
    even = FULL | {"a": 1.2, "b": 1.2}
    model = oracles.full_car_matrices(**even, **TABLE, ct=80.0, arb_front=arb, arb_rear=arb)
    masses = oracles.equivalent_sprung_masses(even["mb"], even["iyy"], even["ixx"], 1.2, even["c"])
    shapes = {"heave": (1, 1, 1, 1), "pitch": (-1, -1, 1, 1), "roll": (-1, 1, -1, 1)}
    f = np.array([0.2, 1.0, 1.5, 8.0, 12.0, 60.0])
    response = oracles.frequency_response(model, f)
    for mode, shape in shapes.items():
        bar = 2 * arb if mode == "roll" else 0.0
        spring = TABLE["ks"] + bar
        quarter = oracles.quarter_matrices(masses[mode], **(TABLE | {"ks": spring}), ct=80.0)
        expected = oracles.frequency_response(quarter, f)
        for i, corner in enumerate(oracles.CORNERS):
            for name in ("bacc", "sws", "dtl", "sws_rate"):
                got = shape[i] * np.array(shape) @ response[f"{name}_{corner}"]
                np.testing.assert_allclose(got, expected[name][0], rtol=1e-9)


def test_the_even_car_on_identical_tracks_is_the_quarter_car():
    even = FULL | {"a": 1.2, "b": 1.2}
    car = oracles.variance_lyapunov_delay(oracles.full_car_matrices(**even, **TABLE), RoadCase(delay=False))
    quarter = oracles.variance_lyapunov_delay(MODELS["quarter"], RoadCase())
    for name, value in quarter.items():
        for corner in oracles.CORNERS:
            assert car[f"{name}_{corner}"] == pytest.approx(value, rel=1e-11)


def test_metrics_scale_with_roughness_and_speed():
    model = MODELS["full, unequal"]
    slow, fast = (RoadCase(r, v, tracks="independent", delay=False) for r, v in ((64e-6, 10.0), (256e-6, 30.0)))
    slow, fast = (oracles.variance_lyapunov_delay(model, road) for road in (slow, fast))
    agree({name: 12 * value for name, value in slow.items()}, fast, 1e-11)


@pytest.mark.parametrize(("corner", "lever"), [("fr", 0.961), ("rl", 1.504)])
def test_corner_effective_mass_is_the_high_frequency_limit(corner, lever):
    """Far above every resonance the wheel stands still against the body: z_s'' per corner force is 1/m."""
    model = MODELS["full"]
    point = model.outputs[f"bacc_{corner}"].a
    mass = oracles.corner_effective_mass(1270.0, 1067.22, 220.45, lever, 0.723)
    assert 1 / (point @ np.linalg.solve(model.M, point)) == pytest.approx(mass, rel=1e-12)
    assert mass == pytest.approx(248.5 if corner == "fr" else 189.5, abs=0.05)


def test_natural_frequencies_of_the_table_limits():
    """1.0 and 1.4 Hz of the bare sprung mass are the limits of Table 2; the wheel hops near 11 Hz."""
    for ks, body in ((12536.0, 1.0), (24570.0, 1.4)):
        assert np.sqrt(ks / 317.5) / (2 * np.pi) == pytest.approx(body, rel=1e-3)
    low, high = oracles.natural_frequencies(MODELS["quarter"])
    assert 1.0 < low < 1.22
    assert 10.0 < high < 12.0
    assert len(oracles.natural_frequencies(MODELS["full"])) == 7
