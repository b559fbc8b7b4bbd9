"""The feasibility study: its fits against plain numpy, its published tables against themselves, its files."""

import json
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.optimize import nnls

import susp_ss as ss
from susp_ss.presentation import save as saving
from susp_ss.study import published
from susp_ss.study.feasibility import DAMPING, STIFFNESS, between, designs, grid
from susp_ss.study.tabulated import Tabulated

pytestmark = pytest.mark.usefixtures("few_runs")

DATA = (*saving.TABLES, saving.PAGE)
STILL = next(iter(saving.STILLS.values()))

SURROGATES, CRITERIA = ["RB", "VB", "PB"], ["bacc", "dtl", "sws"]
ROAD = ss.Road.iso8608("B", speed=20.0, tracks="isotropic")


@pytest.fixture(scope="module")
def study():
    return ss.feasibility_study(nodes=(6, 5))


def flat(study, name, criterion):
    return study.responses[name].sel(criterion=criterion).values.ravel()


def nodes(study):
    return designs(study.responses.ks, study.responses.cs)


def test_grid_spans_table_2(study):
    assert study.nodes == (6, 5)
    assert study.responses.ks.values[[0, -1]].tolist() == [12536.0, 24570.0]
    assert study.responses.cs.values[[0, -1]].tolist() == [798.0, 2235.0]


def test_responses_are_labelled(study):
    responses = study.responses
    assert list(responses) == ["lf", "hf", "RB", "VB", "PB"]
    assert responses.hf.dims == ("ks", "cs", "criterion")
    assert responses.criterion.values.tolist() == CRITERIA
    assert responses.unit.values.tolist() == ["m/s^2", "N", "m"]
    assert (responses.ks.attrs["units"], responses.cs.attrs["units"]) == ("N/m", "N s/m")


@pytest.mark.parametrize(("i", "j"), [(0, 0), (2, 4), (5, 1)])
def test_responses_are_the_metrics_of_single_cars(study, i, j):
    here = study.responses.isel(ks=i, cs=j)
    own = {"ks": float(here.ks), "cs": float(here.cs)}
    full = ss.ride_metrics(ss.FullCar(**own), ROAD).sel(point="fr", corner="fr")
    quarter = ss.ride_metrics(ss.QuarterCar(**own), ROAD)
    for criterion in CRITERIA:
        np.testing.assert_allclose(here.hf.sel(criterion=criterion), full[criterion], rtol=1e-9)
        np.testing.assert_allclose(here.lf.sel(criterion=criterion), quarter[criterion], rtol=1e-9)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_rb_and_vb_are_linear_least_squares(study, criterion):
    f, F = flat(study, "lf", criterion), flat(study, "hf", criterion)
    systems = {"RB": (np.column_stack([np.ones_like(f), f]), F)}
    systems["VB"] = (np.column_stack([np.ones_like(f), nodes(study)]), F - f)
    for surrogate, (A, target) in systems.items():
        scale = np.abs(A).max(axis=0)
        expected = np.linalg.lstsq(A / scale, target, rcond=None)[0] / scale
        ours = study.coefficients.loc[(surrogate, criterion)].dropna().to_numpy()
        np.testing.assert_allclose(ours, expected, rtol=1e-7)
        offset = f if surrogate == "VB" else 0.0
        np.testing.assert_allclose(flat(study, surrogate, criterion), A @ expected + offset, rtol=1e-9)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_pb_is_a_minimum_of_the_sum_of_squares(study, criterion):
    response = ss.Response(ss.QuarterCar(), ROAD, criterion, parameter="ms")
    F, X = flat(study, "hf", criterion), nodes(study)

    def squares(ms):
        return np.sum((response(X, ms) - F) ** 2)

    ms = study.coefficients.loc[("PB", criterion), "ms"]
    np.testing.assert_allclose(flat(study, "PB", criterion), response(X, ms), rtol=1e-12)
    coarse = min(squares(value) for value in np.geomspace(63.5, 1270.0, 40))
    assert squares(ms) <= min(coarse, squares(ms * 1.001), squares(ms / 1.001))


