"""Surrogate files that the page without a server opens, beside what the package says of them."""

import dataclasses
import functools
import json
import runpy
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import susp_ss as ss
from susp_ss.explorer.design import road_of, vehicle_of
from susp_ss.explorer.freeze import freeze
from susp_ss.explorer.layout import layout
from susp_ss.explorer.state import NOTHING, from_query
from susp_ss.explorer.surrogates import predictions
from susp_ss.fit.surrogate_file import SuspensionSurrogate, surrogate_of
from susp_ss.quantities import unit_of
from susp_ss.surrogates.numbers import KINDS

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")
RANGES = {
    "ks": (13e3, 24e3),
    "ks_front": (13e3, 24e3),
    "ks_rear": (13e3, 24e3),
    "cs": (900.0, 2200.0),
    "speed": (10.0, 40.0),
    "roughness": (16e-6, 256e-6),
    "cutoff": (0.0, 0.02),
    "ct": (0.0, 0.0),
}


def runs_of(columns, count):
    """Runs of full cars, and what they have measured."""
    rng = np.random.default_rng(count)
    X = pd.DataFrame({name: rng.uniform(*RANGES[name], count) for name in columns})
    own = {name: X[name].to_numpy() for name in columns}
    road = {name: own.pop(name) for name in ("speed", "roughness", "cutoff") if name in own}
    return X, ss.FullCar().replaced(**own), dataclasses.replace(ROAD, **road)


def surrogates(columns, count, cheap, kinds, accuracy=None, scatter=0.0):
    """Fits of kinds to runs, by output; accelerations weighted as the cheap model's are."""
    rng = np.random.default_rng(1)
    X, cars, road = runs_of(columns, count)
    weighting = dict.fromkeys(("bacc", "pitch_acc", "roll_acc"), cheap.weighting) if cheap.weighting else None
    metrics, models = ss.ride_metrics(cars, road, weighting=weighting), {}
    for output, make in kinds.items():
        metric, _, place = output.rpartition("_") if output not in metrics else (output, "", "")
        data = metrics[metric]
        at = {dim: place or cheap.place for dim in data.dims if dim in ("point", "corner")}
        y = data.sel(at).to_numpy() * (1.0 + scatter * rng.normal(size=count))
        models[output] = make(lambda tuned=False, output=output: cheap.response(output, columns, tuned)).fit(X, y)
    units = {name: unit_of(name) for name in (*columns, *models)}
    inputs, outputs = ({name: units[name] for name in some} for some in (columns, models))
    return SuspensionSurrogate(inputs, outputs, models, cheap, accuracy or {})


def corrections():
    """The study's, of a quarter car, on axles and roads of their own; half of the runs are known by rank alone."""
    kinds = {
        "bacc_cg": lambda f: ss.ResponseBased(f()),
        "bacc_fr": lambda f: ss.ResponseBased(f(), form="power"),
        "sws_rr": lambda f: ss.VariableBased(f(), nonnegative=True),
        "dtl": lambda f: ss.ParameterBased(f(tuned=True)),
        "damper_power_rr": lambda f: ss.ResponseBased(f(), terms=(False, True)),
        "tyre_deflection_fr": lambda f: ss.VariableBased(f(), terms=(True, True, False, True, False, False, True)),
        "pitch_acc": lambda f: ss.Polynomial(degree=1),
    }
    cheap = ss.LowFidelity(ss.QuarterCar(ms=300.0), ROAD, place="fr", parameter="ms", weighting="Wk")
    columns = ["ks_front", "ks_rear", "cs", "speed", "roughness", "cutoff"]
    return surrogates(columns, 33, cheap, kinds, {"dtl": {"surrogate": "PB ms"}})


def few():
    """Of so few runs that errors count as normal; another weighting, and a road of other tracks."""
    kinds = {
        "bacc": lambda f: ss.ResponseBased(f()),
        "sws": lambda f: ss.VariableBased(f()),
        "dtl_rl": lambda f: ss.ParameterBased(f(tuned=True)),
        "roll_acc": lambda f: ss.Polynomial(degree=2),
    }
    road = dataclasses.replace(ROAD, tracks="identical", cutoff=0.01)
    cheap = ss.LowFidelity(ss.QuarterCar(), road, place="rl", parameter="kt", weighting="Wb")
    return surrogates(["ks", "cs"], 9, cheap, kinds)


def half():
    """Cheap models of several wheels, of which a parameter is the mean over the corners that it stands for."""
    kinds = {
        "bacc_cg": lambda f: ss.VariableBased(f()),
        "sws_rr": lambda f: ss.ResponseBased(f()),
        "pitch_acc": lambda f: ss.ParameterBased(f(tuned=True)),
    }
    car = ss.PitchHalfCar(ks=(19e3, 21e3))
    return surrogates(["ks_front", "cs", "speed"], 20, ss.LowFidelity(car, ROAD, "cg", "mu_front"), kinds)


