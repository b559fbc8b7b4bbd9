"""Where designs land that are optimised on surrogates: beside dense grids of the full car, and where it is known."""

import json

import numpy as np
import pandas as pd
import pytest

import susp_ss as ss
from susp_ss.presentation.documents import study_document
from susp_ss.presentation.text.study import landings
from susp_ss.study import optima
from susp_ss.study.feasibility import DAMPING, STIFFNESS
from susp_ss.study.published import CRITERIA

ROAD = ss.DEFAULT_ROAD


def full_car(X):
    metrics = ss.ride_metrics(ss.FullCar(ks=X[:, 0], cs=X[:, 1]), ROAD)
    return np.stack([metrics[name].sel({metrics[name].dims[-1]: "fr"}) for name in CRITERIA], axis=-1)


def through(vehicle, parameter, at=None):
    return {name: ss.Response(vehicle, ROAD, name, at, parameter=parameter) for name in CRITERIA}


def found(low_fidelity, runs):
    return optima.verified_optima(full_car, low_fidelity, STIFFNESS, DAMPING, runs)


@pytest.fixture(scope="module")
def itself():
    """The full car as its own cheap model."""
    return found(through(ss.FullCar(), "mb", "fr"), (8,))


@pytest.fixture(scope="module")
def study():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("susp_ss.study.feasibility.RUNS", (5, 7))
        study = ss.feasibility_study(nodes=(3, 3))
        assert "optima" not in vars(study)
        assert study.optima is study.optima
    return study


def test_no_node_of_a_dense_grid_beats_the_optimum(itself):
    middle = full_car(np.array([[18553.0, 1516.5]]))[0]
    limits = 1.05 * middle[1:]
    assert [*itself.limits.values()] == pytest.approx(limits.tolist(), rel=1e-12)
    best = itself.best[list(CRITERIA)].to_numpy()
    assert (best[1:] <= limits * (1.0 + 2e-6)).all()
    assert itself.middle == pytest.approx(middle[0] / best[0] - 1.0, rel=1e-12)
    # The whole range, and where the optimum is a hundred times finer.
    wide = np.linspace(*STIFFNESS, 141), np.linspace(*DAMPING, 141)
    near = [itself.best[name] * np.linspace(0.995, 1.005, 101) for name in ("ks", "cs")]
    for axes, finest in ((wide, 5e-3), (near, 1e-4)):
        F = full_car(np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2))
        least = F[(F[:, 1:] <= limits).all(axis=1), 0].min()
        assert -2e-6 < least / best[0] - 1.0 < finest


def test_a_surrogate_that_is_the_full_car_lands_at_its_optimum(itself):
    exact = itself.landed.loc[["RB", "VB", "PB", "CoKriging"]]
    assert exact["beyond"].abs().max() < 1e-5
    assert exact["excess"].max() < 1e-5
    assert {name for name, runs in itself.enough().items() if runs == 8} >= {"RB", "VB", "PB", "CoKriging"}


def test_designs_are_judged_by_the_full_car(study):
    table, best = study.optima.landed, study.optima.best
    assert list(table.index.names) == ["surrogate", "runs"]
    assert [*dict.fromkeys(table.index.get_level_values("surrogate"))] == ["RB", "VB", "PB", "Kriging", "CoKriging"]
    F = full_car(table[["ks", "cs"]].to_numpy())
    np.testing.assert_allclose(table[list(CRITERIA)], F, rtol=1e-9)
    np.testing.assert_allclose(table["beyond"], F[:, 0] / best["bacc"] - 1.0, atol=1e-12)
    over = np.max(F[:, 1:] / [*study.optima.limits.values()] - 1.0, axis=1)
    np.testing.assert_allclose(table["excess"], np.maximum(over, 0.0), atol=1e-12)
    # No design is better but at the cost of a limit.
    assert (table["excess"][table["beyond"] < -1e-5] > 0.0).all()


def test_a_design_of_rb_is_the_least_of_what_rb_predicts(study):
    low, X = through(ss.QuarterCar(), "ms"), ss.sample({"ks": STIFFNESS, "cs": DAMPING}, 7, random_state=1).to_numpy()
    result, F = study.optima, full_car(X)
    nodes = np.stack(np.meshgrid(np.linspace(*STIFFNESS, 201), np.linspace(*DAMPING, 201)), axis=-1).reshape(-1, 2)
    nodes = np.concatenate([result.landed.loc[[("RB", 7)], ["ks", "cs"]], nodes])
    straight = {name: np.polyfit(low[name](X), y, 1) for name, y in zip(CRITERIA, F.T, strict=True)}
    predicted = {name: np.polyval(line, low[name](nodes)) for name, line in straight.items()}
    within = np.all([predicted[name] <= limit * (1.0 + 2e-6) for name, limit in result.limits.items()], axis=0)
    assert within[0]
    assert predicted["bacc"][0] <= predicted["bacc"][within].min() * (1.0 + 2e-6)


def test_enough_runs_are_so_with_every_larger_number(itself):
    index = pd.MultiIndex.from_product([["RB"], [5, 10, 25, 60]], names=["surrogate", "runs"])
    for beyond, excess, enough in (
        ([0.0, 0.0, 0.0, 0.0], 0.0, 5),
        ([0.0, -0.01, 0.0, 0.0], 0.0, 25),
        ([0.0, 0.0, 0.0, 0.01], 0.0, None),
        ([0.0, 0.0, 0.0, 0.0], 0.01, None),
    ):
        landed = pd.DataFrame({"beyond": beyond, "excess": excess}, index)
        assert optima.Optima(itself.limits, itself.best, 0.0, landed).enough() == {"RB": enough}


def test_report_and_document_show_every_design(study):
    text = ss.report(study)
    for surrogate, cells in landings(study.optima).items():
        line = next(line for line in text.splitlines() if line.startswith(f"{surrogate} ") and " / " in line)
        assert line.split()[1:] == " ".join(cells.values()).split()
        for runs, cell in cells.items():
            beyond, excess = (float(x) for x in cell.split(" / "))
            row = study.optima.landed.loc[(surrogate, runs)]
            assert (beyond, excess) == pytest.approx((100 * row.beyond, 100 * row.excess), abs=0.0051)
    document = json.loads(json.dumps(study_document(study), allow_nan=False))["optima"]
    assert document["landed"]["VB"]["7"] == study.optima.landed.loc[("VB", 7)].to_dict()
    assert document["best"] == study.optima.best.to_dict()
    assert document["limits"] == study.optima.limits


def test_a_car_of_one_s_own_on_its_own_ranges():
    car = ss.FullCar(
        mb=1600.0, ks=ss.Corners.axles(front=22e3, rear=27e3), cs=ss.Corners.axles(front=1.6e3, rear=1.9e3)
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("susp_ss.study.feasibility.RUNS", (5,))
        study = ss.feasibility_study(corner="rl", nodes=(2, 2), vehicle=car, ks=(20e3, 32e3), cs=(1.2e3, 2.8e3))
        designs = study.optima.landed
    assert designs["ks"].between(20e3, 32e3).all()
    assert designs["cs"].between(1.2e3, 2.8e3).all()
    at = designs.loc[("VB", 5)]
    springs = ss.Corners.axles(front=at.ks * 22.0 / 27.0, rear=at.ks)
    dampers = ss.Corners.axles(front=at.cs * 16.0 / 19.0, rear=at.cs)
    metrics = ss.ride_metrics(ss.FullCar(mb=1600.0, ks=springs, cs=dampers), ROAD)
    assert metrics.sws.sel(corner="rl").item() == pytest.approx(at.sws, rel=1e-9)
