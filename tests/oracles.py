"""Reference results for the tests, written without the package: equations of motion, exact and numerical variances.

"The study" is *Feasibility study of surrogate model for the application of vehicle suspension system* (2021); its
equations 29-41 are written here as scalar formulas, and the matrices follow by evaluating them on unit vectors.

    model = full_car_matrices(...)              M q'' + C q' + K q = K_in z_r + C_in z_r'
    road = RoadCase(speed=20.0, ...)            what the wheels see
    variance_lyapunov_delay(model, road)        white road velocity, exact wheelbase delay: algebra
    variance_spectral(model, road)              any waviness, any coherence: integral of |H|^2 G
    metrics(model, variance_...(model, road))   RMS values and damper power

SI units; scalar parameters. Parameters may be `mpmath.mpf`: the matrices then hold exact numbers (dtype object) and
`variance_lyapunov_delay(..., digits=50)` stays in multiple precision from the parameters to the variances.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import mpmath
import numpy as np
import scipy.linalg
import scipy.special

CORNERS = ("fr", "fl", "rr", "rl")


# ---------------------------------------------------------------------------------------------------- models


class Output(NamedTuple):
    """y = q . q + v . q' + a . q'' + r . z_r + w . z_r', one row per term."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    r: np.ndarray
    w: np.ndarray


class Model(NamedTuple):
    """M q'' + C q' + K q = K_in z_r + C_in z_r' and the quantities a ride study reads from it.

    `wheels` names the inputs ("" for a single wheel), `cs` the damper at each of them; `wheelbase` and
    `track_width` are 0 where the model has only one axle or one track.
    """

    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    K_in: np.ndarray
    C_in: np.ndarray
    coordinates: tuple
    wheels: tuple
    cs: dict
    outputs: dict
    wheelbase: float = 0.0
    track_width: float = 0.0


def _per_wheel(value, wheels):
    """One value for all wheels, a mapping, or a sequence in the order of `wheels`, as a dict."""
    if isinstance(value, Mapping):
        return {wheel: value[wheel] for wheel in wheels}
    if isinstance(value, (tuple, list, np.ndarray)):
        return dict(zip(wheels, value, strict=True))
    return dict.fromkeys(wheels, value)


def _unit(names, chosen=None):
    return {name: 1 if name == chosen else 0 for name in names}


def _matrices(accelerations, coordinates, inputs, inertia):
    """M, C, K, K_in, C_in of q'' = accelerations(z, dz, zr, dzr), read off by unit vectors."""
    rest, flat = _unit(coordinates), _unit(inputs)

    def forces(**state):
        state = {"z": rest, "dz": rest, "zr": flat, "dzr": flat} | state
        result = accelerations(**state)
        return [inertia[name] * result[name] for name in coordinates]

    K = -np.array([forces(z=_unit(coordinates, name)) for name in coordinates]).T
    C = -np.array([forces(dz=_unit(coordinates, name)) for name in coordinates]).T
    K_in = np.array([forces(zr=_unit(inputs, name)) for name in inputs]).T
    C_in = np.array([forces(dzr=_unit(inputs, name)) for name in inputs]).T
    M = np.diag(np.array([inertia[name] for name in coordinates]))
    return M, C, K, K_in, C_in


def _outputs(coordinates, wheels, points, corners, angles, kt, ct):
    """Body accelerations, suspension deflections and their rates, dynamic tyre forces.

    points: name -> {coordinate: weight} of a body point; corners: wheel -> (wheel coordinate, point name);
    angles: output name -> coordinate.
    """
    none, flat = np.zeros(len(coordinates)), np.zeros(len(wheels))

    def row(weights):
        return np.array([weights.get(name, 0.0) for name in coordinates])

    def named(prefix, place):
        return f"{prefix}_{place}" if place else prefix

    outputs = {}
    for place, weights in points.items():
        outputs[named("bacc", place)] = Output(none, none, row(weights), flat, flat)
    for name, coordinate in angles.items():
        outputs[name] = Output(none, none, row({coordinate: 1.0}), flat, flat)
    for i, wheel in enumerate(wheels):
        hub, point = corners[wheel]
        deflection = row({hub: 1.0}) - row(points[point])
        here = np.eye(len(wheels))[i]
        outputs[named("sws", wheel)] = Output(deflection, none, none, flat, flat)
        outputs[named("sws_rate", wheel)] = Output(none, deflection, none, flat, flat)
        outputs[named("dtl", wheel)] = Output(
            -kt[wheel] * row({hub: 1.0}), -ct[wheel] * row({hub: 1.0}), none, kt[wheel] * here, ct[wheel] * here
        )
        outputs[named("tyre_deflection", wheel)] = Output(-row({hub: 1.0}), none, none, here, flat)
    return outputs


def rigid_tyre_matrices(ms, ks, cs):
    """Quarter car on a rigid tyre, coordinate (z_b): Eq 30 of the study with the wheel on the road, z_u = z_r.

    m_s z_b'' = k_s (z_r - z_b) + c_s (z_r' - z_b'). The dynamic tyre force is the suspension force.
    """

    def accelerations(z, dz, zr, dzr):
        return {"z_b": ks / ms * (zr["z_r"] - z["z_b"]) + cs / ms * (dzr["z_r"] - dz["z_b"])}

    matrices = _matrices(accelerations, ("z_b",), ("z_r",), {"z_b": ms})
    none, one = np.zeros(1), np.ones(1)
    outputs = {
        "bacc": Output(none, none, one, none, none),
        "sws": Output(-one, none, none, one, none),
        "sws_rate": Output(none, -one, none, none, one),
        "dtl": Output(-ks * one, -cs * one, none, ks * one, cs * one),
    }
    return Model(*matrices, ("z_b",), ("",), {"": cs}, outputs)


def quarter_matrices(ms, mu, ks, cs, kt, ct=0.0):
    """Quarter car, coordinates (z_u, z_b), input z_r: Eqs 29 and 30 of the study, with tyre damping c_t.

    m_u z_u'' = k_t (z_r - z_u) + c_t (z_r' - z_u') - k_s (z_u - z_b) - c_s (z_u' - z_b')
    m_s z_b'' = k_s (z_u - z_b) + c_s (z_u' - z_b')
    """

    def accelerations(z, dz, zr, dzr):
        return {
            "z_u": kt / mu * (zr["z_r"] - z["z_u"])
            + ct / mu * (dzr["z_r"] - dz["z_u"])
            - ks / mu * (z["z_u"] - z["z_b"])
            - cs / mu * (dz["z_u"] - dz["z_b"]),
            "z_b": ks / ms * (z["z_u"] - z["z_b"]) + cs / ms * (dz["z_u"] - dz["z_b"]),
        }

    coordinates = ("z_u", "z_b")
    matrices = _matrices(accelerations, coordinates, ("z_r",), {"z_u": mu, "z_b": ms})
    points, corners = {"": {"z_b": 1.0}}, {"": ("z_u", "")}
    outputs = _outputs(coordinates, ("",), points, corners, {}, {"": kt}, {"": ct})
    return Model(*matrices, coordinates, ("",), {"": cs}, outputs)