def whole():
    kinds = {
        "bacc_fr": lambda f: ss.ResponseBased(f()),
        "dtl_rl": lambda f: ss.ParameterBased(f(tuned=True)),
        "roll_acc": lambda f: ss.VariableBased(f()),
    }
    car = ss.FullCar(mb=1200.0, ks=ss.Corners(fr=18e3, fl=19e3, rr=20e3, rl=21e3))
    return surrogates(["ks_front", "cs"], 12, ss.LowFidelity(car, ROAD, None, "mb", "We"), kinds)


def approximations():
    """Of the runs alone, and beside the cheap model; of runs that scatter, as processes of smooth ones lose digits."""
    kinds = {
        "bacc_cg": lambda f: ss.CoKriging(f()),
        "bacc_fr": lambda f: ss.CoKriging(f(), trend="linear", kernel="matern52"),
        "pitch_acc": lambda f: ss.Kriging(),
        "roll_acc": lambda f: ss.Kriging("quadratic", "matern52"),
        "sws_fr": lambda f: ss.RadialBasis(),
        "sws_rr": lambda f: ss.RadialBasis("gaussian", shape=1.0),
        "dtl_fr": lambda f: ss.RadialBasis("multiquadric", shape=1.0),
        "dtl_rr": lambda f: ss.RadialBasis("inverse_multiquadric", shape=1.0, degree=1),
        "sws_rate_fr": lambda f: ss.RadialBasis("cubic"),
        "sws_rate_rr": lambda f: ss.RadialBasis("linear"),
        "damper_power_fr": lambda f: ss.Polynomial(degree=3),
    }
    cheap = ss.LowFidelity(ss.QuarterCar(), ROAD, "fr", weighting="Wk")
    return surrogates(["ks_front", "cs"], 20, cheap, kinds, scatter=0.02)


FITS = {made.__name__: made for made in (corrections, few, half, whole, approximations)}


@functools.cache
def filed(name):
    """A fit as its file gives it back, and the file's text."""
    text = json.dumps(FITS[name]().document())
    return surrogate_of(json.loads(text)), text


@pytest.fixture(params=FITS)
def fitted(request):
    return filed(request.param)


def asked(ask, text, states):
    """The engine's rows of a file for each state."""
    questions = [{"state": state, "pins": [], "files": [{"name": "fit.json", "text": text}]} for state in states]
    return [answer["found"]["surrogates"] for answer in ask("answer", questions)]


def drawn(rng, i, model):
    """A car of one damping rate in the runs, or about them; some have a seat or curves."""
    low, high = (np.array(ends) for ends in zip(*RANGES.values(), strict=True))
    spread = 0.3 * (high - low) * (i % 2)
    own = dict(zip(RANGES, rng.uniform(np.maximum(low - spread, 0.1 * high), high + spread), strict=True))
    at_axles = {f"{name}_{axle}": own[name] for name in ("ks", "cs") for axle in ("front", "middle", "rear")}
    words = {"model": model, **own, **at_axles}
    words |= {"seat_mass": 80.0} if i % 3 == 1 else {}
    words |= {"curve_rebound": 1.4, "curve_knee": 0.08} if i % 4 == 3 else {}
    # What a model has no slider for, or none that goes so far, is left as it is.
    return from_query("&".join(f"{name}={value}" for name, value in words.items()))[0]


def expected(fitted, state):
    try:
        return predictions("fit.json", fitted, vehicle_of(state), road_of(state))
    except ValueError as error:
        return [{"surrogate": "fit.json", "refused": str(error)}]


def same(found, rows, rtol=1e-9):
    """Whether rows are the same, numbers to a billionth of the largest of a row."""
    assert len(found) == len(rows)
    for one, other in zip(found, rows, strict=True):
        numbers = [name for name, value in other.items() if isinstance(value, float)]
        most = max((abs(other[name]) for name in numbers), default=0.0)
        assert one == other | {name: pytest.approx(other[name], rel=rtol, abs=rtol * most) for name in numbers}


OTHERS = ("ride-handling", "quarter", "pitch-half", "roll-half", "three-axle")


def test_rows_are_those_of_the_package(ask, fitted):
    surrogate, text = fitted
    rng = np.random.default_rng(3)
    models = ["full"] * 4 + [*(OTHERS if "speed" in surrogate.inputs else ())]
    states = [drawn(rng, i, model) for i, model in enumerate(models)]
    outside = set()
    for state, rows in zip(states, asked(ask, text, states), strict=True):
        same(rows, expected(surrogate, state))
        outside |= {row["outside"] for row in rows if "outside" in row}
    assert outside == {True, False}


