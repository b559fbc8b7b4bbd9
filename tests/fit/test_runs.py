"""Tables of runs: what any kind of file says is what is read, and what it may not say is refused at its place."""

import csv
import io
import re
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from hypothesis import assume, given
from hypothesis import strategies as st

from susp_ss.fit.runs import read_runs
from susp_ss.quantities import HANDLING, KNOWN, STEERED, UNITS
from susp_ss.written import decoded, number, readings

INPUTS, OUTPUTS = {"ks": "K_S", "cs": "C_S"}, {"bacc": "acc", "sws": "travel"}

TABLE = pd.DataFrame(
    {
        "K_S": [18000.0, 20000.0, 18000.0, 22500.0],
        "C_S": [1200.0, 1500.0, 1800.0, 1000.0],
        "acc": [0.61, 0.72, 0.7, 0.66],
        "travel": [0.008, 0.0075, 0.007, 0.0085],
    }
)


@pytest.fixture
def write(tmp_path, monkeypatch):
    """Write a file in a folder of its own and go there, so that messages name the file alone."""
    monkeypatch.chdir(tmp_path)

    def written(content, name="runs.csv"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return name

    return written


@pytest.fixture
def refusal(write):
    def refused(content, inputs=INPUTS, outputs=OUTPUTS, units=None, name="runs.csv"):
        with pytest.raises(ValueError, match=r".") as error:
            read_runs(write(content, name), inputs, outputs, units)
        assert "\n" not in str(error.value)
        return str(error.value)

    return refused


def as_file(table, path, units=None, engine="netcdf4"):
    """Write a table as the kind of file that the path's suffix names; NetCDF of version 3 by scipy, 4 by netCDF4."""
    if path.suffix == ".parquet":
        table.to_parquet(path)
    elif path.suffix == ".xlsx":
        table.to_excel(path, index=False)
    elif path.suffix == ".nc":
        data = table.rename_axis("run").to_xarray()
        for column, unit in (units or {}).items():
            data[column].attrs["units"] = unit
        data.to_netcdf(path, engine=engine)
    else:
        table.to_csv(path, index=False, sep="\t" if path.suffix == ".tsv" else ",")
    return path


def assert_same(runs, other):
    pd.testing.assert_frame_equal(runs.designs, other.designs, check_exact=True)
    pd.testing.assert_frame_equal(runs.responses, other.responses, check_exact=True)
    assert runs.units == other.units


# What is read


@pytest.mark.parametrize("suffix", [".csv", ".txt", ".tsv", ".CSV", ".xlsx", ".parquet", ".nc"])
def test_every_kind_of_file_gives_the_same_runs(suffix, tmp_path):
    path = as_file(TABLE.assign(comment="none"), tmp_path / f"runs{suffix}")
    runs = read_runs(path, INPUTS, OUTPUTS)
    assert runs.designs.to_dict("list") == {"ks": TABLE["K_S"].tolist(), "cs": TABLE["C_S"].tolist()}
    assert runs.responses.to_dict("list") == {"bacc": TABLE["acc"].tolist(), "sws": TABLE["travel"].tolist()}
    assert runs.units == {"ks": "N/m", "cs": "N s/m", "bacc": "m/s^2", "sws": "m"}
    in_rows = suffix in (".parquet", ".nc")
    assert runs.rows.tolist() == ([1, 2, 3, 4] if in_rows else [2, 3, 4, 5])
    where = "row 3" if in_rows else "row 4" if suffix == ".xlsx" else "line 4"
    assert runs.place(2, "bacc") == f"{path}, {where}, column 'acc'"
    assert runs.path == path


STATED = {"K_S": "N/mm", "C_S": "kN s/m", "acc": "g", "travel": "mm"}
BY_NAME = {name: STATED[column] for name, column in (INPUTS | OUTPUTS).items()}


def test_a_row_an_option_and_an_attribute_state_the_same_units(tmp_path):
    plain, parquet = as_file(TABLE, tmp_path / "plain.csv"), as_file(TABLE, tmp_path / "runs.parquet")
    with_row = tmp_path / "row.csv"
    header, *lines = plain.read_text().splitlines()
    with_row.write_text("\n".join([header, ",".join(STATED.values()), *lines]))
    with_attrs = as_file(TABLE, tmp_path / "runs.nc", STATED)
    by_row = read_runs(with_row, INPUTS, OUTPUTS)
    for path, units in ((plain, BY_NAME), (with_attrs, None), (parquet, BY_NAME)):
        assert_same(read_runs(path, INPUTS, OUTPUTS, units), by_row)
    factors = {"ks": 1e3, "cs": 1e3, "bacc": 9.80665, "sws": 1e-3}
    for name, column in (INPUTS | OUTPUTS).items():
        read = (by_row.designs if name in INPUTS else by_row.responses)[name]
        np.testing.assert_array_equal(read, TABLE[column] * factors[name])
    assert by_row.rows.tolist() == [3, 4, 5, 6]
    assert by_row.units == {"ks": "N/m", "cs": "N s/m", "bacc": "m/s^2", "sws": "m"}


@pytest.mark.parametrize("name", ["row.csv", "runs.nc"])
def test_an_option_overrides_the_file_even_where_the_file_is_wrong(name, tmp_path):
    path = tmp_path / name
    if name == "row.csv":
        path.write_text("K_S,acc\nmm,g\n18,0.6\n20,0.7\n")
    else:
        as_file(pd.DataFrame({"K_S": [18, 20], "acc": [0.6, 0.7]}), path, {"K_S": "mm", "acc": "g"})
    runs = read_runs(path, {"ks": "K_S"}, {"bacc": "acc"}, {"ks": "kN/m", "bacc": "m/s^2"})
    assert runs.designs.ks.tolist() == [18000.0, 20000.0]
    assert runs.responses.bacc.tolist() == [0.6, 0.7]


@pytest.mark.parametrize(
    ("name", "spelt", "si"),
    [
        *(("cs", spelt, 1.0) for spelt in ("N s/m", "N.s/m", "N*s/m", "Ns/m", "N-s/m", "N·s/m", "N / (m/s)", "[Ns/m]")),
        *(("cs_rear", spelt, 1000.0) for spelt in ("N s/mm", "N-s/mm", "N/(mm/s)", "kN.s/m")),
        *(("bacc_cg", spelt, 1.0) for spelt in ("m/s²", "m/s2", "m/s^2", "(m/s^2)")),
        *(("iyy", spelt, 1.0) for spelt in ("kg m²", "kg m^2", "kgm2", "kg*m^2", "kg.m2")),
        ("bacc", "mm/s²", 1e-3),
        ("bacc", "g", 9.80665),
        ("ks_fr", "N/mm", 1000.0),
        ("arb_front", "kN/m", 1000.0),
        ("mb", "t", 1000.0),
        ("a", "cm", 0.01),
        ("sws_rr", "mm", 0.001),
        ("dtl", "kN", 1000.0),
        ("pitch_acc", "deg/s^2", np.pi / 180.0),
        ("roll_acc", "rad/s2", 1.0),
        ("damper_power_fl", "kW", 1000.0),
        ("speed", "km/h", 1.0 / 3.6),
        ("roughness", "m³", 1.0),
        ("cutoff", "cycle/m", 1.0),
    ],
)
def test_units(name, spelt, si, write):
    table = f"run,x,y\n,{spelt},\n1,2,3\n2,4,5\n"
    runs = read_runs(write(table), {name: "x"}, {"result": "y"})
    np.testing.assert_allclose(runs.designs[name], [2.0 * si, 4.0 * si], rtol=1e-15)


def test_every_quantity_may_be_in_its_si_unit():
    units = {quantity.unit for table in (KNOWN, STEERED, HANDLING) for quantity in table.values()}
    assert units - {""} == set(UNITS) - {"s", "Hz"}
    assert all(known[unit] == 1.0 for unit, known in UNITS.items())


def test_an_unknown_name_is_taken_as_it_is(write):
    table = "gap,ks_driver,acc\nbar,,g\n-3,-1,0.6\n2,0,0.7\n"
    runs = read_runs(write(table), {"gap": "gap", "ks_driver": "ks_driver"}, {"bacc": "acc"})
    assert runs.designs.to_dict("list") == {"gap": [-3.0, 2.0], "ks_driver": [-1.0, 0.0]}
    assert runs.units == {"gap": "bar", "ks_driver": "", "bacc": "m/s^2"}
    table = table.replace("bar,,g\n", "")
    assert read_runs(write(table), {"gap": "gap"}, {"bacc": "acc"}, {"gap": "psi"}).units["gap"] == "psi"


@pytest.mark.parametrize("unit", ["s", "days since 2021-01-01"])
def test_a_netcdf_time_is_a_number_in_the_unit_stated(unit, tmp_path):
    path = as_file(TABLE.assign(lag=[0.1, 0.2, 0.3, 0.4]), tmp_path / "runs.nc", {"lag": unit})
    runs = read_runs(path, {"lag": "lag"}, OUTPUTS)
    assert runs.designs["lag"].tolist() == [0.1, 0.2, 0.3, 0.4]
    assert runs.units["lag"] == unit


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("K_S,acc\n18,0.6\n20,0.7\n", [2, 3]),
        ("K_S;acc\r\n18;0.6\r\n20;0.7\r\n", [2, 3]),
        ("K_S\tacc\r18\t0.6\r20\t0.7", [2, 3]),
        ("\ufeffK_S,acc\n18,0.6\n20,0.7\n", [2, 3]),
        ('# solver 3, "run" of May\n\nK_S,acc\n# soft\n18,0.6\n\n20,0.7\n\n,\n', [5, 7]),
        ('"K_S";"acc";"a;b, c"\n"18";"0.6";"x;y"\n20;0.7;\n', [2, 3]),
        ('K_S, acc, "long\nname"\n 18 , .6, 1\n+2.e1, 7E-1, 2\n', [3, 4]),
    ],
)
def test_ways_to_write_text(text, rows, write):
    runs = read_runs(write(text), {"ks": "K_S"}, {"bacc": "acc"})
    assert runs.designs.ks.tolist() == [18.0, 20.0]
    assert runs.responses.bacc.tolist() == [0.6, 0.7]
    assert runs.rows.tolist() == rows


