"""Surrogate files, damaged ten thousand times: each is refused in one line or predicts, and nothing else gets out.

One file of every kind of surrogate. A damage is a value replaced somewhere in the document, a key or an entry lost or
doubled, or bytes of the text changed, lost or doubled. Run with ``make bench``, or ``python benchmarks/damaged_files.py
--files 1000 --seed 3`` for others.
"""

import argparse
import json
import sys
import tempfile
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd

import susp_ss as ss
from susp_ss.fit.surrogate_file import SuspensionSurrogate
from susp_ss.surrogates.numbers import KINDS

COLUMNS = ["ks", "cs", "speed"]
CHEAP = ss.LowFidelity(ss.QuarterCar(), ss.Road.iso8608("C", speed=25.0, tracks="isotropic"), "fr", "ms")

VALUES = [
    *(None, True, "", "x", "ks", [], {}, [[]], [None], [[1.0]], {"ks": 1.0}),
    *(0, -1, 1, 2, 3.5, 40, 10**6, 10**18, 1e-300, 1e-9, 1e300, -1e308, "9" * 400, [1e308] * 3, [0.0] * 3),
]


def documents():
    """The text of a file of every kind, by kind."""
    X = pd.DataFrame(np.random.default_rng(1).uniform([15e3, 1e3, 15.0], [25e3, 2e3, 30.0], (14, 3)), columns=COLUMNS)
    f, tuned = CHEAP.response("sws", COLUMNS), CHEAP.response("sws", COLUMNS, tuned=True)
    y = 1.1 * tuned(X, 350.0) + 1e-7 * X["cs"]
    made = [
        *(ss.ResponseBased(f), ss.VariableBased(f), ss.ParameterBased(tuned), ss.Polynomial(2)),
        *(ss.RadialBasis("gaussian"), ss.Kriging("linear", kernel="matern52"), ss.CoKriging(f)),
    ]
    units = dict(zip(COLUMNS, ("N/m", "N s/m", "m/s"), strict=True))
    texts = {}
    for surrogate in made:
        document = SuspensionSurrogate(units, {"sws": "m"}, {"sws": surrogate.fit(X, y)}, CHEAP).document()
        texts[type(surrogate).__name__] = json.dumps(document, indent=1)
    assert texts.keys() == KINDS.keys()
    return texts


def damaged(text, rng):
    """The text with one to three damages."""
    for _ in range(rng.integers(1, 4)):
        try:
            text = in_values(text, rng) if rng.random() < 0.7 else in_bytes(text, rng)
        except (ValueError, RecursionError):
            text = in_bytes(text, rng)
    return text


def in_values(text, rng):
    document = json.loads(text)
    where, key = document, None
    while isinstance(where, (dict, list)) and where:
        keys = list(where) if isinstance(where, dict) else range(len(where))
        key = keys[rng.integers(len(keys))]
        if not isinstance(where[key], (dict, list)) or not where[key] or rng.random() < 0.2:
            break
        where = where[key]
    if key is None:
        return text
    what = rng.integers(4)
    if what == 0:
        del where[key]
    elif what == 1 and isinstance(where, list):
        where.insert(key, where[key])
    elif what == 2 and isinstance(where[key], float):
        where[key] *= 10.0 ** rng.integers(-30, 30)
    else:
        where[key] = VALUES[rng.integers(len(VALUES))]
    return json.dumps(document)


def in_bytes(text, rng):
    begin = int(rng.integers(len(text) + 1))
    end = begin + int(rng.integers(1, 20))
    new = ["", text[begin:end] * 2, "".join(map(chr, rng.integers(32, 127, 3))), "1e999", "NaN", "\x00", "[" * 2000][
        rng.integers(7)
    ]
    return text[:begin] + new + text[end:]


def verdict(path):
    """``refused`` or ``taken``; whatever else happens is an error that got out."""
    designs = pd.DataFrame([[2e4, 1.5e3, 20.0]], columns=COLUMNS)
    try:
        surrogate = ss.load_surrogate(path)
    except ValueError as refusal:
        if "\n" in str(refusal) or not str(refusal).startswith(str(path)):
            raise AssertionError(f"not one line that begins with the file: {refusal!r}") from refusal
        return "refused"
    try:
        surrogate.predict(designs, return_std=True, interval=0.95)
    except ValueError:
        return "asks for other columns" if list(surrogate.inputs) != COLUMNS else "refused at the design"
    return "taken"


def count(files, seed):
    """Verdicts by kind over ``files`` damaged files; the first that escapes is shown and raised."""
    texts, rng, found = documents(), np.random.default_rng(seed), {}
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Path(folder, "surrogate.json")
        for i in range(files):
            kind = list(texts)[i % len(texts)]
            text = damaged(texts[kind], rng)
            path.write_text(text, encoding="utf-8")
            try:
                found.setdefault(kind, Counter())[verdict(path)] += 1
            except BaseException:
                print(f"file {i} of seed {seed}, a {kind}:\n{text[:4000]}", file=sys.stderr)
                raise
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--files", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    found = count(asked.files, asked.seed)
    for kind, verdicts in found.items():
        print(f"{kind:16}", ", ".join(f"{said} {number}" for said, number in verdicts.most_common()))


if __name__ == "__main__":
    main()
