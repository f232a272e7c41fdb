"""Notebooks run from top to bottom, and what is kept of them is what they say today."""

import re
import sys
from functools import partial
from pathlib import Path

import nbformat
import pytest

FOLDER = Path(__file__).parents[1] / "notebooks"
sys.path.append(str(FOLDER))
import execute  # noqa: E402  found on the path above

NAMES = [path.name for path in execute.notebooks()]

LARGEST = 1_000_000
"""Bytes of a notebook with its pictures."""


def kept(name: str):
    return nbformat.read(FOLDER / name, as_version=4)


def kinds(notebook) -> list[list[list[str]]]:
    """Of every cell the kinds of its outputs: what tells that one has changed its manner."""
    cells = (cell for cell in notebook.cells if cell.cell_type == "code")
    return [[sorted(each.get("data", {each.output_type: 0})) for each in c.outputs] for c in cells]


@pytest.mark.pages
@pytest.mark.filterwarnings("default")  # of the kernel's libraries, which are not ours
@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_runs_and_has_the_outputs_that_are_kept(name):
    assert kinds(execute.executed(FOLDER / name)) == kinds(kept(name))


@pytest.mark.fast
@pytest.mark.parametrize("name", NAMES)
def test_what_is_kept_is_small_and_tells_only_what_it_says(name):
    path, notebook = FOLDER / name, kept(name)
    assert path.stat().st_size < LARGEST
    text = nbformat.writes(execute.normalised(kept(name))) + "\n"
    assert text == path.read_text(encoding="utf-8"), "run `make notebooks`"
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            assert output.output_type != "error"
    assert kinds(notebook)
    assert any(each for each in kinds(notebook))
    for secret in ("/home/", "/root/", str(FOLDER.parent)):
        assert secret not in text


@pytest.mark.fast
def test_a_line_sent_in_two_pieces_is_kept_as_one():
    """A kernel may flush between what one call of print writes, and stderr may come between."""
    output = partial(nbformat.v4.new_output, "stream")
    pieces = [output(text="verified: "), output(name="stderr", text="!"), output(text="True\n")]
    last = nbformat.v4.new_output("display_data", {"text/plain": "0"})
    cell = nbformat.v4.new_code_cell(outputs=[*pieces, last, output(text="end\n")])
    notebook = execute.normalised(nbformat.v4.new_notebook(cells=[cell]))
    assert kinds(notebook) == [[["stream"], ["text/plain"], ["stream"]]]
    assert notebook.cells[0].outputs[0].text == "verified: True\n"


@pytest.mark.fast
def test_they_lead_to_one_another():
    """Links name files that are there, and there is a story of six."""
    assert [name[0] for name in NAMES] == ["1", "2", "3", "4", "5", "6"]
    for name in NAMES:
        for target in re.findall(r"\]\(([^):]+\.ipynb)\)", (FOLDER / name).read_text()):
            assert (FOLDER / target).is_file(), target
