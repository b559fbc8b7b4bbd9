"""Vehicle files: what they say is what is read, and whatever they may not say is refused by name."""

import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import models
import susp_ss as ss
from susp_ss.quantities import UNITS
from susp_ss.vehicles import files
from susp_ss.vehicles.files import model_name, model_named, read_vehicle, vehicle_text


@pytest.fixture
def write(tmp_path):
    def written(text):
        path = tmp_path / "car.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return written


def values(vehicle):
    """Model and every number of a vehicle, comparable."""
    fields = {field.name: getattr(vehicle, field.name) for field in dataclasses.fields(vehicle)}
    return type(vehicle), {k: tuple(v) if isinstance(v, ss.Corners) else v for k, v in fields.items()}


@pytest.mark.parametrize("vehicle", models.VEHICLES.values(), ids=models.VEHICLES.keys())
def test_round_trip(vehicle, write):
    assert values(read_vehicle(write(vehicle_text(vehicle)))) == values(vehicle)


@given(vehicle=models.vehicles)
def test_every_digit_survives(vehicle, tmp_path_factory):
    path = tmp_path_factory.mktemp("car") / "car.toml"
    path.write_text(vehicle_text(vehicle))
    assert values(read_vehicle(path, trust_units=True)) == values(vehicle)


@pytest.mark.parametrize("name", files.models())
def test_fields_left_out_keep_their_defaults(name, write):
    assert values(read_vehicle(write(f'model = "{name}"'))) == values(files.models()[name]())
    assert model_named(model_name(files.models()[name]())) is files.models()[name]


def test_every_field_has_units():
    units = {quantity.unit for car in files.models().values() for quantity in car.quantities().values()}
    assert units < set(UNITS)
    assert all(table[unit] == 1.0 for unit, table in UNITS.items())


@pytest.mark.parametrize(
    ("entry", "field", "expected"),
    [
        ('mb = { value = 1.27, unit = "t" }', "mb", 1270.0),
        ('mb = { value = 1300, unit = "kg" }', "mb", 1300.0),
        ('a = { value = 961, unit = "mm" }', "a", 0.961),
        ('ks = { value = 18.5, unit = "kN/m" }', "ks", 18500.0),
        ('ks = { value = 18.5, unit = "N/mm" }', "ks", 18500.0),
        ('cs = { value = 1.5, unit = "kN s/m" }', "cs", 1500.0),
        ('cs = { value = 1.5, unit = "N s/mm" }', "cs", 1500.0),
        ('iyy = { value = 1100.0, unit = "kg m^2" }', "iyy", 1100.0),
    ],
)
def test_units(entry, field, expected, write):
    car = read_vehicle(write(f'model = "full"\n[parameters]\n{entry}\n'))
    assert getattr(car, field) == pytest.approx(expected, rel=1e-15)


ONE_OF = {"kg": "mb", "kg m^2": "ixx", "m": "c", "N/m": "kt", "N s/m": "cs"}


@given(value=st.floats(1e-3, 1e6), kind=st.sampled_from(sorted(ONE_OF)), data=st.data())
def test_units_of_one_kind_are_one_quantity(value, kind, data, tmp_path_factory):
    """A value restated in another unit of its kind gives the same vehicle."""
    name = ONE_OF[kind]
    unit = data.draw(st.sampled_from(sorted(UNITS[kind])))
    path = tmp_path_factory.mktemp("car") / "car.toml"
    restated = value / UNITS[kind][unit]
    path.write_text(f'model = "full"\n[parameters]\n{name} = {{ value = {restated!r}, unit = "{unit}" }}')
    assert math.isclose(getattr(read_vehicle(path, trust_units=True), name), value, rel_tol=1e-14)


def test_values_at_wheels(write):
    car = read_vehicle(
        write('model = "full"\n[parameters]\nks = { rl = 4.0, fr = 1.0, fl = 2.0, rr = 3.0, unit = "kN/m" }')
    )
    assert tuple(car.ks) == (1e3, 2e3, 3e3, 4e3)
    car = read_vehicle(write('model = "roll-half"\n[parameters.cs]\nl = 2.0\nr = 1.0\nunit = "kN s/m"\n'))
    assert car.cs == (1e3, 2e3)


FULL = 'model = "full"\n[parameters]\n'