def test_equal_runs_of_one_design_are_kept(write):
    runs = read_runs(write("K_S,acc\n18,0.6\n20,0.7\n18,0.60\n"), {"ks": "K_S"}, {"bacc": "acc"})
    assert runs.designs.ks.tolist() == [18.0, 20.0, 18.0]


@pytest.mark.parametrize("order", [("ks", "cs"), ("cs", "ks")])
def test_a_grid_is_as_many_runs_as_nodes(order, tmp_path):
    ks, cs = [15e3, 18e3, 21e3], [1000.0, 2000.0]
    acc = xr.DataArray([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], dims=("ks", "cs"), coords={"ks": ks, "cs": cs})
    path = tmp_path / "grid.nc"
    acc.transpose(*order).to_dataset(name="acc").to_netcdf(path)
    runs = read_runs(path, {"ks": "ks", "cs": "cs"}, {"bacc": "acc"})
    assert runs.rows.tolist() == [1, 2, 3, 4, 5, 6]
    for (_, design), response in zip(runs.designs.iterrows(), runs.responses.bacc, strict=True):
        assert response == acc.sel(ks=design.ks, cs=design.cs)


def test_parquet_of_other_types(tmp_path):
    from decimal import Decimal

    table = pd.DataFrame({"K.S": [18, 20], "acc": [Decimal("0.5"), Decimal("0.75")], "y": np.float32([0.5, 0.25])})
    table.to_parquet(tmp_path / "runs.parquet")
    runs = read_runs(tmp_path / "runs.parquet", {"ks": "K.S"}, {"bacc": "acc", "sws": "y"})
    assert runs.designs.ks.tolist() == [18.0, 20.0]
    assert runs.responses.to_dict("list") == {"bacc": [0.5, 0.75], "sws": [0.5, 0.25]}


