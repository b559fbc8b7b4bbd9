"""Every notebook runs without what others named and asserts what it claims; what is committed was run and is small.

Pictures have words, solutions are folded, and slides know where they begin.
"""

import html
import itertools
import re
from pathlib import Path

import nbformat
import pytest
from jupyter_client import KernelManager
from nbclient import NotebookClient

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))
LARGEST = 200_000  # bytes, outputs included

every_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def cells(path):
    return nbformat.read(path, as_version=4).cells


def code_cells(path):
    return [cell for cell in cells(path) if cell.cell_type == "code"]


def images(output):
    """What an output says in place of each of its pictures."""
    return re.findall(r'<img alt="([^"]*)"', output.get("data", {}).get("text/html", ""))


def solutions(path):
    """The cells before the solutions, and those of them."""
    all_of_them = cells(path)
    (start,) = (i for i, cell in enumerate(all_of_them) if cell.source == "### Solutions")
    return all_of_them[: start + 1], all_of_them[start + 1 :]


def test_there_are_notebooks():
    assert NOTEBOOKS


@pytest.fixture(scope="module")
def kernel():
    """A kernel for all: to load the libraries takes longer than what a notebook computes."""
    with pytest.MonkeyPatch.context() as patch:
        # The kernel starts Jupyter's debugger otherwise, which warns of frozen modules.
        patch.setenv("PYDEVD_DISABLE_FILE_VALIDATION", "1")
        running = KernelManager(kernel_name="python3")
        running.start_kernel()
    yield running
    running.shutdown_kernel()


@every_notebook
def test_notebook_runs(path, kernel):
    notebook = nbformat.read(path, as_version=4)
    assert any("assert" in cell.source for cell in notebook.cells if cell.cell_type == "code")
    notebook.cells.insert(0, nbformat.v4.new_code_cell("%reset -f"))
    NotebookClient(notebook, km=kernel, timeout=None).execute()


@every_notebook
def test_committed_outputs_are_of_one_clean_run(path):
    cells = code_cells(path)
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell.outputs]
    assert not [output for output in outputs if output.output_type == "error" or output.get("name") == "stderr"]
    assert any(images(output) for output in outputs)


@every_notebook
def test_notebook_is_small(path):
    assert path.stat().st_size < LARGEST


@every_notebook
def test_notebook_teaches(path):
    """Goals first, exercises with solutions last."""
    prose = [cell.source for cell in cells(path) if cell.cell_type == "markdown"]
    assert prose[0].startswith("# ")
    assert "After it you can" in prose[0]
    text = "\n".join(prose)
    assert 0 < text.index("## Exercises") < text.index("### Solutions")


@every_notebook
def test_every_picture_has_words(path):
    told = []
    for cell in cells(path):
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            # Jupyter and nbconvert show an image alone without its words.
            assert not [kind for kind in data if kind.startswith("image/")], cell.source
            assert len(images(output)) == data.get("text/html", "").count("<img")
            told += images(output)
            assert all(html.unescape(words) == data["text/plain"] for words in images(output))
        if cell.cell_type == "markdown":
            assert not re.search(r"!\[\s*\]|<img(?![^>]*\balt=)", cell.source)
    assert told
    assert len(set(told)) == len(told)
    assert min(len(words.split()) for words in told) >= 12


@every_notebook
def test_solutions_are_folded(path):
    before, after = solutions(path)
    assert after
    for cell in after:
        if cell.cell_type == "markdown":
            assert cell.source.startswith("<details>")
            assert cell.source.endswith("</details>")
        else:
            assert cell.source.startswith("# ")  # What Jupyter shows of a folded cell: which exercise it solves.
            assert cell.metadata.jupyter.source_hidden
            assert cell.metadata.jupyter.get("outputs_hidden", False) == bool(cell.outputs)
            assert cell.metadata.tags == ["hide-cell"]
    assert not any("jupyter" in cell.metadata or "tags" in cell.metadata for cell in before)


@every_notebook
def test_slides(path):
    before, after = solutions(path)
    imports = next(cell for cell in before if cell.cell_type == "code")
    for above, cell in itertools.pairwise([None, *before[:-1]]):
        if cell.cell_type == "markdown":
            kind = "slide" if cell.source.startswith(("# ", "## ")) else "subslide"
        elif cell is imports or not cell.outputs:
            kind = "skip"  # Code that shows nothing is not for an audience.
        else:
            # What it shows stands below a few words, or alone.
            kind = "-" if above.cell_type == "markdown" and len(above.source) < 500 else "subslide"
        assert cell.metadata.slideshow.slide_type == kind, cell.source
    assert {cell.metadata.slideshow.slide_type for cell in [before[-1], *after]} == {"skip"}
