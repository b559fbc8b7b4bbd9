"""Pareto fronts beside grids of all designs, beside scaling, and over scenarios beside loops."""

import dataclasses
import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import susp_ss as ss
from susp_ss.metrics.outputs import output

QUARTER, FULL = ss.QuarterCar(), ss.FullCar()
ROAD = ss.DEFAULT_ROAD
KS, CS = (12536.0, 24570.0), (798.0, 2235.0)
TABLE = {"speed": [10.0, 20.0, 30.0, 30.0], "ms": [280.0, 320.0, 300.0, 380.0], "weight": [4.0, 2.0, 1.0, 1.0]}


def grid(vehicle, road, box, nodes):
    """All metrics of every node of the box."""
    axes = {name: xr.DataArray(np.linspace(*side, nodes), dims=name) for name, side in box.items()}
    metrics = ss.ride_metrics(vehicle.replaced(**axes), road)
    return lambda name: output(metrics, name).to_numpy().ravel()


def check_against(values, front, slack=3e-6):
    """No node beats a design of the front, and where the front has a design no node does better."""
    table, (first, second) = front.table(), front.objectives
    met = np.all([values(name) <= limit for name, limit in front.limits.items()], axis=0)
    x, y = values(first)[met], values(second)[met]
    for _, design in table.iterrows():
        assert design[first] <= x[y <= design[second]].min(initial=np.inf) * (1.0 + slack)
        assert design[second] <= y[x <= design[first]].min(initial=np.inf) * (1.0 + slack)
    assert table[first].min() <= x.min() * (1.0 + slack)
    assert table[second].min() <= y.min() * (1.0 + slack)
    assert np.all(np.diff(table[first]) > 0.0)
    assert np.all(np.diff(table[second]) < 0.0)
    for name, limit in front.limits.items():
        assert np.all(table[name] <= limit * (1.0 + 1e-6))


@pytest.mark.parametrize("limits", [{}, {"sws": 0.0055}])
def test_no_node_of_a_grid_beats_the_front_of_a_quarter_car(limits):
    box = {"ks": KS, "cs": CS}
    front = ss.pareto_front(QUARTER, ROAD, box, ("bacc", "dtl"), limits, points=6)
    assert len(front.designs) == 6
    check_against(grid(QUARTER, ROAD, box, 200), front)


def test_no_node_of_a_grid_beats_the_front_of_a_full_car_and_an_anti_roll_bar():
    box = {"ks_front": KS, "cs_front": CS, "arb_front": (0.0, 2e4)}
    front = ss.pareto_front(FULL, ROAD, box, ("roll_acc", "dtl@fr"), {"sws@fr": 0.0055}, points=3)
    check_against(grid(FULL, ROAD, box, 16), front)


def test_one_objective_gives_the_one_best_design():
    best = ss.pareto_front(QUARTER, ROAD, {"cs": (300.0, 5000.0)}, ("dtl",))
    values = grid(QUARTER, ROAD, {"cs": (300.0, 5000.0)}, 20001)("dtl")
    assert len(best.designs) == 1
    assert best.table()["dtl"][0] == pytest.approx(values.min(), rel=1e-8)


def test_a_rougher_road_changes_no_design():
    box, rough = {"ks": KS, "cs": CS}, dataclasses.replace(ROAD, roughness=4.0 * ROAD.roughness)
    one = ss.pareto_front(QUARTER, ROAD, box, ("bacc", "dtl"), {"sws": 0.0055}, points=4)
    other = ss.pareto_front(QUARTER, rough, box, ("bacc", "dtl"), {"sws": 0.011}, points=4)
    pd.testing.assert_frame_equal(other.designs, one.designs, rtol=1e-4)
    np.testing.assert_allclose(other.table()["dtl"], 2.0 * one.table()["dtl"], rtol=1e-6)


def test_an_objective_that_a_variable_does_not_change_leaves_that_to_the_other():
    box = {"cs": CS, "arb_front": (0.0, 2e4)}
    front = ss.pareto_front(FULL, ROAD, box, ("bacc@cg", "dtl@fr"), points=2)
    stiffer = ss.ride_metrics(FULL.replaced(cs=front.designs["cs"][0], arb_front=np.linspace(0.0, 2e4, 101)), ROAD)
    assert front.table()["dtl@fr"][0] <= float(stiffer.dtl.sel(corner="fr").min()) * (1.0 + 1e-5)