REFUSED = {
    "malformed": ('model = "full"\n[parameters\n', "not TOML", "line 2, column 12"),
    "twice": (f'{FULL}mb = {{ value = 1.0, unit = "kg" }}\nmb = 2\n', "not TOML", "line 4"),
    "not UTF-8": (b'model = "full"\n# \xe9\n', "not UTF-8 text (at line 2, column 3)"),
    "endless digits": ("model = " + "9" * 5000, "not TOML"),
    "nested": ("model = " + "[" * 5000, "not TOML"),
    "no model": ("[parameters]\n", "model is missing", "quarter"),
    "empty": ("", "model is missing"),
    "unknown model": ('model = "truck"', "no model named 'truck'", "rigid-tyre"),
    "model not text": ("model = [1]", "no model named [1]"),
    "unknown key": ('model = "full"\nks = 1.0\n', "no key named 'ks'", "parameters"),
    "parameters not a table": ('model = "full"\nparameters = 3\n', "parameters must be a table"),
    "unknown parameter": (f'{FULL}ms = {{ value = 1.0, unit = "kg" }}', "no parameter", "'ms'", "mb, ixx"),
    "no unit": (f"{FULL}ks = 18e3", "ks must state its unit", "N/m"),
    "unit missing": (f"{FULL}ks = {{ value = 18e3 }}", "ks.unit", "N/m, N/mm, kN/m", "got none"),
    "unit unknown": (f'{FULL}ks = {{ value = 1.0, unit = "kp/cm" }}', "ks.unit", "N/mm", "'kp/cm'"),
    "unit of another kind": (f'{FULL}ks = {{ value = 1.0, unit = "kg" }}', "ks.unit", "'kg'"),
    "unit not text": (f"{FULL}ks = {{ value = 1.0, unit = [1] }}", "ks.unit", "[1]"),
    "no value": (f'{FULL}ks = {{ unit = "N/m" }}', "ks must have value", "fr, fl, rr, rl", "got none"),
    "text": (f'{FULL}ks = {{ value = "soft", unit = "N/m" }}', "ks.value must be a number", "'soft'"),
    "bool": (f'{FULL}ks = {{ value = true, unit = "N/m" }}', "ks.value must be a number", "True"),
    "array": (f'{FULL}ks = {{ value = [1.0, 2.0], unit = "N/m" }}', "ks.value must be a number"),
    "date": (f'{FULL}ks = {{ value = 2021-01-01, unit = "N/m" }}', "ks.value must be a number"),
    "nan": (f'{FULL}ks = {{ value = nan, unit = "N/m" }}', "car.toml: ks must be", "nan"),
    "inf": (f'{FULL}ks = {{ value = inf, unit = "N/m" }}', "car.toml: ks must be", "inf"),
    "too large": (f'{FULL}ks = {{ value = 1{"0" * 400}, unit = "N/m" }}', "ks.value must be a finite number"),
    "zero mass": (f'{FULL}mb = {{ value = 0, unit = "kg" }}', "car.toml: mb must be", "> 0 kg"),
    "negative damping at a corner": (
        f'{FULL}cs = {{ fr = 900, fl = 900, rr = -900, rl = 900, unit = "N s/m" }}',
        "cs at corner rr must be",
    ),
    "unknown corner": (f'{FULL}ks = {{ front = 1.0, unit = "N/m" }}', "'front'", "fr, fl, rr, rl"),
    "corner missing": (
        f'{FULL}ks = {{ fr = 1.0, fl = 1.0, rr = 1.0, unit = "N/m" }}',
        "ks must have",
        "got fr, fl, rr",
    ),
    "value and corners": (f'{FULL}ks = {{ value = 1.0, fr = 1.0, unit = "N/m" }}', "ks must have", "got value, fr"),
    "corners of a scalar": (f'{FULL}mb = {{ fr = 1.0, unit = "kg" }}', "no key of mb named 'fr'"),
    "corners of a quarter car": (
        'model = "quarter"\n[parameters]\nks = { fr = 1.0, unit = "N/m" }',
        "no key of ks named 'fr'",
    ),
}


@pytest.mark.parametrize(("text", "said"), [(row[0], row[1:]) for row in REFUSED.values()], ids=REFUSED.keys())
def test_refused(text, said, write):
    path = write(text)
    with pytest.raises(ValueError, match=r"car\.toml: ") as refused:
        read_vehicle(path)
    message = str(refused.value)
    assert message.startswith(f"{path}: ")
    for part in said:
        assert part in message


def test_unreadable(tmp_path):
    for path in (tmp_path, tmp_path / "missing.toml"):
        with pytest.raises(OSError, match=path.name):
            read_vehicle(path)


def test_arrays_have_no_file():
    with pytest.raises(ValueError, match="one number for every parameter, got an array for ks"):
        vehicle_text(ss.QuarterCar(ks=[1e3, 2e3]))