def pitch_half_matrices(mb, iyy, a, b, mu, ks, cs, kt, ct=0.0):
    """Half car in pitch, coordinates (z_u_f, z_u_r, z_b, theta): Eqs 31, 33, 35, 37, 38 and 40 of one side.

    The point above the front wheel is z_b - a theta, above the rear wheel z_b + b theta.
    mu, ks, cs, kt, ct: one value, or (front, rear).
    """
    ends = ("f", "r")
    mu, ks, cs, kt, ct = (_per_wheel(value, ends) for value in (mu, ks, cs, kt, ct))

    def accelerations(z, dz, zr, dzr):
        zs_f, zs_r = z["z_b"] - a * z["theta"], z["z_b"] + b * z["theta"]
        dzs_f, dzs_r = dz["z_b"] - a * dz["theta"], dz["z_b"] + b * dz["theta"]
        return {
            "z_u_f": kt["f"] / mu["f"] * (zr["f"] - z["z_u_f"])
            + ct["f"] / mu["f"] * (dzr["f"] - dz["z_u_f"])
            - ks["f"] / mu["f"] * (z["z_u_f"] - zs_f)
            - cs["f"] / mu["f"] * (dz["z_u_f"] - dzs_f),
            "z_u_r": kt["r"] / mu["r"] * (zr["r"] - z["z_u_r"])
            + ct["r"] / mu["r"] * (dzr["r"] - dz["z_u_r"])
            - ks["r"] / mu["r"] * (z["z_u_r"] - zs_r)
            - cs["r"] / mu["r"] * (dz["z_u_r"] - dzs_r),
            "z_b": ks["f"] / mb * (z["z_u_f"] - zs_f)
            + cs["f"] / mb * (dz["z_u_f"] - dzs_f)
            + ks["r"] / mb * (z["z_u_r"] - zs_r)
            + cs["r"] / mb * (dz["z_u_r"] - dzs_r),
            "theta": -a * ks["f"] / iyy * (z["z_u_f"] - zs_f)
            - a * cs["f"] / iyy * (dz["z_u_f"] - dzs_f)
            + b * ks["r"] / iyy * (z["z_u_r"] - zs_r)
            + b * cs["r"] / iyy * (dz["z_u_r"] - dzs_r),
        }

    coordinates = ("z_u_f", "z_u_r", "z_b", "theta")
    inertia = {"z_u_f": mu["f"], "z_u_r": mu["r"], "z_b": mb, "theta": iyy}
    matrices = _matrices(accelerations, coordinates, ends, inertia)
    points = {"cg": {"z_b": 1.0}, "f": {"z_b": 1.0, "theta": -a}, "r": {"z_b": 1.0, "theta": b}}
    corners = {"f": ("z_u_f", "f"), "r": ("z_u_r", "r")}
    outputs = _outputs(coordinates, ends, points, corners, {"pitch_acc": "theta"}, kt, ct)
    return Model(*matrices, coordinates, ends, cs, outputs, wheelbase=a + b)


def roll_half_matrices(mb, ixx, c, mu, ks, cs, kt, ct=0.0, arb=0.0):
    """Half car in roll, coordinates (z_u_r, z_u_l, z_b, phi): Eqs 31, 32, 35, 36, 38 and 39 of one axle.

    The point above the right wheel is z_b - c phi, above the left wheel z_b + c phi. The anti-roll bar pushes the
    body up at the right, and down at the left, with arb (d_r - d_l), d = z_u - z_s.
    mu, ks, cs, kt, ct: one value, or (right, left).
    """
    sides = ("r", "l")
    mu, ks, cs, kt, ct = (_per_wheel(value, sides) for value in (mu, ks, cs, kt, ct))

    def accelerations(z, dz, zr, dzr):
        zs_r, zs_l = z["z_b"] - c * z["phi"], z["z_b"] + c * z["phi"]
        dzs_r, dzs_l = dz["z_b"] - c * dz["phi"], dz["z_b"] + c * dz["phi"]
        bar = arb * ((z["z_u_r"] - zs_r) - (z["z_u_l"] - zs_l))
        return {
            "z_u_r": kt["r"] / mu["r"] * (zr["r"] - z["z_u_r"])
            + ct["r"] / mu["r"] * (dzr["r"] - dz["z_u_r"])
            - ks["r"] / mu["r"] * (z["z_u_r"] - zs_r)
            - cs["r"] / mu["r"] * (dz["z_u_r"] - dzs_r)
            - bar / mu["r"],
            "z_u_l": kt["l"] / mu["l"] * (zr["l"] - z["z_u_l"])
            + ct["l"] / mu["l"] * (dzr["l"] - dz["z_u_l"])
            - ks["l"] / mu["l"] * (z["z_u_l"] - zs_l)
            - cs["l"] / mu["l"] * (dz["z_u_l"] - dzs_l)
            + bar / mu["l"],
            "z_b": ks["r"] / mb * (z["z_u_r"] - zs_r)
            + cs["r"] / mb * (dz["z_u_r"] - dzs_r)
            + ks["l"] / mb * (z["z_u_l"] - zs_l)
            + cs["l"] / mb * (dz["z_u_l"] - dzs_l)
            + bar / mb
            - bar / mb,
            "phi": -c * ks["r"] / ixx * (z["z_u_r"] - zs_r)
            - c * cs["r"] / ixx * (dz["z_u_r"] - dzs_r)
            + c * ks["l"] / ixx * (z["z_u_l"] - zs_l)
            + c * cs["l"] / ixx * (dz["z_u_l"] - dzs_l)
            - c * bar / ixx
            - c * bar / ixx,
        }

    coordinates = ("z_u_r", "z_u_l", "z_b", "phi")
    inertia = {"z_u_r": mu["r"], "z_u_l": mu["l"], "z_b": mb, "phi": ixx}
    matrices = _matrices(accelerations, coordinates, sides, inertia)
    points = {"cg": {"z_b": 1.0}, "r": {"z_b": 1.0, "phi": -c}, "l": {"z_b": 1.0, "phi": c}}
    corners = {"r": ("z_u_r", "r"), "l": ("z_u_l", "l")}
    outputs = _outputs(coordinates, sides, points, corners, {"roll_acc": "phi"}, kt, ct)
    return Model(*matrices, coordinates, sides, cs, outputs, track_width=2 * c)


