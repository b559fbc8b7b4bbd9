"""The house: rooms in one order, imports in one direction, no circle of files; what breaks it is said in words.

Imports inside functions and under TYPE_CHECKING count.
"""

import ast
from pathlib import Path

import susp_ss

ROOT = Path(susp_ss.__file__).parent

ROOMS = (
    "extras",
    "quantities",
    "units",
    "written",
    "netcdf",
    "progress",
    "vehicles",
    "roads",
    "responses",
    "metrics",
    "surrogates",
    "feedback",
    "design",
    "study",
    "fit",
    "sweep",
    "exchange",
    "presentation",
    "explorer",
    "cli",
    "__main__",
)
"""From the ground up: a room imports from those before it only."""

STRANGERS = (
    {"vehicles", "roads"},
    {"vehicles", "surrogates"},
    {"surrogates", "feedback"},
    {"study", "fit"},
    {"study", "sweep"},
    {"fit", "sweep"},
    {"exchange", "presentation"},
)
"""Rooms that know nothing of one another."""
# What a number, an array or a DataArray of designs is, is one thing for all that a design may set.
SHARED = "vehicles.parameters"


def modules(root):
    """Path of every module by its name, the package's own being empty."""
    found = {}
    for path in root.rglob("*.py"):
        parts = path.relative_to(root).with_suffix("").parts
        found[".".join(parts[:-1] if path.stem == "__init__" else parts)] = path
    return found


def imported(name, path, known):
    """Modules of the package that a module imports, anywhere in it."""
    package = (name if path.stem == "__init__" else name.rpartition(".")[0]).split(".") if name else []
    package = [part for part in package if part]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = [*package[: len(package) - node.level + 1], *(node.module or "").split(".")]
            whole = ".".join(part for part in base if part)
            for alias in node.names:
                own = f"{whole}.{alias.name}".strip(".")
                yield own if own in known else whole
        elif isinstance(node, ast.ImportFrom | ast.Import):
            names = [node.module] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
            for dotted in names:
                assert not f"{dotted}.".startswith("susp_ss."), f"{name} imports {dotted} by its full name"


def graph(root=ROOT):
    known = modules(root)
    return {name: set(imported(name, path, known)) - {name, ""} for name, path in known.items()}


def broken(links):
    """Every breach of the order in words."""
    for name, targets in links.items():
        for target in targets:
            room, other = name.split(".")[0], target.split(".")[0]
            if not name or room == other:
                continue
            if ROOMS.index(other) > ROOMS.index(room):
                yield f"{name} imports {target}: {room} lies below {other} and must not know it"
            if {room, other} in STRANGERS and target != SHARED:
                yield f"{name} imports {target}: {room} and {other} must not know one another"
    for start in links:
        seen, todo = set(), list(links[start])
        while todo:
            module = todo.pop()
            if module not in seen:
                seen.add(module)
                todo += links.get(module, ())
        if start in seen:
            yield f"{start} imports itself by way of {', '.join(sorted(m for m in seen if start in links.get(m, ())))}"


def test_imports_run_one_way_and_never_in_a_circle():
    assert list(broken(graph())) == []


def test_every_room_is_known():
    assert {name.split(".")[0] for name in modules(ROOT) if name} == set(ROOMS)


def test_a_breach_is_found_and_said(tmp_path):
    for room in ("vehicles", "roads", "presentation"):
        (tmp_path / room).mkdir()
        (tmp_path / room / "__init__.py").touch()
    (tmp_path / "vehicles" / "car.py").write_text("def f():\n    from ..presentation import plots\n")
    (tmp_path / "roads" / "road.py").write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from .profile import x\nfrom ..vehicles import car\n"
    )
    (tmp_path / "roads" / "profile.py").write_text("from .road import y\n")
    said = "\n".join(broken(graph(tmp_path)))
    assert "vehicles.car imports presentation: vehicles lies below presentation and must not know it" in said
    assert "roads.road imports vehicles.car: roads and vehicles must not know one another" in said
    assert "roads.road imports itself by way of roads.profile" in said