names = st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"]), min_size=1, max_size=6)


@given(data=st.data())
def test_numbers_survive(data, tmp_path_factory):
    """Any table, by the csv module or pandas, any delimiter and units: each number to an ulp of number times factor."""
    kinds = data.draw(st.permutations(["ks", "cs_rear", "speed", "bacc_fr", "sws", "dtl", "pitch_acc"]))
    m = data.draw(st.integers(2, len(kinds)))
    header = data.draw(st.lists(names, min_size=m + 1, max_size=m + 1, unique=True))
    assume(not header[0].startswith("#"))
    n = data.draw(st.integers(2, 6))
    positive = st.floats(1e-200, 1e200)
    columns = [data.draw(st.lists(positive, min_size=n, max_size=n, unique=True)) for _ in kinds[:m]]
    kind_of = {"ks": "N/m", "cs_rear": "N s/m", "speed": "m/s", "bacc_fr": "m/s^2", "sws": "m", "dtl": "N"}
    si = [kind_of.get(name, "rad/s^2") for name in kinds[:m]]
    units = [data.draw(st.sampled_from(sorted(UNITS[unit]))) for unit in si]
    delimiter = data.draw(st.sampled_from([",", ";", "\t"]))
    earlier = {",": ";\t", ";": "\t", "\t": ""}[delimiter]
    assume(not any(mark in name for name in header for mark in earlier + '"'))
    path = tmp_path_factory.mktemp("runs") / "runs.csv"
    rows = [[*row, "note"] for row in zip(*columns, strict=True)]
    by_row = data.draw(st.booleans())
    if data.draw(st.booleans()):
        pd.DataFrame([[*units, ""]] * by_row + rows, columns=header).to_csv(path, sep=delimiter, index=False)
    else:
        with path.open("w", newline="", encoding="utf-8") as file:
            quoting = data.draw(st.sampled_from([csv.QUOTE_MINIMAL, csv.QUOTE_ALL]))
            csv.writer(file, delimiter=delimiter, quoting=quoting).writerows([header, *[[*units, ""]] * by_row, *rows])
    asked = dict(zip(kinds[:m], header, strict=False))
    inputs, outputs = dict(list(asked.items())[:1]), dict(list(asked.items())[1:])
    given = None if by_row else dict(zip(kinds[:m], units, strict=True))
    runs = read_runs(path, inputs, outputs, given, decimal=".")
    assert runs.rows.tolist() == list(range(2 + by_row, 2 + by_row + n))
    for name, written, unit, of in zip(kinds[:m], columns, units, si, strict=True):
        read = (runs.designs if name in inputs else runs.responses)[name]
        for value, there in zip(read, written, strict=True):
            exact = Fraction(there) * Fraction(UNITS[of][unit])
            assert abs(Fraction(float(value)) - exact) <= Fraction(float(np.spacing(value)))


