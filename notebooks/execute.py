"""Execute the notebooks afresh and keep their outputs; `make notebooks` calls this.

What differs from one execution to the next and tells nothing (times, counts, the kernel's version,
what libraries write to stderr) is not kept: a change in a file is a change in what it says.
"""

import os
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode

from jaxsusp._files import write_text

FOLDER = Path(__file__).parent
KERNEL = {"display_name": "Python 3", "language": "python", "name": "python3"}
TIMEOUT = 300
"""s that one cell may take."""


def notebooks() -> list[Path]:
    """All of them, in the order in which they are read."""
    return sorted(FOLDER.glob("*.ipynb"))


def executed(path: Path) -> NotebookNode:
    """A notebook executed from top to bottom by a fresh kernel, in its folder.

    Raises:
        nbclient.exceptions.CellExecutionError: a cell failed.
    """
    notebook = nbformat.read(path, as_version=4)
    client = NotebookClient(
        notebook, timeout=TIMEOUT, kernel_name="python3", record_timing=False,
        resources={"metadata": {"path": str(FOLDER)}},
    )  # fmt: skip
    paths = filter(None, [str(FOLDER.parent), os.environ.get("PYTHONPATH")])  # this very checkout
    client.execute(env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)})
    return normalised(notebook)


def normalised(notebook: NotebookNode) -> NotebookNode:
    """A notebook without what differs from one execution to the next."""
    notebook.metadata = {"kernelspec": KERNEL, "language_info": {"name": "python"}}
    for number, cell in enumerate(notebook.cells):
        cell.id, cell.metadata = f"cell-{number}", {}
        if cell.cell_type != "code":
            continue
        said = _in_one_piece([each for each in cell.outputs if each.get("name") != "stderr"])
        cell.outputs, cell.execution_count = said, None
        for output in said:
            if output.output_type == "execute_result":
                output.execution_count = None
            if "metadata" in output:
                output.metadata = {}
    return notebook


def _in_one_piece(outputs: list[NotebookNode]) -> list[NotebookNode]:
    """Outputs, those of print joined where one follows another.

    A kernel sends what is printed whenever its clock strikes, in the middle of a line too.
    """
    joined: list[NotebookNode] = []
    for output in outputs:
        if joined and joined[-1].output_type == output.output_type == "stream":
            joined[-1].text += output.text
        else:
            joined.append(output)
    return joined


def main(names: list[str]) -> None:
    """Execute the named notebooks, or all."""
    for path in [FOLDER / name for name in names] or notebooks():
        print(path.name)
        write_text(path, nbformat.writes(executed(path)) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
