"""The command line's own help as pages: ``{commands}`` says what every ``susp-ss COMMAND --help`` says."""

import inspect
import re
from collections.abc import Iterator
from typing import Any

import typer.main
from docutils import nodes
from sphinx.util.docutils import SphinxDirective

from susp_ss.cli import app as commands

PROGRAM = "susp-ss"


def _plain(text: str) -> str:
    """Text that Markdown takes as it is."""
    return re.sub(r"([\\`*\[\]<>$|])", r"\\\1", text)


def _help(text: str) -> str:
    return "\n\n".join(
        f"```bash\n{part}\n```" if part.startswith(f"{PROGRAM} ") else _plain(part)
        for part in inspect.cleandoc(text).split("\n\n")
    )


def _signature(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return parameter.metavar
    names = ", ".join([*parameter.opts, *parameter.secondary_opts])
    return names if parameter.is_flag else f"{names} {parameter.metavar}"


def _said(parameter: Any) -> str:
    shown = parameter.show_default
    default = shown if isinstance(shown, str) else parameter.default if shown and parameter.metavar else None
    more = "Required." if parameter.required else f"Default: {default}." if default is not None else ""
    return _plain(f"{parameter.help} {more}".rstrip())


def every(group: Any, before: str = "") -> Iterator[tuple[str, Any]]:
    """Name and command of all there are, those of groups by both names."""
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from every(command, f"{before}{name} ")
        else:
            yield before + name, command


def page(name: str, command: Any) -> Iterator[str]:
    """Lines of Markdown that say all of a command."""
    arguments = [_signature(parameter) for parameter in command.params if parameter.param_type_name == "argument"]
    yield f"```bash\n{' '.join([PROGRAM, name, *arguments, '[OPTIONS]'])}\n```\n"
    yield f"{_help(command.help)}\n"
    yield f"```{{program}} {PROGRAM} {name}\n```\n"
    panels: dict[str, list[Any]] = {}
    for parameter in command.params:
        if not getattr(parameter, "hidden", False):
            panels.setdefault(getattr(parameter, "rich_help_panel", None) or "", []).append(parameter)
    for title, parameters in sorted(panels.items()):
        yield f"**{title}**\n" if title else ""
        for parameter in parameters:
            yield f"````{{option}} {_signature(parameter)}\n{_said(parameter)}\n````\n"


class Commands(SphinxDirective):
    """A section a command, so that none is forgotten."""

    def run(self) -> list[nodes.Node]:
        """Return the parsed help of every command."""
        group = typer.main.get_command(commands)
        text = "\n".join(f"## {name}\n\n" + "\n".join(page(name, command)) for name, command in every(group))
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def setup(app: Any) -> dict[str, bool]:
    """Add the directive."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