# As people's programs write it

GERMAN = "run;K_S;C_S;acc;travel\n;N/mm;;m/s²;mm\n1;18,5;1.200;0,61;8\n2;20;1.500;0,72;7,5\n"


@pytest.mark.parametrize(
    ("raw", "noted"),
    [
        (GERMAN.encode(), ""),
        (GERMAN.encode("cp1252"), "read as Latin-1 (Windows-1252), "),
        (GERMAN.encode("utf-8-sig"), ""),
        (GERMAN.encode("utf-16"), "read as UTF-16, "),
        (GERMAN.encode("utf-16-le"), "read as UTF-16, "),
        (GERMAN.encode("utf-16-be"), "read as UTF-16, "),
        (b"sep=;\r\n" + GERMAN.replace("\n", "\r\n").encode(), ""),
    ],
)
def test_a_german_table_in_any_encoding(raw, noted, write):
    runs = read_runs(write(raw), INPUTS, OUTPUTS)
    assert runs.designs.to_dict("list") == {"ks": [18500.0, 20000.0], "cs": [1200.0, 1500.0]}
    np.testing.assert_allclose(runs.responses.sws, [0.008, 0.0075], rtol=1e-15)
    units = "ks in N/mm, bacc in m/s², sws in mm"
    assert runs.noted == f"runs.csv: {noted}cells between semicolons, decimal commas, {units}"


def test_a_decimal_sign_that_no_cell_shows_may_be_said(write):
    text = "K_S;acc\n18.500;1.200\n20.000;1.300\n"
    for decimal, ks in ((".", [18.5, 20.0]), (",", [18500.0, 20000.0])):
        assert read_runs(write(text), {"ks": "K_S"}, {"bacc": "acc"}, decimal=decimal).designs.ks.tolist() == ks
    assert read_runs(write(text.replace(";", ",")), {"ks": "K_S"}, {"bacc": "acc"}).designs.ks.tolist() == [18.5, 20.0]
    with pytest.raises(ValueError, match=r'decimal must be "." or ",", got \'comma\''):
        read_runs(write(text), {"ks": "K_S"}, {"bacc": "acc"}, decimal="comma")


@given(
    value=st.decimals(-(10**9), 10**9, places=4),
    places=st.integers(0, 4),
    sign=st.sampled_from([".", ","]),
    by=st.sampled_from(["", " ", "'", "\u00a0", "\u202f", "other"]),
)
def test_numbers_in_the_habits_of_several_countries(value, places, sign, by):
    by = {"other": "," if sign == "." else "."}.get(by, by)
    written = f"{value:,.{places}f}".replace(",", "_").replace(".", sign).replace("_", by)
    assert number(written, sign) == float(f"{value:.{places}f}")
    # Only groups of three behind one kind of sign can be read two ways.
    for misread in readings(written).values():
        assert misread == number(written, sign) or re.fullmatch(r"-?[1-9][0-9]{0,2}([.,][0-9]{3})+", written)


@pytest.mark.parametrize("header", ["ks [N/mm],acc", "Ks (N/mm),acc", "KS[N / mm],acc"])
def test_a_columns_name_may_state_its_unit(header, write):
    runs = read_runs(write(f"{header}\n18.5,0.6\n20,0.7\n"), {"ks": "ks"}, {"bacc": "acc"})
    assert runs.designs.ks.tolist() == [18500.0, 20000.0]
    assert runs.columns["ks"] == header.split(",")[0]
    assert runs.noted == f"runs.csv: ks in {header.partition(',')[0][2:].strip(' [()]')}"
    over = read_runs(write(f"{header}\n18.5,0.6\n20,0.7\n"), {"ks": "ks"}, {"bacc": "acc"}, {"ks": "N/m"})
    assert over.designs.ks.tolist() == [18.5, 20.0]


def test_another_case_is_forgiven_to_names_of_ours_alone(write, refusal):
    text = "Ks,ACC\n18,0.6\n20,0.7\n"
    assert read_runs(write(text), {"ks": "ks"}, {"bacc": "ACC"}).designs.ks.tolist() == [18.0, 20.0]
    assert "no column 'acc', did you mean 'ACC'?" in refusal(text, {"ks": "ks"}, {"bacc": "acc"})