def changed(document, change):
    """The text of a document with something changed."""
    found = json.loads(document)
    change(found)
    return json.dumps(found)


@pytest.fixture(scope="module")
def text():
    return filed("few")[1]


def test_vehicles_are_refused_in_the_words_of_the_package(ask, text):
    surrogate = surrogate_of(json.loads(text))
    apart, soft = "ks_front=21000&cs_rear=1300", "model=ride-handling&ks_front=5053&ks_rear=5053&height=1.2&c=0.45"
    large = "model=three-axle&ks_rear=1200000"
    for state, said in (
        (apart, "needs one ks for all of fr, fl, rr, rl"),
        (soft, "does not die out"),
        (large, "ml 550000, rr 1.2e+06"),
    ):
        state = from_query(state)[0]
        (rows,) = asked(ask, text, [state])
        assert rows == expected(surrogate, state)
        assert said in rows[0]["refused"]


def test_a_cheap_response_that_is_infinite_is_refused_in_the_words_of_the_package(ask):
    """Tyres without damping, but for those of the page."""
    cheap = ss.LowFidelity(ss.QuarterCar(), ROAD, "fr")
    surrogate = surrogates(["ks", "ct"], 6, cheap, {"dtl": lambda f: ss.ResponseBased(f())})
    state = from_query("ct_front=50&ct_rear=50")[0]
    (rows,) = asked(ask, json.dumps(surrogate.document()), [state])
    assert rows == expected(surrogate, state)
    assert "finite" in rows[0]["refused"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda d: d["low_fidelity"]["road"].update(table=[[0.1, 1.0]], waviness=[2.0, 2.0]), "the road of this fit"),
        (lambda d: d["low_fidelity"]["road"].update(delay=False), "the road of this fit"),
    ],
)
def test_what_only_the_server_has_is_said(ask, text, change, said):
    (rows,) = asked(ask, changed(text, change), [from_query("")[0]])
    assert rows == [{"surrogate": "fit.json", "refused": f"{said} needs susp-ss explore"}]


def test_every_kind_is_tested():
    assert {type(model).__name__ for name in FITS for model in filed(name)[0].models.values()} == {*KINDS}


def test_what_is_as_smooth_as_digits_bear(ask):
    """Weights of ten digits and more nearly cancel; the package itself keeps no more of them on other libraries."""
    cheap = ss.LowFidelity(ss.QuarterCar(), ROAD, "fr")
    kinds = {
        "sws": lambda f: ss.RadialBasis("gaussian"),
        "dtl": lambda f: ss.Kriging(),
        "bacc": lambda f: ss.CoKriging(f()),
    }
    surrogate = surrogates(["ks", "cs"], 14, cheap, kinds)
    state = from_query("cs_front=1500&cs_rear=1500")[0]
    (rows,) = asked(ask, json.dumps(surrogate.document()), [state])
    same(rows, expected(surrogate, state), rtol=1e-5)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda one: one.pop("left_out"), "RadialBasis of an older file"),
        (
            lambda one: one["found"].update(designs=[[1.0, 2.0]] * 301, responses=[1.0] * 301),
            "RadialBasis of more than 300 runs",
        ),
    ],
)
def test_what_only_the_server_predicts_is_said_and_the_others_stand(ask, change, said):
    cheap = ss.LowFidelity(ss.QuarterCar(), ROAD, "fr")
    kinds = {"sws": lambda f: ss.RadialBasis(), "dtl": lambda f: ss.VariableBased(f())}
    text, state = json.dumps(surrogates(["ks", "cs"], 6, cheap, kinds).document()), from_query("")[0]
    (rows,), (all_of_them,) = (
        asked(ask, changed(text, lambda d: change(d["outputs"]["sws"])), [state]),
        asked(ask, text, [state]),
    )
    assert rows[0] == {"surrogate": "fit.json: RadialBasis", "refused": f"sws: {said} needs susp-ss explore"}
    assert rows[1] == all_of_them[1]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda d: d.pop("format"), None),
        (lambda d: d.update(version=7, susp_ss="9.1"), None),
        (lambda d: d.update(version=0), "damaged: version"),
        (lambda d: d.pop("outputs"), "damaged: outputs"),
        (lambda d: d["outputs"]["bacc"].update(kind="Oracle"), None),
        (lambda d: d["outputs"]["sws"].update(columns=["ks"]), "damaged: sws must have the columns ks, cs"),
        (lambda d: d["outputs"]["bacc"]["found"].pop("coef"), "damaged: coef"),
        (lambda d: d["outputs"]["roll_acc"]["settings"].update(degree=10**18), "damaged: coef"),
        (lambda d: d["outputs"]["bacc"]["left_out"]["folds"].pop(), "damaged: folds"),
        (lambda d: d["low_fidelity"]["road"].update(speed=-1.0), "damaged: road.speed"),
        (lambda d: d["low_fidelity"]["road"].update(lenght=0.1), "damaged: road has a lenght"),
        (lambda d: d["low_fidelity"].update(place="left"), "damaged: place is left"),
        (lambda d: d["low_fidelity"].update(weighting=3), "damaged: weighting"),
        (lambda d: d["outputs"]["bacc"].pop("unit"), "damaged: bacc has no unit"),
        (lambda d: d.update(stated=["mm"]), "damaged: stated"),
        (lambda d: d["low_fidelity"]["vehicle"].update(model="lorry"), None),
    ],
)
def test_a_file_that_is_none_is_refused_in_one_line(ask, text, change, said):
    broken = changed(text, change)
    with pytest.raises(ValueError, match=r".") as refusal:
        surrogate_of(json.loads(broken))
    (found,) = ask("wrong", [broken])
    assert found.startswith(said) if said else found == str(refusal.value)
    assert "\n" not in found