def by_hand(name, ks, cs, statistic):
    rows = [dict(zip(TABLE, row, strict=True)) for row in zip(*TABLE.values(), strict=True)]
    found = np.array(
        [
            ss.ride_metrics(QUARTER.replaced(ms=r["ms"], ks=ks, cs=cs), dataclasses.replace(ROAD, speed=r["speed"]))[
                name
            ]
            for r in rows
        ]
    )
    weights = np.array(TABLE["weight"]) / sum(TABLE["weight"])
    if statistic == "mean":
        return np.tensordot(weights, found, 1)
    return (
        found.max(axis=0)
        if statistic == "worst"
        else np.quantile(found, statistic, axis=0, weights=weights, method="inverted_cdf")
    )


@pytest.mark.parametrize("statistic", ["mean", "worst", 0.8])
def test_scenarios_are_what_a_loop_over_them_gives(statistic):
    box = {"ks": KS, "cs": CS}
    front = ss.pareto_front(
        QUARTER, ROAD, box, ("bacc", "dtl"), {"sws": 0.009}, 3, scenarios=TABLE, statistic=statistic
    )
    ks, cs = front.designs["ks"].to_numpy(), front.designs["cs"].to_numpy()
    for name in ("bacc", "dtl", "sws"):
        np.testing.assert_allclose(front.metrics[name], by_hand(name, ks, cs, statistic), rtol=1e-12)
    nodes = [axis.ravel() for axis in np.meshgrid(np.linspace(*KS, 40), np.linspace(*CS, 40))]
    check_against(lambda name: by_hand(name, *nodes, statistic), front, slack=1e-3)


def test_one_scenario_of_the_vehicle_and_road_themselves_changes_nothing():
    box = {"ks": KS, "cs": CS}
    plain = ss.pareto_front(QUARTER, ROAD, box, ("bacc", "dtl"), points=2)
    one = ss.pareto_front(QUARTER, ROAD, box, ("bacc", "dtl"), points=2, scenarios={"speed": [ROAD.speed]})
    pd.testing.assert_frame_equal(one.table(), plain.table(), rtol=1e-5)


def test_the_bound_is_that_of_active_bound_and_no_design_beats_it():
    front = ss.pareto_front(QUARTER, ROAD, {"ks": KS, "cs": CS}, ("bacc", "dtl"), points=2, bound=True)
    table = front.table()
    assert np.all(front.bound < table["bacc"])
    last = front.metrics.isel(design=-1)
    alone = ss.active_bound(QUARTER, ROAD, "bacc", {"dtl": float(last.dtl), "sws": float(last.sws)})
    assert front.bound[-1] == pytest.approx(alone.bound, rel=1e-3)


def test_a_front_stands_beside_its_vehicle_in_words_files_and_pictures(tmp_path):
    front = ss.pareto_front(QUARTER, ROAD, {"ks": KS, "cs": CS}, ("bacc", "dtl"), {"sws": 0.0055}, points=3)
    assert front.passive()["dtl"] == pytest.approx(float(ss.ride_metrics(QUARTER, ROAD).dtl))
    assert float(ss.ride_metrics(front.vehicle_of(1), ROAD).bacc) == pytest.approx(front.table()["bacc"][1])
    said = ss.report(front)
    assert "3 designs that no other beats in bacc and dtl, sws <= 0.0055 m" in said
    ss.save(front, tmp_path / "out")
    table = pd.read_csv(tmp_path / "out" / "front.csv", index_col="design")
    pd.testing.assert_frame_equal(table, front.table(), check_names=False)
    assert (tmp_path / "out" / "front.png").stat().st_size > 0
    with pytest.raises(FileExistsError):
        ss.save(front, tmp_path / "out")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"variables": {}}, "variables must map 1 to 12 names"),
        ({"variables": None}, "variables must map"),
        ({"variables": {"zz": (1.0, 2.0)}}, "no parameter named 'zz'"),
        ({"variables": {"ks": (2e4, 1e4)}}, "must rise"),
        ({"variables": {"ks": (np.nan, 1e4)}}, "must rise"),
        ({"variables": {"ks": 1e4}}, "must be two numbers"),
        ({"variables": {"ks": (-1.0, 1e4)}}, "must be > 0 N/m"),
        ({"objectives": "bacc"}, "objectives must be two names"),
        ({"objectives": ("bacc", "dtl", "sws")}, "objectives must be two names"),
        ({"objectives": ("bacc", "bacc")}, "objectives must differ"),
        ({"objectives": ("bacc", "comfort")}, "no metric named 'comfort'"),
        ({"objectives": ("bacc@fr", "dtl")}, "bacc has one place only"),
        ({"objectives": (None,)}, "must be names of metrics"),
        ({"limits": {"sws": None}}, r"limits\['sws'\] must be a number > 0 m"),
        ({"limits": ["sws"]}, "limits must be a mapping"),
        ({"limits": {"sws": 1e-3}}, "sws <= 0.001 is out of reach, least 0.00"),
        ({"limits": {"sws": 4.6e-3, "bacc": 0.62}}, "no design within the ranges meets all at once"),
        ({"points": 1}, "points must be a whole number >= 2"),
        ({"statistic": "worst"}, "pass scenarios"),
        ({"scenarios": {"speed": []}}, "at least one row"),
        ({"scenarios": {"speed": [1.0, 2.0], "mu": [40.0]}}, "columns of one length"),
        ({"scenarios": {"ks": [1e4]}}, "set one parameter"),
        ({"scenarios": {"wind": [1.0]}}, "no parameter named 'wind'"),
        ({"scenarios": {"speed": [np.nan]}}, "must be finite"),
        ({"scenarios": {"speed": ["fast"]}}, "must be numbers"),
        ({"scenarios": {"speed": [10.0], "weight": [-1.0]}}, "weights must be >= 0"),
        ({"scenarios": {"speed": [10.0]}, "statistic": 95}, "statistic must be 'mean', 'worst'"),
        ({"scenarios": {"speed": [10.0]}, "bound": True}, "takes no scenarios"),
        ({"bound": 1}, "bound must be True or False"),
    ],
)
def test_bad_input_is_refused_in_words(given, message):
    asked = {"variables": {"ks": KS, "cs": CS}, "objectives": ("bacc", "dtl")} | given
    with pytest.raises((TypeError, ValueError), match=message):
        ss.pareto_front(QUARTER, ROAD, **asked)