def workbook(path, **sheets):
    import openpyxl

    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def test_excel(tmp_path):
    header = ["run", "Ks [N/mm]", "acc", "travel"]
    rows = [["Project X, May"], [], header, ["", "", "m/s²", "mm"], [1, 18.5, 0.61, 8], [2, "20,5", 0.72, 7.5]]
    path = workbook(tmp_path / "runs.xlsx", Notes=[["nothing here"]], Runs=rows)
    runs = read_runs(path, {"ks": "ks"}, OUTPUTS)
    assert runs.designs.ks.tolist() == [18500.0, 20500.0]
    np.testing.assert_allclose(runs.responses.sws, [0.008, 0.0075], rtol=1e-15)
    assert runs.place(0, "ks") == f"{path}, row 5, column 'Ks [N/mm]'"
    assert runs.noted == f"{path}: sheet 'Runs', decimal commas, ks in N/mm, bacc in m/s², sws in mm"
    both = workbook(tmp_path / "both.xlsx", A=rows, B=[header, *[[*row[:2], 9.0, 9.0] for row in rows[4:]]])
    with pytest.raises(ValueError, match=r"both\.xlsx: the sheets 'A', 'B' have these columns; say which by sheet"):
        read_runs(both, {"ks": "ks"}, OUTPUTS)
    assert read_runs(both, {"ks": "ks"}, OUTPUTS, sheet="B").responses.bacc.tolist() == [9.0, 9.0]


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([], "runs.xlsx: no header, the sheets have no cells"),
        ([["K_S", "acc"]], "runs.xlsx: no runs, only column names"),
        ([["k", "acc"], [1, 2]], "runs.xlsx, sheet 'S', row 1: no column 'K_S', available: 'k', 'acc'"),
        ([["K_S", "acc"], [1, None], [2, 3]], "runs.xlsx, row 2, column 'acc': bacc needs a number, got an empty cell"),
        ([["K_S", "acc"], [1, True], [2, 3]], "runs.xlsx, row 2, column 'acc': bacc needs a number, got True"),
        ([["K_S", "acc"], [1, "x"], [2, 3]], "runs.xlsx, row 2, column 'acc': bacc needs a number, got 'x'"),
    ],
)
def test_excel_is_refused_at_its_place(rows, expected, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    workbook("runs.xlsx", S=rows)
    with pytest.raises(ValueError, match=r".") as error:
        read_runs("runs.xlsx", {"ks": "K_S"}, {"bacc": "acc"})
    assert str(error.value) == expected


def test_matlab(tmp_path):
    from scipy.io import savemat

    columns = {"K_S": np.array([[18.5], [20.0]]), "acc": [0.6, 0.7], "travel": [0.008, 0.007]}
    savemat(tmp_path / "vectors.mat", {**columns, "note": "rig"})
    savemat(tmp_path / "struct.mat", {"T": columns, "other": np.eye(3)})
    for name, noted in (("vectors.mat", ""), ("struct.mat", "struct 'T', ")):
        path = tmp_path / name
        runs = read_runs(path, {"ks": "K_S"}, OUTPUTS, {"ks": "N/mm"})
        assert runs.designs.ks.tolist() == [18500.0, 20000.0]
        assert runs.place(1, "sws") == f"{path}, row 2, column 'travel'"
        assert runs.noted == (f"{path}: {noted.rstrip(', ')}" if noted else "")
    savemat(tmp_path / "uneven.mat", {**columns, "acc": [1.0, 2.0, 3.0]})
    with pytest.raises(ValueError, match=r"uneven.mat, column 'acc': needs as many numbers as 'K_S', got shape \(3,\)"):
        read_runs(tmp_path / "uneven.mat", {"ks": "K_S"}, OUTPUTS)
    with pytest.raises(ValueError, match=r"struct\.mat: no column 'kt', available: 'K_S', 'acc', 'travel'"):
        read_runs(tmp_path / "struct.mat", {"kt": "kt"}, OUTPUTS)


# What is refused

HEADER = "K_S,C_S,acc,travel\n"
GOOD = "18,1.2,0.6,8\n20,1.5,0.7,7\n"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "runs.csv: no header, the file has no text"),
        ("\n# nothing\n ,\n", "runs.csv: no header, the file has no text"),
        (HEADER, "runs.csv: no runs, only column names"),
        (HEADER + "N/m,,g,mm\n", "runs.csv: no runs, only column names"),
        (
            "k_s,C_S,acc,travel\n" + GOOD,
            "runs.csv, line 1: no column 'K_S', did you mean 'k_s'? available: 'k_s', 'C_S', 'acc', 'travel'",
        ),
        ("# x\nK_S,C_S,acc,z\n" + GOOD, "runs.csv, line 2: no column 'travel', available: 'K_S', 'C_S', 'acc', 'z'"),
        ("K_S,K_S,C_S,acc,travel\n1,1,1,1,1\n", "runs.csv, line 1: 2 columns are named 'K_S'"),
        (HEADER + GOOD + "\n22,1.6,0.8\n", "runs.csv, line 5: needs 4 cells as the header has, got 3"),
        (HEADER + "12,5,1,2,0,6,8\n", "runs.csv, line 2: needs 4 cells as the header has, got 7"),
        (HEADER + GOOD + "22,1.6,crash,8\n", "runs.csv, line 4, column 'acc': bacc needs a number, got 'crash'"),
        (HEADER + "22,1.6,crash,8\n", "runs.csv, line 2, column 'acc': bacc needs a number, got 'crash'"),
        (HEADER + "1_8,1.2,0.6,8\n", "runs.csv, line 2, column 'K_S': ks needs a number, got '1_8'"),
        (HEADER + "١٨,1.2,0.6,8\n", "runs.csv, line 2, column 'K_S': ks needs a number, got '١٨'"),
        (HEADER + GOOD + "22,,0.7,8\n", "runs.csv, line 4, column 'C_S': cs needs a number, got an empty cell"),
        (HEADER + "22,1.6,nan,8\n", "runs.csv, line 2, column 'acc': bacc must be finite and >= 0, got nan"),
        (HEADER + GOOD + "22,-INF,1,8\n", "runs.csv, line 4, column 'C_S': cs must be finite and >= 0, got -INF"),
        (HEADER + GOOD + "1e999,1,1,8\n", "runs.csv, line 4, column 'K_S': ks must be finite and > 0, got 1e999"),
        (HEADER + "kN/m,,,\n1e307,1,1,8\n", "runs.csv, line 3, column 'K_S': ks must be finite and > 0, got 1e307"),
        (HEADER + GOOD + "0,1.6,0.6,8\n", "runs.csv, line 4, column 'K_S': ks must be finite and > 0, got 0"),
        (HEADER + "18,-1,0.6,8\n", "runs.csv, line 2, column 'C_S': cs must be finite and >= 0, got -1"),
        (HEADER + "18,1,0.6,-8e-3\n", "runs.csv, line 2, column 'travel': sws must be finite and >= 0, got -8e-3"),
        (HEADER + "0,1,,x\n", "runs.csv, line 2, column 'K_S': ks must be finite and > 0, got 0"),
        (
            "K_S;C_S;acc;travel\n12,5;1;2;3\n13;1;2;0.3\n",
            "runs.csv, line 2, column 'K_S': 12,5 is written with a decimal comma, but runs.csv, line 3, column "
            "'travel' has a decimal point: 0.3",
        ),
        (
            "K_S;C_S;acc;travel\n12.500;1;2;3\n13;1;2;3\n",
            "runs.csv, line 2, column 'K_S': 12.500 may be 12.5 or 12500, and no other cell tells; say decimal=\".\" "
            'or ","',
        ),
        (
            "K_S [kN/m],C_S,acc,travel\nN/mm,,,\n" + GOOD,
            "runs.csv, line 2, column 'K_S [kN/m]': the column's name says kN/m, got 'N/mm'",
        ),
        (
            "K_S [kN/m],K_S (N/m),C_S,acc,travel\n1,1,1,1,1\n",
            "runs.csv, line 1: 2 columns may be 'K_S': 'K_S (N/m)', 'K_S [kN/m]'",
        ),
        (
            HEADER + "N/mm,1.2,g,mm\n" + GOOD,
            "runs.csv, line 2, column 'C_S': needs a unit, one of N s/m, N s/mm, kN s/m, lbf s/in, or nothing, as "
            "column 'K_S' of this line has the unit 'N/mm', got '1.2'",
        ),
        (
            HEADER + "N/mm,,g,furlong\n" + GOOD,
            "runs.csv, line 2, column 'travel': needs a unit, one of m, mm, cm, in, ft, km, or nothing, as column "
            "'K_S' of this line has the unit 'N/mm', got 'furlong'",
        ),
        (
            HEADER + "N/mm,N/mm,g,mm\n" + GOOD,
            "runs.csv, line 2, column 'C_S': cs is in one of N s/m, N s/mm, kN s/m, lbf s/in, got 'N/mm'",
        ),
        (
            HEADER + "kN/m,,,\n18,1,0.6,8\n18,1.5,0.7,7\n",
            "runs.csv, column 'K_S': an input must vary, got ks = 18000.0 N/m in all runs",
        ),
        (HEADER + '18,"1\n', "runs.csv, line 2: not a line of cells: unexpected end of data"),
        (HEADER + GOOD + '18,"1"2,3,4\n', "runs.csv, line 4: not a line of cells: ',' expected after '\"'"),
        ((HEADER + GOOD).encode() + b"22,\xb2", "runs.csv, line 4: needs 4 cells as the header has, got 2"),
        (b"\xff\xfe" + b"K_S", "runs.csv: not UTF-16 text, as its first bytes say (at byte 4)"),
        (b"\xef\xbb\xbfK_S,\xb2", "runs.csv: not UTF-8 text, as its first bytes say (at byte 4)"),
    ],
)
def test_text_is_refused_at_its_place(text, expected, refusal):
    assert refusal(text) == expected


