"""Examples that are carried out as the page is built: files, and command lines with what they print.

``{file} car.toml`` shows a file and lays it into the page's folder; ``{command}`` runs its lines there, one after
another, and shows their output. A command that fails fails the build.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

WIDTH = 80
"""Columns of the terminal."""


class _Example(SphinxDirective):
    has_content = True

    @property
    def folder(self) -> Path:
        """Where this page's examples happen."""
        if "examples" not in self.env.temp_data:
            self.env.temp_data["examples"] = tempfile.TemporaryDirectory(prefix="susp_ss-docs-")
        return Path(self.env.temp_data["examples"].name)


class File(_Example):
    """Show a file, and write it."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the file as a block under its name."""
        name, text = self.arguments[0], "\n".join(self.content) + "\n"
        (self.folder / name).write_text(text, encoding="utf-8")
        block = nodes.literal_block(text, text, language="toml" if name.endswith(".toml") else "text")
        box = nodes.container("", nodes.caption(name, name), block, literal_block=True)
        box["classes"] = ["literal-block-wrapper"]
        return [box]


class Command(_Example):
    """Run command lines, and show them with their output."""

    option_spec: ClassVar[dict[str, Any]] = {"lines": directives.positive_int}

    def run(self) -> list[nodes.Node]:
        """Return the lines, and what they printed: so many ``lines`` of it if asked for."""
        text = "\n".join(self.content)
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        environment = os.environ | {"PATH": path, "COLUMNS": str(WIDTH), "NO_COLOR": "1", "TERM": "dumb"}
        ran = subprocess.run(
            [shutil.which("bash") or "sh", "-ec", text],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )
        if ran.returncode:
            raise self.error(f"exit code {ran.returncode} of\n{text}\n{ran.stderr}")
        blocks = [nodes.literal_block(text, text, language="bash", classes=["command"])]
        lines = ran.stdout.rstrip().splitlines()
        printed = [part for line in lines for part in (textwrap.wrap(line, WIDTH) if len(line) > WIDTH else [line])]
        if printed:
            shown = printed[: self.options.get("lines", len(printed))]
            out = "\n".join(shown + ["..."] * (len(shown) < len(printed)))
            blocks.append(nodes.literal_block(out, out, language="text", classes=["printed"]))
        return blocks


def setup(app: Any) -> dict[str, bool]:
    """Add both directives."""
    app.add_directive("file", File)
    app.add_directive("command", Command)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
