"""The scan over scenarios: its distance by hand, its fits against the study, and nothing dropped."""

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.study import published, scan
from susp_ss.study.scan import scan_scenarios


@pytest.fixture(scope="module")
def small():
    """Two speeds fewer and waviness 2 alone, so that it takes seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scan, "SPEEDS", (20.0,))
        patch.setattr(scan, "CUTOFFS", (0.0,))
        patch.setattr(scan, "OTHERS", ())
        patch.setattr(scan, "ROAD_CLASSES", ("B", "C"))
        return scan_scenarios(nodes=(4, 4)).scenarios


def one(table, **factors):
    assumed = dict(zip(scan.FACTORS, scan.DEFAULT, strict=True)) | factors
    rows = table
    for name, level in assumed.items():
        rows = rows[rows[name] == level]
    assert len(rows) == 1
    return rows.iloc[0]


def distance_of(study):
    """By hand: every printed number, but for the column that is unusable."""
    squares = []
    for (surrogate, criterion), values in published.published().accuracy.join(study.published.coefficients).iterrows():
        ours = study.accuracy.join(study.coefficients).loc[(surrogate, criterion)]
        for quantity, value in values.dropna().items():
            if (surrogate, criterion) != ("VB", "sws"):
                squares.append(((ours[quantity] - value) / value) ** 2)
    assert len(squares) == 36
    return np.sqrt(np.mean(squares))


@pytest.mark.parametrize(
    ("factors", "road", "corner", "nonnegative"),
    [
        ({}, ss.Road(tracks="isotropic"), "fr", False),
        ({"road_class": "C"}, ss.Road.iso8608("C", tracks="isotropic"), "fr", False),
        ({"place": "rr", "fit": "nonnegative"}, ss.Road(tracks="isotropic"), "rr", True),
        ({"excited": "right side", "tracks": "any"}, ss.Road(wheels=("fr", "rr")), "fr", False),
        ({"tracks": "identical", "delay": "off"}, ss.Road(delay=False), "fr", False),
    ],
)
def test_the_scan_is_the_study(small, factors, road, corner, nonnegative):
    study = ss.feasibility_study(road, corner, nodes=(4, 4), nonnegative=nonnegative)
    assert one(small, **factors)["distance"] == pytest.approx(distance_of(study), rel=1e-6)


def test_cg_is_another_body_point_at_the_same_corner(small):
    X = scan.designs(*scan.grid(4, 4))
    road = ss.Road(tracks="isotropic")
    metrics = ss.ride_metrics(ss.FullCar(ks=X[:, 0], cs=X[:, 1]), road)
    f = ss.Response(ss.QuarterCar(), road, parameter="ms")
    masses = [ss.ParameterBased(f).fit(X, metrics.bacc.sel(point="cg").values).parameter_]
    study = ss.feasibility_study(nodes=(4, 4))
    masses += [study.coefficients.loc[("PB", criterion), "ms"] for criterion in ("dtl", "sws")]
    expected = np.sqrt(np.mean([(m / p - 1.0) ** 2 for m, p in zip(masses, [195.4, 263.3, 451.6], strict=True)]))
    assert one(small, place="BAcc cg, fr")["masses"] == pytest.approx(expected, rel=1e-6)


def test_parts_make_the_distance(small):
    finite = small[small.refused == ""]
    parts = 24 * finite.accuracies**2 + 9 * finite.coefficients**2 + 3 * finite.masses**2
    np.testing.assert_allclose(finite.distance, np.sqrt(parts / 36.0), rtol=1e-12)


def test_ranked_and_complete(small):
    finite, refused = small[small.refused == ""], small[small.refused != ""]
    assert finite.distance.is_monotonic_increasing
    assert list(small.index[-len(refused) :]) == list(refused.index)
    assert refused.distance.isna().all()
    assert refused.refused.str.contains("finite variance").all()
    # One axle on independent tracks, or one wheel, warps the car without bound; isotropic tracks cohere at long waves.
    combinations = set(zip(refused.excited, refused.tracks, strict=True))
    assert combinations == {("front axle", "independent"), ("front right", "any")}
    roads = 6 + 3 + 2 + 1
    assert len(small) == roads * len(scan.PLACES) * 2 * len(scan.FITS)
    assert not small[scan.FACTORS].duplicated().any()


def test_nearest_by_factor(small):
    summary = scan.Scan(small).nearest_by_factor().set_index(["factor", "level"])
    assert summary.loc[("fit", "free"), "distance"] == small[small.fit == "free"].distance.min()
    assert np.isnan(summary.loc[("excited", "front right"), "distance"])
    assert (summary.groupby("factor")["distance"].min() == small.distance.min()).all()
    assert (summary.groupby("factor")["scenarios"].sum() == len(small)).all()


def test_report_says_what_was_refused(small):
    text = ss.report(scan.Scan(small))
    assert "Nothing is tuned" in text
    assert "front right" in text
    default = one(small)
    assert f"number {default.name + 1}, at {default.distance:.3g}" in " ".join(text.split())


def test_other_waviness(monkeypatch):
    monkeypatch.setattr(scan, "SPEEDS", ())
    monkeypatch.setattr(scan, "EXCITED", {"all wheels": None})
    monkeypatch.setattr(scan, "TRACKS", ("identical",))
    table = scan_scenarios(nodes=(2, 2)).scenarios
    assert (table.waviness == 2.5).all()
    assert table.distance.notna().all()
    assert (table.refused == "").all()


def test_bad_nodes_are_refused():
    with pytest.raises(ValueError, match="nodes must be two whole numbers"):
        scan_scenarios(nodes=(1, 4))