@pytest.mark.parametrize(
    ("inputs", "outputs", "units", "expected"),
    [
        ({}, OUTPUTS, {}, "inputs must name at least one column, got none"),
        (INPUTS, {}, {}, "outputs must name at least one column, got none"),
        ({"ks": "K_S", "kt": "K_S"}, OUTPUTS, {}, "column 'K_S' is asked for twice, as ks and as kt"),
        (INPUTS, {"bacc": "K_S"}, {}, "column 'K_S' is asked for twice, as ks and as bacc"),
        (INPUTS, {"ks": "acc"}, {}, "ks is asked for as an input and as an output"),
        (
            INPUTS,
            OUTPUTS,
            {"kt": "N/m"},
            "units: no input or output named 'kt', available: ks, cs, bacc, sws, K_S, C_S, acc, travel",
        ),
        (INPUTS, OUTPUTS, {"cs": "N/mm"}, "units of cs: cs is in one of N s/m, N s/mm, kN s/m, lbf s/in, got 'N/mm'"),
        (INPUTS, OUTPUTS, {"ks": ""}, "units of ks: ks is in one of N/m, N/mm, kN/m, lbf/in, got ''"),
    ],
)
def test_what_is_asked_is_refused(inputs, outputs, units, expected, refusal):
    assert refusal(HEADER + GOOD, inputs, outputs, units) == expected