def test_lists_in_lists_without_end_are_refused_in_one_line(ask, text):
    columns = f"{'[' * 200_000}{']' * 200_000}"
    (found,) = ask("wrong", [changed(text, lambda d: d["outputs"]["sws"].update(columns="?")).replace('"?"', columns)])
    assert found.startswith("damaged: ")


def test_any_damage_is_refused_in_one_line_or_predicts(ask):
    damage = runpy.run_path(str(BENCHMARKS / "damaged_files.py"))
    rng = np.random.default_rng(2)
    texts = [damage["damaged"](text, rng) for text in damage["documents"]().values() for _ in range(40)]
    said = ask("wrong", texts)
    assert not any("\n" in line for line in said)
    right = [text for text, line in zip(texts, said, strict=True) if not line]
    assert 0 < len(right) < 0.5 * len(texts)
    files = [{"name": str(i), "text": text} for i, text in enumerate(right)]
    (answer,) = ask("answer", [{"state": from_query("")[0], "pins": [], "files": files}])
    assert {row["surrogate"].partition(":")[0] for row in answer["found"]["surrogates"]} == {
        *map(str, range(len(right)))
    }


def test_a_page_with_a_server_has_no_button():
    """Its surrogates are those that the server was started with."""
    assert [repr(layout(NOTHING, served)).count("Open file: surrogate.json") for served in (True, False)] == [0, 2]


def test_a_file_is_opened_in_the_page_and_closed(browser, script, text, tmp_path, monkeypatch):
    monkeypatch.setattr("susp_ss.explorer.freeze.engine", lambda: script)
    (tmp_path / "runs.json").write_text(text)
    (tmp_path / "broken.json").write_text(text[:200])
    surrogate, query = surrogate_of(json.loads(text)), "ks_front=20000&ks_rear=20000"
    tab = browser.new_page()
    tab.set_default_timeout(0)
    asked_for = []
    tab.on("request", lambda request: asked_for.append(request.url))
    tab.goto(f"{freeze(tmp_path / 'page').as_uri()}?{query}")
    tab.wait_for_selector("#panels[aria-busy=false]")
    button = tab.get_by_role("button", name="Open file: surrogate.json")
    assert tab.locator("#surrogates").is_hidden()
    with tab.expect_file_chooser() as chooser:
        button.click()
    chooser.value.set_files([tmp_path / "broken.json", tmp_path / "runs.json"])
    closing = tab.get_by_role("button", name="Close runs.json")
    closing.wait_for()
    assert tab.get_by_role("alert").all_inner_texts()[-1].startswith("broken.json: not a surrogate file, or cut short")
    assert tab.get_by_role("button", name="Close").count() == 1
    row = tab.locator("#surrogates tr", has_text="runs.json: VariableBased")
    value = expected(surrogate, from_query(query)[0])[1]["value"]
    assert float(row.locator("td.now").inner_text()) == pytest.approx(1e3 * value, rel=5.1e-3)
    tab.locator("input[type=range][name=cs_front]").press("ArrowRight")
    tab.locator("#surrogates tr", has_text="needs one cs for all of fr, fl, rr, rl").wait_for()
    tab.locator("#undo").click()
    row.wait_for()
    closing.click()
    tab.locator("#surrogates").wait_for(state="hidden")
    assert button.evaluate("button => button === document.activeElement")
    assert all(url.startswith(("file:", "data:", "blob:")) for url in asked_for)
    tab.close()