def full_car_matrices(
    mb, iyy, ixx, a, b, c, mu, ks, cs, kt, ct=0.0, arb_front=0.0, arb_rear=0.0
):  # fmt: skip
    """Full car, coordinates (z_u_fr, z_u_fl, z_u_rr, z_u_rl, z_b, theta, phi): Eqs 31-41 of the study.

    theta is pitch (I_yy, Eq 37), phi is roll (I_xx, Eq 36). Added to the study: tyre damping c_t, and anti-roll bars,
    which push the body up at the right and down at the left with arb (d_right - d_left), d = z_u - z_s.
    mu, ks, cs, kt, ct: one value, a mapping by corner, or a sequence (fr, fl, rr, rl).
    """
    mu, ks, cs, kt, ct = (_per_wheel(value, CORNERS) for value in (mu, ks, cs, kt, ct))

    def accelerations(z, dz, zr, dzr):
        # Eqs 38-41
        zs_fr = z["z_b"] - a * z["theta"] - c * z["phi"]
        zs_fl = z["z_b"] - a * z["theta"] + c * z["phi"]
        zs_rr = z["z_b"] + b * z["theta"] - c * z["phi"]
        zs_rl = z["z_b"] + b * z["theta"] + c * z["phi"]
        dzs_fr = dz["z_b"] - a * dz["theta"] - c * dz["phi"]
        dzs_fl = dz["z_b"] - a * dz["theta"] + c * dz["phi"]
        dzs_rr = dz["z_b"] + b * dz["theta"] - c * dz["phi"]
        dzs_rl = dz["z_b"] + b * dz["theta"] + c * dz["phi"]
        bar_front = arb_front * ((z["z_u_fr"] - zs_fr) - (z["z_u_fl"] - zs_fl))
        bar_rear = arb_rear * ((z["z_u_rr"] - zs_rr) - (z["z_u_rl"] - zs_rl))
        return {
            # Eq 31
            "z_u_fr": kt["fr"] / mu["fr"] * (zr["fr"] - z["z_u_fr"])
            + ct["fr"] / mu["fr"] * (dzr["fr"] - dz["z_u_fr"])
            - ks["fr"] / mu["fr"] * (z["z_u_fr"] - zs_fr)
            - cs["fr"] / mu["fr"] * (dz["z_u_fr"] - dzs_fr)
            - bar_front / mu["fr"],
            # Eq 32
            "z_u_fl": kt["fl"] / mu["fl"] * (zr["fl"] - z["z_u_fl"])
            + ct["fl"] / mu["fl"] * (dzr["fl"] - dz["z_u_fl"])
            - ks["fl"] / mu["fl"] * (z["z_u_fl"] - zs_fl)
            - cs["fl"] / mu["fl"] * (dz["z_u_fl"] - dzs_fl)
            + bar_front / mu["fl"],
            # Eq 33
            "z_u_rr": kt["rr"] / mu["rr"] * (zr["rr"] - z["z_u_rr"])
            + ct["rr"] / mu["rr"] * (dzr["rr"] - dz["z_u_rr"])
            - ks["rr"] / mu["rr"] * (z["z_u_rr"] - zs_rr)
            - cs["rr"] / mu["rr"] * (dz["z_u_rr"] - dzs_rr)
            - bar_rear / mu["rr"],
            # Eq 34
            "z_u_rl": kt["rl"] / mu["rl"] * (zr["rl"] - z["z_u_rl"])
            + ct["rl"] / mu["rl"] * (dzr["rl"] - dz["z_u_rl"])
            - ks["rl"] / mu["rl"] * (z["z_u_rl"] - zs_rl)
            - cs["rl"] / mu["rl"] * (dz["z_u_rl"] - dzs_rl)
            + bar_rear / mu["rl"],
            # Eq 35: the two forces of a bar cancel
            "z_b": ks["fr"] / mb * (z["z_u_fr"] - zs_fr)
            + cs["fr"] / mb * (dz["z_u_fr"] - dzs_fr)
            + ks["fl"] / mb * (z["z_u_fl"] - zs_fl)
            + cs["fl"] / mb * (dz["z_u_fl"] - dzs_fl)
            + ks["rr"] / mb * (z["z_u_rr"] - zs_rr)
            + cs["rr"] / mb * (dz["z_u_rr"] - dzs_rr)
            + ks["rl"] / mb * (z["z_u_rl"] - zs_rl)
            + cs["rl"] / mb * (dz["z_u_rl"] - dzs_rl),
            # Eq 36: lever arm c at both ends of a bar
            "phi": -c * ks["fr"] / ixx * (z["z_u_fr"] - zs_fr)
            - c * cs["fr"] / ixx * (dz["z_u_fr"] - dzs_fr)
            + c * ks["fl"] / ixx * (z["z_u_fl"] - zs_fl)
            + c * cs["fl"] / ixx * (dz["z_u_fl"] - dzs_fl)
            - c * ks["rr"] / ixx * (z["z_u_rr"] - zs_rr)
            - c * cs["rr"] / ixx * (dz["z_u_rr"] - dzs_rr)
            + c * ks["rl"] / ixx * (z["z_u_rl"] - zs_rl)
            + c * cs["rl"] / ixx * (dz["z_u_rl"] - dzs_rl)
            - 2 * c * bar_front / ixx
            - 2 * c * bar_rear / ixx,
            # Eq 37: the two forces of a bar cancel
            "theta": -a * ks["fr"] / iyy * (z["z_u_fr"] - zs_fr)
            - a * cs["fr"] / iyy * (dz["z_u_fr"] - dzs_fr)
            - a * ks["fl"] / iyy * (z["z_u_fl"] - zs_fl)
            - a * cs["fl"] / iyy * (dz["z_u_fl"] - dzs_fl)
            + b * ks["rr"] / iyy * (z["z_u_rr"] - zs_rr)
            + b * cs["rr"] / iyy * (dz["z_u_rr"] - dzs_rr)
            + b * ks["rl"] / iyy * (z["z_u_rl"] - zs_rl)
            + b * cs["rl"] / iyy * (dz["z_u_rl"] - dzs_rl),
        }

    coordinates = ("z_u_fr", "z_u_fl", "z_u_rr", "z_u_rl", "z_b", "theta", "phi")
    inertia = {f"z_u_{corner}": mu[corner] for corner in CORNERS} | {"z_b": mb, "theta": iyy, "phi": ixx}
    matrices = _matrices(accelerations, coordinates, CORNERS, inertia)
    points = {
        "cg": {"z_b": 1.0},
        "fr": {"z_b": 1.0, "theta": -a, "phi": -c},
        "fl": {"z_b": 1.0, "theta": -a, "phi": c},
        "rr": {"z_b": 1.0, "theta": b, "phi": -c},
        "rl": {"z_b": 1.0, "theta": b, "phi": c},
    }
    corners = {corner: (f"z_u_{corner}", corner) for corner in CORNERS}
    angles = {"pitch_acc": "theta", "roll_acc": "phi"}
    outputs = _outputs(coordinates, CORNERS, points, corners, angles, kt, ct)
    return Model(*matrices, coordinates, CORNERS, cs, outputs, wheelbase=a + b, track_width=2 * c)


# ---------------------------------------------------------------------------------------------------- ride and handling

CONTROLS = ("delta_f", "delta_r", "drive_fr", "drive_fl", "drive_rr", "drive_rl")


