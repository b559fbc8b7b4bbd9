"""H-infinity control: levels against the frequency response of the loop, closed forms and MathWorks' suspension."""

import control as ct
import numpy as np
import pytest

import susp_ss as ss
from susp_ss.feedback.h_infinity import worst_gain


def peak(system, frequencies):
    return np.linalg.svd(np.moveaxis(system(1j * frequencies), -1, 0), compute_uv=False).max()


def active_suspension(beta):
    """MathWorks, Robust Control Toolbox, "Robust Control of Active Suspension": the nominal plant with its weights.

    Parameters and weights as its listing has them, forces in kN: ``Wroad = 0.07``, ``Wact = 0.8 (s + 50)/(s + 500)``,
    ``Wd2 = 0.01``, ``Wd3 = 0.5``, on the deflection ``beta`` over ``HandlingTarget = 0.04 (s/8 + 1)/(s/80 + 1)``, on
    the acceleration ``1 - beta`` over ``ComfortTarget = 0.4 (s/0.45 + 1)/(s/150 + 1)``, and the actuator
    ``1/(s/60 + 1)``.
    """
    mb, mw, bs, ks, kt = 300.0, 60.0, 1000.0, 16000.0, 190000.0
    A = [
        [0, 1, 0, 0],
        [-ks / mb, -bs / mb, ks / mb, bs / mb],
        [0, 0, 0, 1],
        [ks / mw, bs / mw, -(ks + kt) / mw, -bs / mw],
    ]
    B = [[0, 0], [0, 1e3 / mb], [0, 0], [kt / mw, -1e3 / mw]]
    car = ct.ss(A, B, [[1, 0, -1, 0], A[1]], [[0, 0], B[1]], inputs=["r", "fs"], outputs=["sd", "ab"], name="car")

    def part(numerator, denominator, source, to):
        return ct.ss(ct.tf(numerator, denominator), inputs=source, outputs=to, name=f"{source}_{to}")

    parts = [
        car,
        part([1], [1 / 60, 1], "u", "fs"),
        part([0.07], [1], "d1", "r"),
        part([0.8, 40.0], [1, 500], "u", "e1"),
        part(beta * np.array([1 / 80, 1]), 0.04 * np.array([1 / 8, 1]), "sd", "e2"),
        part((1 - beta) * np.array([1 / 150, 1]), 0.4 * np.array([1 / 0.45, 1]), "ab", "e3"),
        part([0.01], [1], "d2", "n1"),
        part([0.5], [1], "d3", "n2"),
        ct.summing_junction(["sd", "n1"], "y1", name="first"),
        ct.summing_junction(["ab", "n2"], "y2", name="second"),
    ]
    return ct.interconnect(parts, inputs=["d1", "d2", "d3", "u"], outputs=["e1", "e2", "e3", "y1", "y2"])


@pytest.mark.parametrize(("beta", "published"), [(0.01, 0.94), (0.5, 0.67), (0.99, 0.89)])
def test_the_active_suspension_of_mathworks(beta, published):
    """Levels as published, to both their digits; what the loop attains by its frequency response."""
    plant = active_suspension(beta)
    found = ss.h_infinity(plant, measured=["y1", "y2"], controls=["u"])
    loop = plant.lft(ct.ss(*(getattr(found.controller, part) for part in "ABCD")))
    assert loop.poles().real.max() < 0.0
    attained = peak(loop, np.geomspace(0.1, 1e3, 1500))
    assert attained <= found.level <= 1.001 * found.least < 1.0
    assert found.level == pytest.approx(attained, rel=3e-4)
    assert found.level == pytest.approx(published, abs=0.005)


def test_a_closed_form():
    """``x' = -x + w + u``, measured with noise, effort weighed: Riccati equations are quadratics, level sqrt(3) - 1."""
    plant = ct.ss(
        [[-1.0]], [[1.0, 0.0, 1.0]], [[1.0], [0.0], [1.0]], [[0, 0, 0], [0, 0, 1], [0, 1, 0]],
        inputs=["w", "noise", "u"], outputs=["x", "effort", "m"],
    )  # fmt: skip
    assert ss.h_infinity(plant, ["m"], ["u"]).level == pytest.approx(np.sqrt(3.0) - 1.0, rel=1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_the_level_is_never_below_what_the_loop_attains(seed):
    """Plants with all of D, stable or not."""
    rng = np.random.default_rng(seed)
    n, disturbances, controls, errors, measured = 5, 3, 2, 4, 2
    B, C = rng.normal(size=(n, disturbances + controls)), rng.normal(size=(errors + measured, n))
    D = rng.normal(size=(errors + measured, disturbances + controls))
    plant = ct.ss(rng.normal(size=(n, n)), B, C, D, inputs=5, outputs=6)
    found = ss.h_infinity(plant, ["y[4]", "y[5]"], ["u[3]", "u[4]"])
    loop = plant.lft(ct.ss(*(getattr(found.controller, part) for part in "ABCD")))
    assert loop.poles().real.max() < 0.0
    attained = peak(loop, np.geomspace(1e-3, 1e3, 800))
    assert attained <= found.level * (1.0 + 1e-9)
    assert found.least <= found.level <= 1.02 * found.least
    np.testing.assert_allclose(found.closed(1j), loop(1j), rtol=1e-6)


def test_worst_gain_of_a_resonance():
    """``1 / (s^2 + 2 z s + 1)`` peaks at ``1 / (2 z sqrt(1 - z^2))``."""
    z = 0.01
    A, B, C, D = np.array([[0.0, 1.0], [-1.0, -2.0 * z]]), np.array([[0.0], [1.0]]), np.eye(2)[:1], np.zeros((1, 1))
    exact = 1.0 / (2.0 * z * np.sqrt(1.0 - z**2))
    assert exact <= worst_gain(A, B, C, D) <= exact * (1.0 + 1e-5)


@pytest.mark.parametrize(
    ("measured", "controls", "said"),
    [
        (["y"], ["u"], "no output named 'y', available"),
        ("y1", ["u"], "measured must be a sequence of names"),
        (["y1"], [], "controls must be a sequence of names"),
        (["e2"], ["u"], "every measurement must carry noise of its own"),
    ],
)
def test_wrong_signals_are_refused_in_one_line(measured, controls, said):
    with pytest.raises((TypeError, ValueError), match=said):
        ss.h_infinity(active_suspension(0.5), measured, controls)


def test_what_no_control_reaches_is_refused():
    plant = ct.ss([[1.0, 0.0], [0.0, -1.0]], [[1, 0, 0], [0, 0, 1]], [[1, 1], [0, 0], [0, 1]],
                  [[0, 0, 0], [0, 0, 1], [0, 1, 0]], inputs=["w", "n", "u"], outputs=["z", "e", "y"])  # fmt: skip
    with pytest.raises(ValueError, match="no controller stabilises the plant"):
        ss.h_infinity(plant, ["y"], ["u"])
    with pytest.raises(TypeError, match="plant must be a"):
        ss.h_infinity(None, ["y"], ["u"])