@pytest.mark.parametrize("name", ["runs.xls", "runs"])
def test_an_unknown_suffix_is_refused(name, refusal):
    got = "'.xls'" if name == "runs.xls" else "'no suffix'"
    kinds = ".csv, .txt, .tsv, .xlsx, .xlsm, .parquet, .nc, .mat"
    assert refusal(HEADER + GOOD, name=name) == f"{name}: runs are read from {kinds} files, got {got}"


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".nc"])
def test_a_missing_file_and_a_folder_speak_for_themselves(suffix, tmp_path):
    with pytest.raises(FileNotFoundError, match=rf"missing{suffix}"):
        read_runs(tmp_path / f"missing{suffix}", INPUTS, OUTPUTS)
    folder = tmp_path / f"folder{suffix}"
    folder.mkdir()
    with pytest.raises(IsADirectoryError, match=rf"folder{suffix}"):
        read_runs(folder, INPUTS, OUTPUTS)


@pytest.mark.parametrize("suffix", [".parquet", ".nc"])
@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"acc": [0.6, np.inf, 0.7, 0.8]}, "row 2, column 'acc': bacc must be finite and >= 0, got inf"),
        ({"K_S": [1.0, 2.0, 0.0, 3.0]}, "row 3, column 'K_S': ks must be finite and > 0, got 0.0"),
        ({"C_S": ["1", "2", "3", "soft"]}, "row 4, column 'C_S': cs needs a number, got 'soft'"),
        ({"K_S": [5.0] * 4}, "column 'K_S': an input must vary, got ks = 5.0 N/m in all runs"),
    ],
)
def test_rows_are_refused_at_their_place(suffix, change, expected, tmp_path):
    path = as_file(TABLE.assign(**change), tmp_path / f"runs{suffix}")
    with pytest.raises(ValueError, match=r".") as error:
        read_runs(path, INPUTS, OUTPUTS)
    assert str(error.value) == f"{path}, {expected}"


@pytest.mark.parametrize("suffix", [".parquet", ".nc"])
def test_columns_of_binary_files_are_refused_by_name(suffix, tmp_path):
    path = as_file(TABLE.rename(columns={"K_S": "ks"}), tmp_path / f"runs{suffix}")
    with pytest.raises(ValueError, match=r"runs\.\w+: no column 'K_S', did you mean 'ks'\? available: "):
        read_runs(path, INPUTS, OUTPUTS)
    empty = as_file(TABLE.iloc[:0], tmp_path / f"empty{suffix}")
    with pytest.raises(ValueError, match=r"empty\.\w+: no runs, only column names"):
        read_runs(empty, INPUTS, OUTPUTS)


def test_parquet_refuses_nothing_where_a_number_should_be(tmp_path):
    path = tmp_path / "runs.parquet"
    TABLE.assign(acc=pd.array([0.6, None, 0.7, 0.8], dtype=object), K_S=[True, False, True, False]).to_parquet(path)
    with pytest.raises(ValueError, match=r"row 2, column 'acc': bacc needs a number, got an empty cell"):
        read_runs(path, {"cs": "C_S"}, OUTPUTS)
    with pytest.raises(ValueError, match=r"row 1, column 'K_S': ks needs a number, got True"):
        read_runs(path, INPUTS, OUTPUTS)