def ride_handling_balance(car, z, v, a, lag, zr, dzr, u):
    """What each equation of motion of a car at speed U leaves over: zero where it holds.

    Lagrange's equations about straight running, written out one by one. `car` has the parameters by name, those of
    wheels as mappings; z, v, a are positions, speeds and accelerations by coordinate: the seven of the full car, y,
    psi, x and the spins, and steer_fr, steer_fl with compliant steering. y' is the lateral speed in axes that turn with
    the car, so that its acceleration is y'' + U psi'. Also returned are all outputs.
    """
    U, h_f, h_r, R, g = car["speed"], car["roll_centre_front"], car["roll_centre_rear"], car["radius"], 9.81
    aa, b, c, mb, mu = car["a"], car["b"], car["c"], car["mb"], car["mu"]
    ks, cs, kt, ct = car["ks"], car["cs"], car["kt"], car["ct"]
    steered = car["steering"] is not None
    h = car["height"] - (b * h_f + aa * h_r) / (aa + b)
    fr, fl, rr, rl = CORNERS

    # Heights of the body over the wheels, axle roll, and what follows from them.
    body = {
        fr: lambda s: s["z_b"] - aa * s["theta"] - c * s["phi"],
        fl: lambda s: s["z_b"] - aa * s["theta"] + c * s["phi"],
        rr: lambda s: s["z_b"] + b * s["theta"] - c * s["phi"],
        rl: lambda s: s["z_b"] + b * s["theta"] + c * s["phi"],
    }
    travel = {w: z[f"z_u_{w}"] - body[w](z) for w in CORNERS}
    rate = {w: v[f"z_u_{w}"] - body[w](v) for w in CORNERS}
    strut = {w: ks[w] * travel[w] + cs[w] * rate[w] for w in CORNERS}
    for right, left, arb in ((fr, fl, car["arb_front"]), (rr, rl, car["arb_rear"])):
        bar = arb * (travel[right] - travel[left])
        strut[right], strut[left] = strut[right] + bar, strut[left] - bar
    tyre = {w: kt[w] * (zr[w] - z[f"z_u_{w}"]) + ct[w] * (dzr[w] - v[f"z_u_{w}"]) for w in CORNERS}
    roll_rate_f = (v["z_u_fl"] - v["z_u_fr"]) / (2 * c)
    roll_rate_r = (v["z_u_rl"] - v["z_u_rr"]) / (2 * c)
    roll_acc_f = (a["z_u_fl"] - a["z_u_fr"]) / (2 * c)
    roll_acc_r = (a["z_u_rl"] - a["z_u_rr"]) / (2 * c)

    # Slip angles and tyre forces.
    aside = {
        fr: v["y"] + aa * v["psi"] + h_f * roll_rate_f,
        fl: v["y"] + aa * v["psi"] + h_f * roll_rate_f,
        rr: v["y"] - b * v["psi"] + h_r * roll_rate_r,
        rl: v["y"] - b * v["psi"] + h_r * roll_rate_r,
    }
    angle = {fr: u["delta_f"], fl: u["delta_f"], rr: u["delta_r"], rl: u["delta_r"]}
    if steered:
        for w in (fr, fl):
            angle[w] = z[f"steer_{w}"]
            aside[w] = aside[w] - car["trail"] * v[f"steer_{w}"]
    alpha = {w: angle[w] - aside[w] / U for w in CORNERS}
    late = {w: lag[w] if car["relaxation"][w] else alpha[w] for w in CORNERS}
    Fy = {w: car["cornering"][w] * late[w] for w in CORNERS}
    ahead = {fr: v["x"] + c * v["psi"], rr: v["x"] + c * v["psi"]}
    ahead |= {fl: v["x"] - c * v["psi"], rl: v["x"] - c * v["psi"]}
    Fx = {w: -car["slip"][w] * (ahead[w] - R * v[f"spin_{w}"]) / U for w in CORNERS}

    # Lateral accelerations of the body and of the hubs.
    ay_body = a["y"] + U * v["psi"] - h * a["phi"]
    ay_f = a["y"] + U * v["psi"] + aa * a["psi"] + (h_f - R) * roll_acc_f
    ay_r = a["y"] + U * v["psi"] - b * a["psi"] + (h_r - R) * roll_acc_r
    mu_f, mu_r = mu[fr] + mu[fl], mu[rr] + mu[rl]
    own_izz = car["izz"] - mu_f * (aa**2 + c**2) - mu_r * (b**2 + c**2)
    total = mb + mu_f + mu_r
    centre = (mb * car["height"] + (mu_f + mu_r) * R) / total
    # An axle's roll moment goes half up at the left and half down at the right.
    axle_f = h_f * (Fy[fr] + Fy[fl]) - mu_f * (h_f - R) * ay_f
    axle_r = h_r * (Fy[rr] + Fy[rl]) - mu_r * (h_r - R) * ay_r

    left_over = {
        "z_u_fr": mu[fr] * a["z_u_fr"] - tyre[fr] + strut[fr] + axle_f / (2 * c),
        "z_u_fl": mu[fl] * a["z_u_fl"] - tyre[fl] + strut[fl] - axle_f / (2 * c),
        "z_u_rr": mu[rr] * a["z_u_rr"] - tyre[rr] + strut[rr] + axle_r / (2 * c),
        "z_u_rl": mu[rl] * a["z_u_rl"] - tyre[rl] + strut[rl] - axle_r / (2 * c),
        "z_b": mb * a["z_b"] - strut[fr] - strut[fl] - strut[rr] - strut[rl],
        "theta": car["iyy"] * a["theta"]
        + aa * (strut[fr] + strut[fl])
        - b * (strut[rr] + strut[rl])
        + centre / R * (u["drive_fr"] + u["drive_fl"] + u["drive_rr"] + u["drive_rl"]),
        "phi": car["ixx"] * a["phi"]
        - car["ixz"] * a["psi"]
        - mb * h * ay_body
        - mb * g * h * z["phi"]
        - c * (strut[fl] - strut[fr] + strut[rl] - strut[rr]),
        "y": mb * ay_body + mu_f * ay_f + mu_r * ay_r - Fy[fr] - Fy[fl] - Fy[rr] - Fy[rl],
        "x": total * a["x"] + c * (mu[fr] - mu[fl] + mu[rr] - mu[rl]) * a["psi"] - Fx[fr] - Fx[fl] - Fx[rr] - Fx[rl],
        "psi": own_izz * a["psi"]
        - car["ixz"] * a["phi"]
        + mu_f * aa * ay_f
        - mu_r * b * ay_r
        + c * (mu[fr] + mu[rr]) * (a["x"] + c * a["psi"])
        - c * (mu[fl] + mu[rl]) * (a["x"] - c * a["psi"])
        - aa * (Fy[fr] + Fy[fl])
        + b * (Fy[rr] + Fy[rl])
        - c * (Fx[fr] + Fx[rr])
        + c * (Fx[fl] + Fx[rl]),
    }
    for w in CORNERS:
        left_over[f"spin_{w}"] = car["wheel_inertia"][w] * a[f"spin_{w}"] - u[f"drive_{w}"] + R * Fx[w]
    if steered:
        inertia, k, d = car["steering_inertia"], car["steering"], car["steering_damping"]
        # The wheels' own inertia about their steering axes is part of the car's.
        left_over["psi"] = left_over["psi"] + inertia * (a["steer_fr"] + a["steer_fl"])
        for w in (fr, fl):
            left_over[f"steer_{w}"] = (
                inertia * (a[f"steer_{w}"] + a["psi"])
                + d * v[f"steer_{w}"]
                + k * (z[f"steer_{w}"] - u["delta_f"])
                + car["trail"] * Fy[w]
            )
    outputs = {
        "bacc_cg": a["z_b"],
        "pitch_acc": a["theta"],
        "roll_acc": a["phi"],
        **{f"bacc_{w}": body[w](a) for w in CORNERS},
        **{f"sws_{w}": travel[w] for w in CORNERS},
        **{f"dtl_{w}": tyre[w] for w in CORNERS},
        "ay": ay_body,
        "yaw_rate": v["psi"],
        "sideslip": v["y"] / U,
        "roll": z["phi"],
        "load_transfer_front": (tyre[fr] - tyre[fl]) / 2,
        "load_transfer_rear": (tyre[rr] - tyre[rl]) / 2,
        "load_transfer_ratio": (tyre[fr] - tyre[fl] + tyre[rr] - tyre[rl]) / (total * g),
        **{f"slip_angle_{w}": alpha[w] for w in CORNERS},
    }
    for w in CORNERS:
        if car["relaxation"][w]:
            # sigma / U alpha_late' + alpha_late = alpha
            left_over[f"lag_{w}"] = car["relaxation"][w] / U * a[f"lag_{w}"] + lag[w] - alpha[w]
    return left_over, outputs


def ride_handling_response(car, f):
    """Outputs per road height z_r and per control at the frequencies f, as (outputs, inputs, F), and their names."""
    ride = ("z_u_fr", "z_u_fl", "z_u_rr", "z_u_rl", "z_b", "theta", "phi")
    steer = ("steer_fr", "steer_fl") if car["steering"] is not None else ()
    moving = ("y", "psi", "x", *(f"spin_{w}" for w in CORNERS))
    lags = tuple(w for w in CORNERS if car["relaxation"][w])
    responses = []
    for s in 2j * np.pi * np.asarray(f):

        def balance(z=None, v=None, a=None, lag=None, zr=None, dzr=None, u=None):
            nothing = _unit((*ride, *steer, *moving, *(f"lag_{w}" for w in CORNERS), *CORNERS, *CONTROLS))
            parts = (nothing | (part or {}) for part in (z, v, a, lag, zr, dzr, u))
            left_over, outputs = ride_handling_balance(car, *parts)
            return np.array(list(left_over.values())), np.array(list(outputs.values())), list(outputs)

        columns = [balance({q: 1}, {q: s}, {q: s**2}) for q in (*ride, *steer)]
        columns += [balance(None, {q: 1}, {q: s}) for q in moving]
        columns += [balance(lag={w: 1}, a={f"lag_{w}": s}) for w in lags]
        driven = [balance(zr={w: 1}, dzr={w: s}) for w in CORNERS] + [balance(u={name: 1}) for name in CONTROLS]
        (D, Y), (B, direct) = (
            (np.array([column[0] for column in some]).T, np.array([column[1] for column in some]).T)
            for some in (columns, driven)
        )
        responses.append(direct - Y @ np.linalg.solve(D, B))
    return np.moveaxis(np.array(responses), 0, -1), driven[0][2], [f"z_r_{w}" for w in CORNERS] + list(CONTROLS)


def understeer_gradient(m_front, m_rear, C_front, C_rear):
    """K of delta = L / rho + K a_y, by what each axle carries and the cornering stiffness of both its wheels."""
    return m_front / C_front - m_rear / C_rear


def bicycle_gains(L, b, m_rear, C_rear, K, U):
    """Yaw rate, lateral acceleration and sideslip per front steering angle of a car that turns steadily."""
    r = U / (L + K * U**2)
    return r, U * r, (b - m_rear * U**2 / C_rear) / (L + K * U**2)