def test_remembered_responses_tune_the_same_mass(study):
    response, X = ss.Response(ss.QuarterCar(), ROAD, "bacc", parameter="ms"), nodes(study)
    remembered = Tabulated(response, X)
    for ms in np.geomspace(63.5, 1270.0, 17):
        np.testing.assert_allclose(remembered(X, ms), response(X, ms), rtol=1e-12)
    np.testing.assert_array_equal(remembered(X[:2], 200.0), response(X[:2], 200.0))
    direct = ss.ParameterBased(response).fit(X, flat(study, "hf", "bacc"))
    np.testing.assert_allclose(study.coefficients.loc[("PB", "bacc"), "ms"], direct.parameter_, rtol=1e-9)


def test_nonnegative_coefficients():
    study = ss.feasibility_study(nodes=(4, 4), nonnegative=True)
    assert not (study.coefficients < 0.0).any(axis=None)
    f, F = flat(study, "lf", "bacc"), flat(study, "hf", "bacc")
    expected = nnls(np.column_stack([np.ones_like(f), f]), F)[0]
    np.testing.assert_allclose(study.coefficients.loc[("RB", "bacc"), ["a0", "a1"]], expected, atol=1e-8)
    assert expected[0] == 0.0


def assert_accuracy(row, F, S):
    error = S - F
    assert pytest.approx(1.0 - error @ error / np.sum((F - F.mean()) ** 2), rel=1e-9) == row.R2
    assert pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-9) == row.RMSE
    assert pytest.approx(np.abs(error).max(), rel=1e-9) == row.MAE


def test_accuracy_at_the_nodes(study):
    assert list(study.accuracy.index) == [(s, c) for s in SURROGATES for c in CRITERIA]
    for (surrogate, criterion), row in study.accuracy.iterrows():
        assert_accuracy(row, flat(study, "hf", criterion), flat(study, surrogate, criterion))


def test_held_out_designs_are_between_the_nodes(study):
    ks, cs = grid(6, 5)
    halfway = between(ks, cs)
    assert len(halfway) == 11 * 9 - 6 * 5
    assert not {tuple(row) for row in halfway} & {tuple(row) for row in nodes(study)}
    car = ss.FullCar(ks=halfway[:, 0], cs=halfway[:, 1])
    F = ss.ride_metrics(car, ROAD).dtl.sel(corner="fr").values
    f = ss.ride_metrics(ss.QuarterCar(ks=halfway[:, 0], cs=halfway[:, 1]), ROAD).dtl.values
    a0, a1 = study.coefficients.loc[("RB", "dtl"), ["a0", "a1"]]
    assert_accuracy(study.held_out.loc[("RB", "dtl")], F, a0 + a1 * f)


def test_cost_counts_unknowns_and_designs(study):
    assert study.cost["unknowns"].tolist() == [2] * 3 + [3] * 3 + [1] * 3
    known = study.cost.dropna()
    np.testing.assert_array_equal(known["enough"] + known["saved"], 30)
    for count in (5, 10, 25):
        # No fit to other designs beats the least squares over the nodes at the nodes.
        assert (study.cost[f"RMSE_{count}"] >= study.accuracy["RMSE"] * (1.0 - 1e-9)).all()
    for key, row in study.cost.iterrows():
        near = [row[f"RMSE_{count}"] <= 1.05 * study.accuracy.loc[key, "RMSE"] for count in (5, 10, 25)]
        larger = {5: near, 10: near[1:], 25: near[2:]}
        if np.isnan(row.enough):
            assert not near[2]
        else:
            assert all(larger[int(row.enough)])


