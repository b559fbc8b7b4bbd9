"""A bare import is light: what computes, draws or fits is loaded on first use."""

import json
import subprocess
import sys


def loaded_by(statement):
    program = (
        f"import json, sys\n{statement}\nprint(json.dumps(sorted({{name.split('.')[0] for name in sys.modules}})))"
    )
    output = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    return {name for name in json.loads(output) if name not in sys.stdlib_module_names and not name.startswith("_")}


def test_bare_import_loads_nothing_but_the_lazy_loader():
    assert loaded_by("import susp_ss") - loaded_by("pass") == {"lazy_loader", "susp_ss"}


def test_vehicles_and_roads_need_no_heavy_library():
    heavy = {"control", "cvxpy", "matplotlib", "sklearn", "typer"}
    assert not heavy & loaded_by("import susp_ss as ss; ss.ride_metrics(ss.FullCar(), ss.Road())")


def test_command_line_help_loads_no_numerical_library():
    heavy = {"numpy", "scipy", "xarray", "pandas", "control", "cvxpy", "matplotlib", "sklearn"}
    assert not heavy & loaded_by("import susp_ss.cli")