def truck_matrices(mb, ixx, iyy, ahead, c, wheels, mu, ks, cs, kt, ct, bars):
    """A rigid body on any number of axles, coordinates (one height a wheel, z_b, theta, phi).

    ``wheels`` name (axle, side); ``ahead`` is how far each axle lies ahead of the centre of gravity, ``mu`` to ``ct``
    sequences in the order of the wheels, ``bars`` the stiffness of each axle's anti-roll bar.
    """
    names = tuple(wheels)
    mu, ks, cs, kt, ct = (_per_wheel(value, names) for value in (mu, ks, cs, kt, ct))

    def over(q, name):
        axle, side = wheels[name]
        return q["z_b"] - ahead[axle] * q["theta"] + side * c * q["phi"]

    def accelerations(z, dz, zr, dzr):
        deflection = {name: z[f"z_u_{name}"] - over(z, name) for name in names}
        force = {}
        for name, (axle, side) in wheels.items():
            (other,) = (one for one, place in wheels.items() if place[0] == axle and place[1] == -side)
            force[name] = ks[name] * deflection[name] + cs[name] * (dz[f"z_u_{name}"] - over(dz, name))
            force[name] += bars[axle] * (deflection[name] - deflection[other])
        hops = {
            f"z_u_{name}": (
                kt[name] * (zr[name] - z[f"z_u_{name}"]) + ct[name] * (dzr[name] - dz[f"z_u_{name}"]) - force[name]
            )
            / mu[name]
            for name in names
        }
        return hops | {
            "z_b": sum(force.values()) / mb,
            "theta": sum(-ahead[wheels[name][0]] * f for name, f in force.items()) / iyy,
            "phi": sum(wheels[name][1] * c * f for name, f in force.items()) / ixx,
        }

    coordinates = (*(f"z_u_{name}" for name in names), "z_b", "theta", "phi")
    inertia = {f"z_u_{name}": mu[name] for name in names} | {"z_b": mb, "theta": iyy, "phi": ixx}
    points = {name: {"z_b": 1.0, "theta": -ahead[axle], "phi": side * c} for name, (axle, side) in wheels.items()}
    outputs = _outputs(
        coordinates,
        names,
        {"cg": {"z_b": 1.0}} | points,
        {name: (f"z_u_{name}", name) for name in names},
        {"pitch_acc": "theta", "roll_acc": "phi"},
        kt,
        ct,
    )
    return Model(*_matrices(accelerations, coordinates, names, inertia), coordinates, names, cs, outputs)


def variance_impulses(model, lags, tracks, q):
    """Variances on white road velocity of intensity q, met by wheel after wheel: no spectrum, no cross-correlation.

    ``E[y^2] = q int h(t)^2 dt`` with h the answer to a step of one road's height, which reaches each wheel of its
    track after its own of the ``lags``: between two of these, a free decay towards where the vehicle would stand, whose
    integral is a difference of two Lyapunov solutions. ``tracks`` are the wheels of each independent road. No damping
    of tyres.
    """
    n = len(model.coordinates)
    A = np.block(
        [[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(model.M, model.K), -np.linalg.solve(model.M, model.C)]]
    )
    forced = np.linalg.solve(model.M, model.K_in)
    rows, feeds = [], []
    for output in model.outputs.values():
        row = np.concatenate([output.q, output.v]) + output.a @ A[n:]
        rows.append(row)
        feeds.append(output.r + output.a @ forced)
    C, D = np.array(rows, dtype=float), np.array(feeds, dtype=float)
    total = np.zeros(len(C))
    for wheels in tracks:
        heights, x = np.zeros(len(model.wheels)), np.zeros(2 * n)
        times = sorted({lags[wheel] for wheel in wheels})
        for now, later in zip(times, [*times[1:], None], strict=True):
            for i, wheel in enumerate(model.wheels):
                if wheel in wheels and lags[wheel] == now:
                    heights[i] = 1.0
            still = np.concatenate([np.linalg.solve(model.K, model.K_in @ heights), np.zeros(n)])
            start, constant = x - still, C @ still + D @ heights
            end = np.zeros(2 * n) if later is None else scipy.linalg.expm(A * (later - now)) @ start
            X = scipy.linalg.solve_continuous_lyapunov(A, np.outer(end, end) - np.outer(start, start))
            total += np.einsum("oi,ij,oj->o", C, X, C)
            if later is None:
                np.testing.assert_allclose(constant, 0.0, atol=1e-9 * np.abs(C).max())
            else:
                total += 2.0 * constant * (C @ np.linalg.solve(A, end - start)) + constant**2 * (later - now)
            x = still + end
    return dict(zip(model.outputs, q * total, strict=True))


def with_seat(model, name, floor, mass, ks, cs):
    """A model with one more coordinate, ``mass z'' = ks (z_f - z) + cs (z_f' - z')``, and its reaction on the floor.

    ``z_f = floor . q`` is the height of the floor. Outputs: the accelerations of both, and ``z_f - z``.
    """
    n, wheels = len(model.coordinates), len(model.wheels)
    floor = np.array([floor.get(coordinate, 0.0) for coordinate in model.coordinates])
    M, C, K = (np.zeros((n + 1, n + 1), dtype=np.asarray(matrix).dtype) for matrix in model[:3])
    for grown, matrix in zip((M, C, K), model[:3], strict=True):
        grown[:n, :n] = matrix
    M[n, n] = mass
    for matrix, rate in ((C, cs), (K, ks)):
        for i in range(n):
            for j in range(n):
                matrix[i, j] += rate * floor[i] * floor[j]
            matrix[i, n] = matrix[n, i] = -rate * floor[i]
        matrix[n, n] = rate
    still, ground = np.zeros(n + 1), np.zeros(wheels)
    rider, under = np.append(np.zeros(n), 1.0), np.append(floor, 0.0)
    outputs = {
        output: Output(*(np.append(row, 0.0) for row in (own.q, own.v, own.a)), own.r, own.w)
        for output, own in model.outputs.items()
    }
    outputs[f"bacc_{name}"] = Output(still, still, rider, ground, ground)
    outputs[f"bacc_{name}_floor"] = Output(still, still, under, ground, ground)
    outputs[f"seat_travel_{name}"] = Output(rider - under, still, still, ground, ground)
    K_in, C_in = (np.vstack([matrix, np.zeros((1, wheels), dtype=matrix.dtype)]) for matrix in model[3:5])
    return model._replace(
        M=M, C=C, K=K, K_in=K_in, C_in=C_in, coordinates=(*model.coordinates, f"z_{name}"), outputs=outputs
    )


# ---------------------------------------------------------------------------------------------------- roads


class RoadCase(NamedTuple):
    """What the wheels see: G_d(n) = roughness (n/n0)^-waviness n^2/(n^2 + cutoff^2), one-sided, n0 = 0.1 cycle/m.

    tracks: "identical", "independent", "isotropic", or "four" (each wheel its own road); `coherence`, a function
    of the wavenumber, replaces the isotropic one. With `delay` the rear wheels see the front's road
    (a + b)/speed later, else at the same instant. Wheels not named in `wheels` stand on flat ground.
    """

    roughness: float = 64e-6
    speed: float = 20.0
    waviness: float = 2.0
    cutoff: float = 0.0
    tracks: str = "identical"
    delay: bool = True
    wheels: tuple | None = None
    coherence: Callable | None = None


def road_intensity(roughness, speed):
    """Intensity q of the white road velocity of waviness 2, E[w(t) w(t')] = q delta(t - t').

    G_d(n) = roughness (n0/n)^2 gives the one-sided velocity density (2 pi f)^2 G_d(f/V)/V = 4 pi^2 n0^2 roughness V
    per Hz, twice the two-sided density q.
    """
    return 2 * np.pi**2 * 0.1**2 * roughness * speed


def coherence_isotropic(n, track_width, waviness=2.0):
    """Coherence gamma of two parallel tracks on an isotropic surface with G_d(n) ~ n^-w, at wavenumber n (cycle/m).

    gamma = 2/Gamma(w/2) (x/2)^(w/2) K_(w/2)(x), x = 2 pi n B; for w = 2 it is x K_1(x). A surface whose straight
    tracks have G ~ n^-w has the plane spectrum ~ (n_x^2 + n_y^2)^(-(w+1)/2); its transform in n_y over that at B = 0
    is gamma.
    """
    return 1.0 - _incoherence_isotropic(np.asarray(n, dtype=float), track_width, waviness)