def test_roughness_scales_what_it_should(study):
    rough = ss.feasibility_study(ss.Road.iso8608("C", tracks="isotropic"), nodes=(6, 5))
    ratio = rough.coefficients / study.coefficients
    np.testing.assert_allclose(ratio.loc["RB"][["a0", "a1"]], np.tile([2.0, 1.0], (3, 1)), rtol=1e-5)
    np.testing.assert_allclose(ratio.loc["VB"][["a0", "a1", "a2"]], 2.0, rtol=1e-5)
    np.testing.assert_allclose(ratio.loc["PB"]["ms"], 1.0, rtol=1e-6)
    np.testing.assert_allclose(rough.accuracy["R2"], study.accuracy["R2"], rtol=1e-6)


def test_restricted_wheels_leave_the_quarter_car_its_road(study):
    road = ss.Road.iso8608("B", tracks="isotropic", wheels=("fr", "rr"))
    restricted = ss.feasibility_study(road, nodes=(6, 5))
    np.testing.assert_array_equal(restricted.responses.lf, study.responses.lf)
    assert not np.allclose(restricted.responses.hf, study.responses.hf, rtol=1e-3)


BAD = {
    "road": ({"road": "B"}, TypeError, "road must be a Road"),
    "roads": ({"road": ss.Road(speed=np.array([10.0, 20.0]))}, ValueError, "one speed, roughness and cutoff"),
    "warp": ({"road": ss.Road(tracks="independent", delay=False, wheels=("fr",))}, ValueError, "finite variance"),
    "corner": ({"corner": "rear"}, ValueError, "no corner named 'rear', available: fr, fl, rr, rl"),
    "no corner": ({"corner": None}, ValueError, "no corner named None"),
    "corners": ({"corner": ["fr"]}, ValueError, "no corner named"),
    "empty grid": ({"nodes": (0, 20)}, ValueError, "nodes must be two whole numbers >= 2"),
    "one node": ({"nodes": (20, 1)}, ValueError, "nodes must be two whole numbers >= 2"),
    "one number": ({"nodes": 20}, TypeError, "nodes must be two whole numbers"),
    "fractions": ({"nodes": (20.0, 20.0)}, TypeError, "nodes must be two whole numbers"),
    "three axes": ({"nodes": (3, 3, 3)}, TypeError, "nodes must be two whole numbers"),
    "text": ({"nodes": "20"}, TypeError, "nodes must be two whole numbers"),
    "no grid": ({"nodes": None}, TypeError, "nodes must be two whole numbers"),
    "nonnegative": ({"nonnegative": "yes"}, TypeError, "nonnegative must be True or False"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_refused(case):
    arguments, error, message = BAD[case]
    with pytest.raises(error) as refusal:
        ss.feasibility_study(**arguments)
    assert message in str(refusal.value)


def test_the_smallest_grid():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        study = ss.feasibility_study(nodes=(2, 2))
    assert np.isfinite(study.held_out.to_numpy()).all()


# The published tables


def test_published_tables_describe_one_high_fidelity_response():
    """RMSE / sqrt(1 - R2) is the spread of F whatever the surrogate; Table 5 divides by one node less an axis."""
    spread = published.printed_spread()
    spread.loc["PB"] /= np.sqrt(20.0 / 19.0)
    np.testing.assert_allclose(spread["bacc"], 0.1255, rtol=0.04)  # R2 = 0.9996 has one digit to go by
    np.testing.assert_allclose(spread["dtl"], 41.85, rtol=0.005)
    np.testing.assert_allclose(spread["sws"], 8.26e-4, rtol=0.005)


def test_published_frames():
    tables = published.published()
    assert list(tables.accuracy.index) == list(tables.coefficients.index)
    assert list(tables.accuracy) == ["R2", "RMSE", "MAE"]
    assert tables.accuracy.notna().all(axis=None)
    assert (tables.accuracy["MAE"] >= tables.accuracy["RMSE"]).all()
    entries = published.comparison(tables.accuracy, tables.coefficients)
    missing = entries[entries.published.isna()]
    assert list(zip(missing.surrogate, missing.criterion, missing.quantity, strict=True)) == [
        ("RB", "bacc", "a0"),
        ("VB", "bacc", "a1"),
        ("VB", "dtl", "a0"),
    ]
    assert published.usable(entries).sum() == 24 + 5 + 4 + 3
    assert (published.relative_differences(entries) == 0.0).all()


def test_agreement_is_read_off_the_numbers():
    tables = published.published()
    accuracy, coefficients = tables.accuracy.copy(), tables.coefficients.copy()
    coefficients.loc[("RB", "bacc"), ["a0", "a1"]] = [-0.5, 2.0 * 1.8149]
    coefficients.loc[("RB", "sws"), "a0"] *= -1.0
    accuracy.loc[("RB", "bacc"), "R2"] = 0.999
    line = published.agreement(published.comparison(accuracy, coefficients), "RB")
    within, further, opposite, blank, order = line.split("; ")
    assert within.startswith("within 25%: R2 BAcc DTL SWS, RMSE BAcc DTL SWS")
    assert further == "further off, as multiples of print: a1 BAcc x2"
    assert opposite == "opposite sign: a0 SWS"
    assert blank == "'-' in print, ours: a0 BAcc -0.5"
    assert order == "R2 order: BAcc > DTL > SWS, published DTL > SWS > BAcc"


def test_report_shows_ours_beside_published(study):
    text = ss.report(study)
    for table in ("Table 3. RB", "Table 4. VB", "Table 5. PB"):
        assert table in text
    line = next(line for line in text.splitlines() if line.startswith("a1"))
    ours = study.coefficients["a1"]["RB"]
    assert [float(number) for number in line.split()[1:]] == pytest.approx(
        [ours["bacc"], 1.8149, ours["dtl"], 0.7473, ours["sws"], 0.9999], rel=1e-4
    )
    assert "nothing is tuned" in text


# Files


def names(folder):
    return sorted(str(path.relative_to(folder)) for path in Path(folder).rglob("*") if path.is_file())


def test_save_writes_what_it_says(study, tmp_path):
    folder = tmp_path / "deep" / "results"
    ss.save(study, folder)
    assert names(folder) == sorted([*DATA, *saving.STILLS.values()])
    assert [path.name for path in folder.parent.iterdir()] == ["results"]
    assert folder.stat().st_mode & 0o777 == (tmp_path / "deep").stat().st_mode & 0o777

    with xr.open_dataset(folder / "responses.nc") as stored:
        xr.testing.assert_equal(stored.load(), study.responses)
        assert stored.ks.attrs["units"] == "N/m"
        assert stored.attrs["road"] == ROAD.describe()
    pd.testing.assert_frame_equal(pd.read_csv(folder / "tables.csv"), study.comparison())
    document = json.loads((folder / "tables.json").read_text())
    entry = document["tables"]["RB"]["bacc"]
    assert entry["a0"]["published"] is None
    assert entry["a0"]["ours"] == study.coefficients.loc[("RB", "bacc"), "a0"]
    assert document["tables"]["PB"]["dtl"]["ms"] == {
        "unit": "kg",
        "ours": study.coefficients.loc[("PB", "dtl"), "ms"],
        "published": 263.3,
    }
    assert document["versions"]["susp_ss"] == ss.__version__
    assert document["scenario"]["road"] == ROAD.describe()


def test_save_keeps_results_unless_forced(study, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    ss.save(study, tmp_path, figures=False)
    (tmp_path / "figures").mkdir()
    (tmp_path / STILL).write_text("old")
    (tmp_path / "tables.csv").write_text("old")
    with pytest.raises(FileExistsError, match=r"holds results already.*force=True"):
        ss.save(study, tmp_path, figures=False)
    assert (tmp_path / "tables.csv").read_text() == "old"
    ss.save(study, tmp_path, force=True, figures=False)
    assert (tmp_path / "tables.csv").read_text() != "old"
    # Neither figures of another run nor scratch files stay; what is not ours does.
    assert names(tmp_path) == sorted([*DATA, "notes.txt"])


def test_without_plotly_all_is_saved_but_the_page(study, tmp_path, missing):
    missing("plotly", loaded_by=["susp_ss.presentation.pages"])
    with pytest.warns(UserWarning, match=r"^report\.html needs plotly, .* run .*\[pages\].* files are written\)$"):
        ss.save(study, tmp_path, figures=False)
    assert names(tmp_path) == sorted({*DATA} - {"report.html"})


def test_the_responses_are_saved_for_any_netcdf_library(study, tmp_path):
    ss.save(study, tmp_path, figures=False)
    for engine in ("scipy", "netcdf4"):
        with xr.open_dataset(tmp_path / "responses.nc", engine=engine) as saved:
            xr.testing.assert_identical(saved.load(), study.responses)


def test_save_into_a_file_is_refused(study, tmp_path):
    (tmp_path / "results").write_text("mine")
    with pytest.raises(NotADirectoryError, match="is a file"):
        ss.save(study, tmp_path / "results")
    with pytest.raises(OSError, match="cannot write results to"):
        ss.save(study, tmp_path / "results" / "below")
    with pytest.raises(TypeError, match="folder must be a path, got None"):
        ss.save(study, None)
    assert names(tmp_path) == ["results"]


@pytest.mark.parametrize("existing", [False, True])
def test_a_failure_leaves_nothing_half_written(study, tmp_path, monkeypatch, existing):
    folder = tmp_path / "results"
    if existing:
        ss.save(study, folder, figures=False)
    before = {name: (folder / name).read_bytes() for name in names(folder)}

    def full(*arguments, **keywords):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    with pytest.raises(OSError, match=r"cannot write results to .*No space left"):
        ss.save(study, folder, force=True, figures=False)
    assert {name: (folder / name).read_bytes() for name in names(folder)} == before
    assert folder.exists() == existing
    assert not list(tmp_path.rglob(".susp_ss-*"))


def test_a_study_of_a_car_with_curves_is_saved_with_its_figures(tmp_path):
    car = ss.FullCar(cs=ss.DamperCurve.two_slopes(bump=800.0, rebound=2400.0))
    study = ss.feasibility_study(ss.Road.iso8608("C", speed=20.0), nodes=(3, 3), vehicle=car)
    ss.save(study, tmp_path / "results")
    assert (tmp_path / "results" / "figures" / "bode_magnitude.png").stat().st_size > 1000


def test_the_unit_of_mass_is_free():
    """A car twice as heavy on springs, dampers and tyres twice as stiff moves alike: what few designs cost as well."""
    car, cheap = ss.FullCar(), ss.QuarterCar()
    scaled = {name: 2.0 * getattr(car, name) for name in ("mb", "ixx", "iyy", "mu", "kt")}
    doubled = {name: 2.0 * getattr(cheap, name) for name in ("ms", "mu", "kt")}
    ours = ss.feasibility_study(nodes=(4, 4)).cost
    theirs = ss.feasibility_study(
        nodes=(4, 4),
        vehicle=ss.FullCar(**scaled),
        low_fidelity=ss.QuarterCar(**doubled),
        ks=tuple(2.0 * np.array(STIFFNESS)),
        cs=tuple(2.0 * np.array(DAMPING)),
    ).cost
    errors = [name for name in ours if name.startswith("RMSE")]
    for criterion, factor in (("bacc", 1.0), ("sws", 1.0), ("dtl", 2.0)):
        one, other = (cost.xs(criterion, level="criterion")[errors] for cost in (ours, theirs))
        np.testing.assert_allclose(other, factor * one, rtol=1e-4)
