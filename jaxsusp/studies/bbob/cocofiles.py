"""Data files in the layout of COCO's observer: COCO's postprocessing reads them as its own.

A folder per algorithm holds a file `bbobexp_fN.info` per function, with a paragraph per dimension,
and in `data_fN` a .dat and a .tdat per dimension with all instances one after the other.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from jaxsusp._files import write_text
from jaxsusp.studies.bbob.record import FINAL, Logged, Record

VERSION = "2.8.2"
"""Of coco-experiment, whose layout this is."""

_LONG = 10
"""Variables from which points are not written."""

HEADER = (
    "% f evaluations | g evaluations | best noise-free fitness - Fopt ({:.12e}) + sum g_i+ | "
    "measured fitness | best measured fitness or single-digit g-values | x1 | x2..."
)


class Paragraph(NamedTuple):
    """What the .info file says of one function in one dimension."""

    algorithm: str
    function: int
    dim: int
    ends: tuple[tuple[int, int, float], ...]  # instance, evaluations, distance to f_opt


def paragraph(
    algorithm: str, function: int, dim: int, instances: Sequence[int], records: Sequence[Record]
) -> Paragraph:
    """How the runs of a function ended."""
    ends = [
        (number, record.evaluations, record.best - record.least)
        for number, record in zip(instances, records, strict=True)
    ]
    return Paragraph(algorithm, function, dim, tuple(ends))


def write_data(folder: Path, function: int, dim: int, records: Sequence[Record]) -> None:
    """Write the .dat and the .tdat of a function, each atomically."""
    path = folder / data_file(function, dim)
    path.parent.mkdir(parents=True, exist_ok=True)
    for suffix, logged in ((".dat", Record.by_target), (".tdat", Record.by_number)):
        text = "".join(block(record.least, logged(record)) for record in records)
        write_text(path.with_suffix(suffix), text)


def write_info(folder: Path, paragraphs: Sequence[Paragraph]) -> None:
    """Write the .info files of an algorithm; a file is replaced as a whole."""
    folder.mkdir(parents=True, exist_ok=True)
    for function in sorted({each.function for each in paragraphs}):
        here = sorted(each for each in paragraphs if each.function == function)
        path = folder / f"bbobexp_f{function}.info"
        write_text(path, "\n".join(info(each) for each in here))


def info(of: Paragraph) -> str:
    """A paragraph of an .info file, without the end of its last line."""
    ends = "".join(f", {number}:{count}|{gap:.1e}" for number, count, gap in of.ends)
    return (
        f"suite = 'bbob', funcId = {of.function}, DIM = {of.dim}, Precision = {FINAL:.3e}, "
        f"algId = '{of.algorithm}', coco_version = '{VERSION}', logger = 'bbob', "
        f"data_format = 'bbob-new2', settings = ''\n% \n{data_file(of.function, of.dim)}{ends}"
    )


def data_file(function: int, dim: int) -> str:
    """The name of a .dat file as its .info file has it."""
    return f"data_f{function}/bbobexp_f{function}_DIM{dim}.dat"


def block(least: float, logged: Logged) -> str:
    """One run in a .dat or .tdat file: a header and a line per evaluation."""
    lines = [HEADER.format(least)]
    for number, value, best, x in zip(*logged, strict=True):
        line = f"{number} 0 {best - least:+.9e} {value:+.9e} {best:+.9e}"
        point = "".join(f" {each:+.4e}" for each in x) if len(x) < _LONG else ""
        lines.append(line + point)
    return "\n".join(lines) + "\n"