def _incoherence_isotropic(n, track_width, waviness):
    """1 - gamma; by the power series of K_nu where the difference would cancel."""
    nu, x = waviness / 2, 2 * np.pi * np.abs(n) * track_width
    with np.errstate(invalid="ignore", over="ignore"):
        gamma = 2 / scipy.special.gamma(nu) * (x / 2) ** nu * scipy.special.kv(nu, x)
    direct = 1.0 - np.where(x > 0, gamma, 1.0)
    h = np.where((x > 0) & (x < 0.1), x / 2, 0.01)
    if nu == 1.0:  # x K_1(x) = 1 + sum_k 2 h^(2k+2)/(k! (k+1)!) (ln h - (psi(k+1) + psi(k+2))/2)
        series = sum(
            -2
            * h ** (2 * k + 2)
            / (scipy.special.factorial(k) * scipy.special.factorial(k + 1))
            * (np.log(h) - (scipy.special.psi(k + 1) + scipy.special.psi(k + 2)) / 2)
            for k in range(6)
        )
    elif nu % 1.0 == 0.0:
        return direct
    else:  # K_nu = pi/2 (I_-nu - I_nu)/sin(nu pi), term by term
        series = -scipy.special.gamma(1 - nu) * sum(
            h ** (2 * k + 2) / (scipy.special.factorial(k + 1) * scipy.special.gamma(k + 2 - nu))
            - h ** (2 * k + 2 * nu) / (scipy.special.factorial(k) * scipy.special.gamma(k + 1 + nu))
            for k in range(6)
        )
    return np.where((x > 0) & (x < 0.1), series, direct)


def _is_rear(model, wheel):
    return model.wheelbase > 0 and wheel.startswith("r")


def _is_left(model, wheel):
    return model.track_width > 0 and wheel.endswith("l")


def _delay(model, road):
    return model.wheelbase / road.speed if road.delay else 0.0


def _sources(model, road):
    """F, R with z_r(t) = F s(t) + R s(t - tau) for uncorrelated sources s of the road's spectrum each.

    identical: one source; independent: right and left track; four: one for each wheel; isotropic: mean and half
    difference, to be weighted by sqrt((1 + gamma)/2) and sqrt((1 - gamma)/2) on their way in.
    """
    tracks = road.tracks if model.track_width > 0 or road.tracks == "four" else "identical"
    rows = {
        "identical": lambda i, wheel: [1.0],
        "independent": lambda i, wheel: [0.0, 1.0] if _is_left(model, wheel) else [1.0, 0.0],
        "isotropic": lambda i, wheel: [1.0, 1.0 if _is_left(model, wheel) else -1.0],
        "four": lambda i, wheel: np.eye(len(model.wheels))[i],
    }
    Z = np.array([rows[tracks](i, wheel) for i, wheel in enumerate(model.wheels)])
    if road.wheels is not None:
        Z = Z * np.array([[float(wheel in road.wheels)] for wheel in model.wheels])
    late = np.array([[float(_is_rear(model, wheel) and tracks != "four")] for wheel in model.wheels])
    return Z * (1 - late), Z * late


def _source_weights(model, road, n):
    """Amplitude of each source at wavenumbers n, shape (n, sources), such that sum |.|^2 per wheel is 1."""
    sources = _sources(model, road)[0].shape[1]
    if road.tracks != "isotropic" or model.track_width == 0:
        return np.ones((len(n), sources))
    if road.coherence is None:
        apart = _incoherence_isotropic(n, model.track_width, road.waviness)
    else:
        apart = 1.0 - road.coherence(n)
    return np.sqrt(np.column_stack([2.0 - apart, apart]) / 2)


def _warp(model):
    return np.array([1.0, -1.0, -1.0, 1.0]) if len(model.wheels) == 4 else np.zeros(len(model.wheels))


def _bounded_warp(model, road):
    """Weights of [s(t) - s(t - tau)] in the warp z_fr - z_fl - z_rr + z_rl of the road; refuse one that drifts."""
    F, R = _sources(model, road)
    front, rear = _warp(model) @ F, _warp(model) @ R
    drift = np.abs(front + rear)
    if road.tracks == "isotropic":  # the half difference of coherent tracks has a finite variance
        drift = drift[:1]
    if road.cutoff == 0 and drift.max() > 1e-9:
        raise ValueError("the warp of the road drifts: no finite variance without a cut-off")
    return front


# ---------------------------------------------------------------------------------------------------- linear system


def _float(model):
    """The model with plain floating-point matrices."""
    arrays = [np.asarray(matrix, dtype=float) for matrix in model[:5]]
    outputs = {
        name: Output(*(np.asarray(row, dtype=float) for row in output)) for name, output in model.outputs.items()
    }
    numbers = {"wheelbase": float(model.wheelbase), "track_width": float(model.track_width)}
    return Model(*arrays, *model[5:7], {k: float(v) for k, v in model.cs.items()}, outputs, **numbers)


def _exact(model):
    """The model with multiple-precision matrices."""
    exact = np.vectorize(mpmath.mpf, otypes=[object])
    return model._replace(**{name: exact(getattr(model, name)) for name in ("M", "C", "K", "K_in", "C_in")})


def natural_frequencies(model):
    """Undamped natural frequencies in Hz, ascending: K u = omega^2 M u."""
    model = _float(model)
    return np.sqrt(scipy.linalg.eigh(model.K, model.M, eigvals_only=True)) / (2 * np.pi)


class FirstOrder(NamedTuple):
    A: np.ndarray
    B: np.ndarray
    C: dict
    D: dict


def first_order(model):
    """x' = A x + B z_r, y = C x + D z_r with x = (q, q' - M^-1 C_in z_r); without tyre damping x = (q, q').

    C, D: output name -> row. An output that needs z_r' (improper) is left out.
    """
    model = _float(model)
    n, inverse = len(model.M), np.linalg.inv(model.M)
    K, C, K_in, C_in = (inverse @ matrix for matrix in model[2:0:-1] + model[3:5])
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]])
    B = np.vstack([C_in, K_in - C @ C_in])
    rows, feedthrough = {}, {}
    for name, y in model.outputs.items():
        if np.any(y.a @ C_in + y.w):
            continue
        rows[name] = np.concatenate([y.q - y.a @ K, y.v - y.a @ C])
        feedthrough[name] = y.v @ C_in + y.a @ (K_in - C @ C_in) + y.r
    return FirstOrder(A, B, rows, feedthrough)


def frequency_response(model, f):
    """y/z_r at f (Hz) by the dynamic stiffness: (s^2 M + s C + K) q = (K_in + s C_in) z_r, s = 2 pi i f.

    Output name -> array of shape (wheels, frequencies).
    """
    model = _float(model)
    s = 2j * np.pi * np.atleast_1d(np.asarray(f, dtype=float))[:, None, None]
    q = np.linalg.solve(s**2 * model.M + s * model.C + model.K, model.K_in + s * model.C_in)
    s = s[:, :, 0]
    return {
        name: (
            np.einsum("i,fij->fj", y.q, q)
            + s * np.einsum("i,fij->fj", y.v, q)
            + s**2 * np.einsum("i,fij->fj", y.a, q)
            + y.r
            + s * y.w
        ).T
        for name, y in model.outputs.items()
    }


def _velocity_response(model, omega):
    """y/z_r' without cancellation at either end, shape (frequencies, outputs, wheels), and the warp's share beta.

    With p = q - G z_r, G = K^-1 K_in: (s^2 M + s C + K) p = (C_in - C G - s M G) z_r', and
    (s^2 M + s C + K) q' = (K_in + s C_in) z_r'. The rest of an output, (y_q G + y_r) z_r, is beta times the warp
    and is returned apart.
    """
    s = 1j * omega[:, None, None]
    G = np.linalg.solve(model.K, model.K_in)
    stiffness = s**2 * model.M + s * model.C + model.K
    p = np.linalg.solve(stiffness, model.C_in - model.C @ G - s * (model.M @ G))
    v = np.linalg.solve(stiffness, model.K_in + s * model.C_in)
    Y = {part: np.array([getattr(y, part) for y in model.outputs.values()]) for part in Output._fields}
    return Y["q"] @ p + (Y["v"] + s * Y["a"]) @ v + Y["w"], _warp_share(model, G)