def test_a_place_is_asked_for_where_there_are_several():
    with pytest.raises(ValueError, match="pass one, such as sws@fr"):
        ss.pareto_front(FULL, ROAD, {"ks": KS}, ("bacc@cg", "sws"))
    with pytest.raises(ValueError, match="'ks_front' and 'ks' set one parameter"):
        ss.pareto_front(FULL, ROAD, {"ks": KS, "ks_front": KS})
    with pytest.raises(ValueError, match="roll_acc is 0 for every design"):
        ss.pareto_front(FULL, dataclasses.replace(ROAD, tracks="identical"), {"ks": KS}, ("roll_acc",))


def test_the_command_line_says_what_the_library_says(run, tmp_path):
    asked = ["optimise", "--model", "quarter", "--variables", "ks=12536:24570,cs=798:2235", "--points", 3]
    asked += ["--minimise", "bacc", "--minimise", "dtl", "--limit", "sws=5.5mm", "--json"]
    code, out, err = run(*asked)
    front = ss.pareto_front(QUARTER, ROAD, {"ks": KS, "cs": CS}, ("bacc", "dtl"), {"sws": 0.0055}, points=3)
    assert (code, err) == (0, "")
    pd.testing.assert_frame_equal(pd.DataFrame(json.loads(out)["designs"]), front.table(), check_names=False)
    table = tmp_path / "life.csv"
    table.write_text("speed;weight\n10,5;1\n20,5;2\n")
    code, out, _ = run(
        "optimise",
        "--model",
        "quarter",
        "--variables",
        "cs=798:2235",
        "--minimise",
        "dtl",
        "--scenarios",
        table,
        "--out",
        tmp_path / "out",
    )
    assert code == 0
    assert "mean over 2 scenarios of speed" in out
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["front.csv", "front.txt", "metrics.nc"]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["--variables", "ks", "--minimise", "bacc"], "--variables must be PARAM=LO:HI"),
        (["--variables", "ks=12:24", "--minimise", "bacc"], "did you mean 12 N/mm"),
        (["--variables", "ks=12e3:24e3", "--minimise", "bacc", "--limit", "sws"], "--limit must be METRIC@PLACE=VALUE"),
        (["--variables", "zz=1:2", "--minimise", "bacc"], "no parameter 'zz'"),
        (["--variables", "ks=12e3:24e3", "--minimise", "bacc", "--limit", "sws=1mm"], "is out of reach"),
        (["--variables", "ks=12e3:24e3", "--minimise", "bacc", "--scenarios", "none.csv"], "none.csv"),
    ],
)
def test_the_command_line_refuses_in_one_line(run, given, message):
    code, out, err = run("optimise", "--model", "quarter", *given)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert message in err