def test_a_hole_in_a_netcdf_grid_is_refused_at_its_row(tmp_path):
    grid = xr.Dataset({"acc": (("K_S", "C_S"), [[1.0, 2.0], [3.0, np.nan]])}, {"K_S": [1.0, 2.0], "C_S": [3.0, 4.0]})
    grid.to_netcdf(tmp_path / "grid.nc")
    with pytest.raises(ValueError, match=r"grid\.nc, row 4, column 'acc': bacc must be finite and >= 0, got nan"):
        read_runs(tmp_path / "grid.nc", INPUTS, {"bacc": "acc"})


def test_netcdf_refuses_a_unit_of_another_kind_and_outputs_of_other_dims(tmp_path):
    path = as_file(TABLE, tmp_path / "runs.nc", {"C_S": "N/mm"})
    with pytest.raises(ValueError, match=r"runs\.nc, column 'C_S': cs is in one of N s/m, .*, lbf s/in, got 'N/mm'"):
        read_runs(path, INPUTS, OUTPUTS)
    grid = xr.Dataset({"acc": (("K_S", "point"), np.ones((2, 3)))}, {"K_S": [1.0, 2.0]})
    grid.to_netcdf(tmp_path / "points.nc")
    with pytest.raises(
        ValueError, match=r"column 'acc': bacc must be on the dims of the inputs, \(K_S\), got \(K_S, point\)"
    ):
        read_runs(tmp_path / "points.nc", {"ks": "K_S"}, {"bacc": "acc"})


@pytest.mark.parametrize(
    ("suffix", "kind", "engine"),
    [
        (".parquet", "Parquet", None),
        (".nc", "NetCDF", "netcdf4"),
        (".nc", "NetCDF", "scipy"),
        (".xlsx", "Excel", None),
    ],
)
@pytest.mark.parametrize("kept", [0.0, 0.001, 0.1, 0.3, 0.5, 0.7, 0.9, 0.999])
def test_a_truncated_file_is_refused(suffix, kind, engine, kept, tmp_path):
    path = as_file(TABLE, tmp_path / f"runs{suffix}", engine=engine)
    raw = path.read_bytes()
    path.write_bytes(raw[: int(kept * len(raw))])
    with pytest.raises(ValueError, match=rf"runs{suffix}: not a readable {kind} file: .") as error:
        read_runs(path, INPUTS, OUTPUTS)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("suffix", "library", "extra"),
    [("parquet", "pyarrow", "parquet"), ("nc", "netCDF4", "netcdf"), ("xlsx", "openpyxl", "excel")],
)
def test_without_a_library_one_line_says_how_to_get_it(suffix, library, extra, tmp_path, missing):
    path = as_file(TABLE, tmp_path / f"runs.{suffix}")
    missing(library)
    said = rf"runs\.{suffix}: .* needs {library}, which is not installed; run .* -m pip install .*\[{extra}\]"
    with pytest.raises(ModuleNotFoundError, match=said) as error:
        read_runs(path, INPUTS, OUTPUTS)
    assert "\n" not in str(error.value)


def test_netcdf_of_version_3_needs_no_more_than_scipy(tmp_path, missing):
    path = as_file(TABLE, tmp_path / "runs.nc", {"K_S": "N/mm"}, engine="scipy")
    expected = read_runs(as_file(TABLE, tmp_path / "four.nc", {"K_S": "N/mm"}), INPUTS, OUTPUTS)
    missing("netCDF4")
    runs = read_runs(path, INPUTS, OUTPUTS)
    pd.testing.assert_frame_equal(runs.designs, expected.designs)
    pd.testing.assert_frame_equal(runs.responses, expected.responses)


like_a_table = st.text(st.sampled_from(list('018.eE+-_,;\t\r\n "#KSacgmN/x²\x00\ufeff')), max_size=60)


@given(
    raw=st.one_of(
        st.binary(max_size=200),
        st.text(max_size=100).map(str.encode),
        like_a_table.map(str.encode),
        like_a_table.map(lambda text: ("K_S,acc\n" + text).encode()),
        like_a_table.map(lambda text: ("K_S;acc;x\n18;0.6;\n20;0.7;\n" + text).encode()),
    )
)
def test_any_bytes_are_runs_or_refused_in_one_line(raw, tmp_path_factory):
    path = tmp_path_factory.mktemp("runs") / "runs.csv"
    path.write_bytes(raw)
    said = None
    try:
        runs = read_runs(path, {"ks": "K_S"}, {"bacc": "acc"})
    except ValueError as error:
        said = str(error)
    if said is not None:
        assert said.startswith(str(path))
        assert len(said.splitlines()) == 1
    else:
        assert (runs.designs.to_numpy() > 0.0).all()
        assert np.isfinite(runs.designs.to_numpy()).all()
        lines = list(io.StringIO(decoded(path)[0], newline=None))
        assert len(runs.rows) == len(runs.designs) == len(runs.responses) < len(lines)
        assert (np.diff(runs.rows) > 0).all()