def _warp_share(model, G):
    """beta with y_q G + y_r = beta * (warp signs): the static response of each output to the road's warp."""
    rest = np.array([y.q @ G + y.r for y in model.outputs.values()])
    signs = _warp(model)
    beta = rest @ signs / max(1, len(model.wheels))
    scale = np.array([np.abs(y.q) @ np.abs(G).sum(axis=1) + np.abs(y.r).sum() for y in model.outputs.values()])
    if np.any(np.abs(rest - np.outer(beta, signs)).max(axis=1) > 1e-9 * scale):
        raise ValueError("an output follows the road itself and has no finite variance")
    return np.where(np.abs(beta) > 1e-13 * scale, beta, beta * 0)


def _has_feedthrough(model, y, road):
    inverse = np.diag(1 / np.diag(model.M))
    return bool(np.any((y.a @ inverse @ model.C_in + y.w) @ np.hstack(_sources(model, road))))


# ---------------------------------------------------------------------------------------------------- variances


def psd(model, road, f):
    """One-sided densities per Hz at f (Hz): h S h^H with the wheels' cross-spectra S. Output name -> array."""
    model, f = _float(model), np.atleast_1d(np.asarray(f, dtype=float))
    F, R = _sources(model, road)
    n = f / road.speed
    G = road.roughness * (n / 0.1) ** -road.waviness * n**2 / (n**2 + road.cutoff**2) / road.speed
    Z = F + np.exp(-2j * np.pi * f * _delay(model, road))[:, None, None] * R
    Z = Z * _source_weights(model, road, n)[:, None, :]
    response = frequency_response(model, f)
    return {name: G * (np.abs(np.einsum("wf,fws->fs", h, Z)) ** 2).sum(axis=1) for name, h in response.items()}


def _panels(model, tau):
    """Edges of integration panels in rad/s: every decade, every resonance on its own scale, every turn of the phase."""
    n = len(model.M)
    inverse = np.linalg.inv(model.M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ model.K, -inverse @ model.C]])
    poles = np.linalg.eigvals(A)
    edges = [np.logspace(-12, 9, 211)]
    for pole in poles[poles.imag >= 0]:
        reach = abs(pole.real) * 2.0 ** np.arange(-1, 40)
        reach = reach[reach < 2 * abs(pole)]
        edges += [abs(pole.imag) + reach, [abs(pole.imag)], abs(pole.imag) - reach]
    edges = np.unique(np.concatenate(edges))
    turn = 100 * np.abs(poles).max()
    if tau > 0:
        edges = np.unique(np.concatenate([edges, [turn], np.arange(0, turn, 4 * np.pi / tau)]))
    return edges[(edges >= 1e-12) & (edges <= 1e9)], turn if tau > 0 else np.inf


def variance_spectral(model, road):
    """Variances by integrating |H|^2 G over frequency, composite Gauss-Legendre; output name -> E[y^2].

    In terms of the road velocity, whose one-sided density per rad/s is (q/pi) (n/n0)^(2 - w) n^2/(n^2 + n_c^2).
    With the delay, y = (H_F + H_R e^(-i omega tau)) s; the product of the two is integrated through its turns up
    to a hundred times the fastest pole and by parts beyond. Behind the last panel the slowest outputs decay as
    omega^-w, which is added. Infinite for outputs with feedthrough of the road velocity (w <= 3).
    """
    model, tau = _float(model), _delay(_float(model), road)
    edges, turn = _panels(model, tau)
    x, weight = np.polynomial.legendre.leggauss(20)
    half, middle = np.diff(edges) / 2, (edges[1:] + edges[:-1]) / 2
    omega, d_omega = (middle[:, None] + half[:, None] * x).ravel(), (half[:, None] * weight).ravel()

    F, R = _sources(model, road)
    warp = _bounded_warp(model, road)
    drift = _warp(model) @ (F + R)

    def responses(omega):
        n = omega / (2 * np.pi * road.speed)
        density = road_intensity(road.roughness, road.speed) / np.pi * (n / 0.1) ** (2 - road.waviness)
        amplitude = np.sqrt(density * n**2 / (n**2 + road.cutoff**2))[:, None] * _source_weights(model, road, n)
        H, beta = _velocity_response(model, omega)
        front, rear = H @ F * amplitude[:, None, :], H @ R * amplitude[:, None, :]
        static = beta[:, None] * (amplitude / (1j * omega[:, None]))[:, None, :]
        return front, rear, static * warp, static * (drift - warp)

    front, rear, static_front, static_rear = responses(omega)
    phase = np.exp(-1j * omega * tau)[:, None, None]
    together = front + rear * phase + static_front + static_rear * phase
    power = (np.abs(together) ** 2).sum(axis=2)
    if np.isfinite(turn):
        apart = np.abs(front + static_front) ** 2 + np.abs(rear + static_rear) ** 2
        power = np.where(omega[:, None] < turn, power, apart.sum(axis=2))
    variance = d_omega @ power + power[-1] * omega[-1] / (road.waviness - 1)
    if np.isfinite(turn):
        front, rear, static_front, static_rear = responses(np.array([turn]))
        product = ((front + static_front) * (rear + static_rear).conj()).sum(axis=2)[0]
        variance = variance + 2 * np.real(1j * product * np.exp(1j * turn * tau) / tau)
    return {
        name: np.inf if _has_feedthrough(model, y, road) and road.waviness <= 3 else float(value)
        for (name, y), value in zip(model.outputs.items(), variance, strict=True)
    }


def _mp(array):
    return mpmath.matrix(np.asarray(array, dtype=object).tolist())


def _np(matrix):
    return np.array(matrix.tolist(), dtype=object)


def variance_lyapunov_mpmath(A, Q, digits=50):
    """X of A X + X A^T + Q = 0 in multiple precision: one linear system in the upper triangle of X.

    A, Q: floats or mpmath numbers. Returns an object array of mpf. All eigenvalues of A in the open left half plane.
    """
    A, Q = np.asarray(A, dtype=object), np.asarray(Q, dtype=object)
    n = len(A)
    size = n * (n + 1) // 2
    upper = np.zeros((n, n), dtype=int)
    upper[np.triu_indices(n)] = np.arange(size)
    index = np.maximum(upper, upper.T).tolist()
    with mpmath.workdps(digits):
        system, right = mpmath.zeros(size), mpmath.zeros(size, 1)
        for i in range(n):
            for j in range(i, n):
                for k in range(n):
                    if A[i, k]:
                        system[index[i][j], index[k][j]] += A[i, k]
                    if A[j, k]:
                        system[index[i][j], index[i][k]] += A[j, k]
                right[index[i][j]] = -Q[i, j]
        solution = mpmath.lu_solve(system, right)
        return np.array([[solution[index[i][j]] for j in range(n)] for i in range(n)], dtype=object)


def _solve(A, B, digits):
    if digits is None:
        return np.linalg.solve(A, B)
    factors = _mp(A)
    return np.column_stack([_np(mpmath.lu_solve(factors, _mp(column[:, None]))) for column in np.asarray(B).T])


def _relative_system(model, digits):
    """x = (p, v), p = q - G z_r, v = q': x' = A x + B z_r' with G = K^-1 K_in."""
    inverse = np.diag(1 / np.diag(model.M))
    G = _solve(model.K, model.K_in, digits)
    n = len(model.M)
    A = np.block([[np.zeros((n, n), int), np.eye(n, dtype=int)], [-inverse @ model.K, -inverse @ model.C]])
    return A, np.vstack([-G, inverse @ model.C_in]), G


