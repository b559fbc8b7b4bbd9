"""Rare events by `ss.rare_events` beside their counts in simulations of 10^5 s.

A hundred profiles of 20 km, of as many seeds, are driven over at 20 m/s: how often a deflection reaches a level and a
wheel leaves the ground, how high deflections and loads come on a kilometre, and what rainflow counting makes of the
spring's force. Records are independent, so that their scatter tells the error. A profile has no waves shorter than two
of its steps, and less of them for a wheel between its points, which takes half to one per cent from the rates of tyre
loads. Writes a table under ``benchmarks/results``.

    python benchmarks/rare_events.py [--records 100]
"""

import argparse
import itertools
import os
import sys
import time

import numpy as np
from report import processor, rows
from ride_metrics import RESULTS

import susp_ss as ss

SPEED, LENGTH, STRETCH, STEP, SPACING, CONTACT = 20.0, 20e3, 1000.0, 0.5e-3, 0.01, 0.2
SLOPE = 5.0

CASES = {
    "quarter car": (ss.QuarterCar(), "identical", {"quarter car": {}}),
    "full car": (
        ss.FullCar(),
        "isotropic",
        {"full car, front right": {"corner": "fr"}, "full car, rear right": {"corner": "rr"}},
    ),
}
STOPS = (0.04, 0.055, 0.07)

# Asserted: the largest difference in standard errors of a rate, beyond what a profile leaves out, and the largest
# relative one of a highest value.
WIDEST, LEFT_OUT, NEAR = 4.5, 0.01, 0.02


def road(tracks):
    return ss.Road.iso8608("D", speed=SPEED, tracks=tracks, contact_length=CONTACT)


def upcrossings(y, level):
    above = y > level
    return int(np.count_nonzero(above[1:] & ~above[:-1]))


def rainflow(y):
    """Ranges of the cycles of a history and how often each counts (ASTM E1049, by a stack of turning points)."""
    turns = y[np.r_[True, np.diff(np.sign(np.diff(y))) != 0, True]]
    stack, ranges = [], []
    for point in turns.tolist():
        stack.append(point)
        while len(stack) > 2 and abs(stack[-1] - stack[-2]) >= abs(stack[-2] - stack[-3]):
            inner = abs(stack[-2] - stack[-3])
            if len(stack) == 3:
                ranges.append((inner, 0.5))
                del stack[0]
            else:
                ranges.append((inner, 1.0))
                del stack[-3:-1]
    ranges += [(abs(a - b), 0.5) for a, b in itertools.pairwise(stack)]
    return np.array(ranges)


def counted(at, ks, load):
    """What one record comes to, after the first kilometre, over which the start is forgotten."""
    first = round(STRETCH / SPEED / STEP)
    sws, dtl = at.sws.values[first:], at.dtl.values[first:]
    parts = [np.array_split(y, round(LENGTH / STRETCH)) for y in (sws, dtl)]
    seconds = STEP * len(sws)
    cycles = rainflow(ks * sws / 1e3)
    return {
        "zero crossings of sws": upcrossings(sws, 0.0) / seconds,
        "zero crossings of dtl": upcrossings(dtl, 0.0) / seconds,
        **{f"bump at {1e3 * stop:g} mm": upcrossings(sws, stop) / seconds for stop in STOPS},
        **{f"reached, {1e3 * stop:g} mm": np.mean([part.max() > stop for part in parts[0]]) for stop in STOPS},
        "lift-off": upcrossings(-dtl, load) / seconds,
        "highest sws": np.mean([part.max() for part in parts[0]]),
        "highest dtl": np.mean([part.max() for part in parts[1]]),
        "damage": float(cycles[:, 1] @ cycles[:, 0] ** SLOPE) * STRETCH / LENGTH,
    }


def expected(vehicle, tracks, place):
    """The same by moments, with the other estimates beside."""

    def at(clearance):
        events = ss.rare_events(vehicle, road(tracks), clearance, distance=STRETCH, sn_slope=SLOPE)
        return events.sel(place)

    one, stops = at(STOPS[0]), [at(stop) for stop in STOPS]

    def highest(name):
        return {estimate: float(one[f"{name}_highest"].sel(estimate=estimate)) for estimate in one.estimate.values}

    return {
        "zero crossings of sws": {"Rice": float(one.sws_crossings)},
        "zero crossings of dtl": {"Rice": float(one.dtl_crossings)},
        **{f"bump at {1e3 * s:g} mm": {"Rice": float(e.bump_rate)} for s, e in zip(STOPS, stops, strict=True)},
        **{
            f"reached, {1e3 * s:g} mm": {
                "vanmarcke": float(e.bump_probability),
                "crossings one by one": -np.expm1(-float(e.bump_rate) * STRETCH / SPEED),
            }
            for s, e in zip(STOPS, stops, strict=True)
        },
        "lift-off": {"Rice": float(one.lift_off_rate)},
        "highest sws": highest("sws"),
        "highest dtl": highest("dtl"),
        "damage": {counting: float(one.damage.sel(counting=counting)) for counting in one.counting.values},
    }, float(one.static_load)


def table(records):
    body = []
    for vehicle, tracks, places in CASES.values():
        ours = {name: expected(vehicle, tracks, place) for name, place in places.items()}
        every = {name: [] for name in places}
        for seed in range(records):
            profile = ss.synthesise(road(tracks), LENGTH + STRETCH, SPACING, seed)
            ride = ss.simulate(vehicle, profile, speed=SPEED, step=STEP)
            for name, place in places.items():
                every[name].append(counted(ride.sel(place), vehicle.ks, ours[name][1]))
            print(f"{', '.join(places)}: {seed + 1} of {records}", file=sys.stderr, flush=True)
        for name, (estimates, _) in ours.items():
            body += compared(name, estimates, every[name])
    return body


def compared(name, ours, every):
    for what, estimates in ours.items():
        values = np.array([one[what] for one in every])
        mean, error = values.mean(), values.std(ddof=1) / np.sqrt(len(values))
        said = ", ".join(f"{kind} {value:.4g} ({value / mean - 1.0:+.1%})" for kind, value in estimates.items())
        first = next(iter(estimates.values()))
        beyond = "Rice" in estimates and abs(first - mean) > WIDEST * error + LEFT_OUT * mean
        beyond |= what.startswith("highest") and abs(first / mean - 1.0) > NEAR
        yield [name, what, f"{mean:.4g} ± {error:.2g}", said], beyond


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--records", type=int, default=100)
    records = parser.parse_args().records
    started = time.perf_counter()
    body = table(records)
    text = [
        "# Rare events beside simulations",
        "",
        f"{processor()}, {os.cpu_count()} cores. One run of {time.perf_counter() - started:.0f} s. {records} records "
        f"of {LENGTH / SPEED:g} s at {SPEED:g} m/s on class D with a contact of {CONTACT:g} m, a sample every "
        f"{1e3 * STEP:g} ms. Rates in 1/s; probabilities, highest values (m, N) and damage on a kilometre, damage in "
        f"cycles of 1 kN with a slope of {SLOPE:g}. ± is the standard error of the mean; in brackets how far an "
        "estimate is from it.",
        "",
        *rows(["vehicle", "what", "simulated", "by moments"], [row for row, _ in body]),
    ]
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "rare_events.md").write_text("\n".join(text) + "\n", encoding="utf-8")
    print("\n".join(text))
    assert not any(beyond for _, beyond in body), [row for row, beyond in body if beyond]


if __name__ == "__main__":
    main()