def covariance_lyapunov(model, road, digits=None):
    """Covariance X of the road-relative states (p, v) for white road velocity, and E[x delta], E[delta^2] of the warp.

    x = integral of h(s) w(t - s) ds with h(s) = e^(A s) B_f + e^(A (s - tau)) B_r [s > tau], so
    A X + X A^T + q (B_f B_f^T + B_r B_r^T + E B_f B_r^T + B_r B_f^T E^T) = 0, E = e^(A tau).
    The warp delta = u . (s(t) - s(t - tau)) is the integral of u . w over the last tau, so E[delta^2] = q |u|^2 tau
    and E[x delta] = q times the integral of e^(A s) B_f u over 0 < s < tau = q A^-1 (E - I) B_f u.
    """
    q, tau = road_intensity(road.roughness, road.speed), _delay(model, road)
    A, B, _ = _relative_system(model, digits)
    F, R = _sources(model, road)
    X, E = _delayed_lyapunov(A, B @ F, B @ R, q, tau, digits)
    u = _bounded_warp(model, road)
    cross = q * _solve(A, (E - np.eye(len(A), dtype=int)) @ (B @ F @ u)[:, None], digits)[:, 0]
    return X, cross, q * (u @ u) * tau


def _delayed_lyapunov(A, B_f, B_r, q, tau, digits):
    """Covariance of x' = A x + B_f w(t) + B_r w(t - tau), and e^(A tau)."""
    E = scipy.linalg.expm(A * tau) if digits is None else _np(mpmath.expm(_mp(A * tau), method="taylor"))
    delayed = E @ B_f @ B_r.T
    Q = q * (B_f @ B_f.T + B_r @ B_r.T + delayed + delayed.T)
    if digits is not None:
        return variance_lyapunov_mpmath(A, Q, digits), E
    return scipy.linalg.solve_continuous_lyapunov(A, -Q), E


def variance_lyapunov_delay(model, road, digits=None):
    """Variances for waviness 2 with the exact wheelbase delay; output name -> E[y^2] (infinite with feedthrough).

    Without cut-off in the road-relative states and the warp of `covariance_lyapunov`. With one, z_r' = -alpha z_r + w,
    alpha = 2 pi n_c V, in the plain states (q, q', s(t), s(t - tau)). With `digits` in multiple precision.
    """
    if road.waviness != 2 or road.tracks == "isotropic":
        raise ValueError("white road velocity with identical, independent or four separate tracks only")
    if digits is None:
        return _variance_lyapunov(_float(model), road, None)
    with mpmath.workdps(digits):
        return _variance_lyapunov(_exact(model), road, digits)


def _variance_lyapunov(model, road, digits):
    inverse = np.diag(1 / np.diag(model.M))
    K, C, C_in = inverse @ model.K, inverse @ model.C, inverse @ model.C_in
    variance = {}
    if road.cutoff == 0:
        X, cross, warp = covariance_lyapunov(model, road, digits)
        G = _relative_system(model, digits)[2]
        signs = _warp(model)
        for name, y in model.outputs.items():
            row = np.concatenate([y.q - y.a @ K, y.v - y.a @ C])
            beta = (y.q @ G + y.r) @ signs / len(model.wheels)
            variance[name] = row @ X @ row + 2 * beta * (row @ cross) + beta**2 * warp
    else:
        q, alpha = road_intensity(road.roughness, road.speed), 2 * np.pi * road.cutoff * road.speed
        F, R = _sources(model, road)
        Z, n, m = np.hstack([F, R]), len(K), F.shape[1]
        K_in = inverse @ model.K_in - alpha * C_in
        A = np.block(
            [
                [np.zeros((n, n), int), np.eye(n, dtype=int), np.zeros((n, 2 * m), int)],
                [-K, -C, K_in @ Z],
                [np.zeros((2 * m, 2 * n), int), -alpha * np.eye(2 * m)],
            ]
        )
        zero = np.zeros((n, m))
        B_f = np.vstack([zero, C_in @ F, np.eye(2 * m)[:, :m]])
        B_r = np.vstack([zero, C_in @ R, np.eye(2 * m)[:, m:]])
        X, _ = _delayed_lyapunov(A, B_f, B_r, q, _delay(model, road), digits)
        for name, y in model.outputs.items():
            row = np.concatenate([y.q - y.a @ K, y.v - y.a @ C, (y.a @ K_in + y.r - alpha * y.w) @ Z])
            variance[name] = row @ X @ row
    number = float if digits is None else mpmath.mpf
    return {
        name: number("inf") if _has_feedthrough(model, y, road) else number(variance[name])
        for name, y in model.outputs.items()
    }


def metrics(model, variance):
    """RMS of every output and the mean damper power c_s E[d_s'^2] (W), from a dict of variances."""
    rms = {name: float(np.sqrt(max(0.0, float(value)))) for name, value in variance.items()}
    for wheel in model.wheels:
        end = f"_{wheel}" if wheel else ""
        rms[f"damper_power{end}"] = float(model.cs[wheel] * variance[f"sws_rate{end}"])
    return rms


# ---------------------------------------------------------------------------------------------------- closed forms
# White road velocity of intensity q, no tyre damping, M = m_s + m_u. Each is the residue integral of its transfer
# function from road velocity, (1/2 pi) int |N/D|^2 d omega, D the characteristic polynomial of Eqs 29 and 30.


def rigid_tyre_deflection_variance(ms, cs, q):
    """E[d_s^2] = q m_s/(2 c): d_s/w = s/(s^2 + (c/m) s + k/m), whatever the stiffness is."""
    return q * ms / (2 * cs)


def quarter_deflection_variance(ms, mu, cs, q):
    """E[d_s^2] = q M/(2 c)."""
    return q * (ms + mu) / (2 * cs)


def quarter_body_acceleration_variance(ms, mu, ks, cs, kt, q):
    """E[z_s''^2] = (q/2) [k_t c/m_s^2 + M k_s^2/(m_s^2 c)]."""
    return q / 2 * (kt * cs / ms**2 + (ms + mu) * ks**2 / (ms**2 * cs))


def quarter_tyre_deflection_variance(ms, mu, ks, cs, kt, q):
    """E[d_t^2] = (q/2) [M^3 k_s^2/(m_s^2 c k_t^2) - 2 M m_u k_s/(m_s c k_t) + m_u/c + M^2 c/(m_s^2 k_t)]."""
    M = ms + mu
    return (
        q
        / 2
        * (M**3 * ks**2 / (ms**2 * cs * kt**2) - 2 * M * mu * ks / (ms * cs * kt) + mu / cs + M**2 * cs / (ms**2 * kt))
    )


def quarter_tyre_force_variance(ms, mu, ks, cs, kt, q):
    """E[(k_t d_t)^2]."""
    return kt**2 * quarter_tyre_deflection_variance(ms, mu, ks, cs, kt, q)


def quarter_deflection_rate_variance(cs, kt, q):
    """E[d_s'^2] = q k_t/(2 c)."""
    return q * kt / (2 * cs)


def quarter_damper_power(kt, q):
    """Mean damper power c E[d_s'^2] = q k_t/2, whatever the masses, the spring and the damper are."""
    return q * kt / 2


def comfort_optimal_damping(ms, mu, ks, kt):
    """c* = k_s sqrt(M/k_t), where d E[z_s''^2]/dc = 0."""
    return ks * ((ms + mu) / kt) ** 0.5


def equivalent_sprung_masses(mb, iyy, ixx, a, c):
    """Sprung masses of the heave, pitch and roll quarter cars of a full car with identical corners and a = b.

    A body corner moves by z_s = z_b, a theta or c phi; four equal forces give m z_s'' = F with m = M_b/4,
    I_yy/(4 a^2), I_xx/(4 c^2). Equal anti-roll bars add 2 arb to k_s in roll.
    """
    return {"heave": mb / 4, "pitch": iyy / (4 * a**2), "roll": ixx / (4 * c**2)}


def corner_effective_mass(mb, iyy, ixx, lever, c):
    """Body mass felt by one corner force alone: 1/m = 1/M_b + lever^2/I_yy + c^2/I_xx, lever a (front) or b (rear)."""
    return 1 / (1 / mb + lever**2 / iyy + c**2 / ixx)
