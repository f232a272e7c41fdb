"""Second-order cone programmes put together row by row, and solved by Clarabel."""

from dataclasses import dataclass, replace
from typing import Any

import clarabel
import numpy as np
import scipy.sparse as sp

solver: Any = clarabel  # a compiled module, whose stubs name nothing


@dataclass(frozen=True)
class Affine:
    """Affine functions of a programme's variables: few entries a row, and a constant."""

    columns: np.ndarray  # (rows, entries)
    factors: np.ndarray  # (rows, entries)
    constant: np.ndarray  # (rows,)

    def __len__(self) -> int:
        return len(self.constant)

    def __getitem__(self, rows: Any) -> "Affine":
        return Affine(self.columns[rows], self.factors[rows], self.constant[rows])

    def __add__(self, other: Any) -> "Affine":
        if not isinstance(other, Affine):
            return replace(self, constant=self.constant + other)
        return Affine(
            np.hstack([self.columns, other.columns]),
            np.hstack([self.factors, other.factors]),
            self.constant + other.constant,
        )

    def __mul__(self, factor: Any) -> "Affine":
        rows = np.broadcast_to(factor, len(self))
        return Affine(self.columns, self.factors * rows[:, None], self.constant * rows)

    def at(self, x: np.ndarray) -> np.ndarray:
        """Their values."""
        return (self.factors * x[self.columns]).sum(axis=1) + self.constant


class Programme:
    """Minimise something linear under linear and second-order cone constraints."""

    def __init__(self):
        self._count = 0
        self._linear: list[tuple[Any, Affine]] = []
        self._cones: list[tuple[Affine, ...]] = []

    def variables(self, count: int) -> Affine:
        """So many further variables."""
        first, self._count = self._count, self._count + count
        columns = np.arange(first, self._count)[:, None]
        return Affine(columns, np.ones((count, 1)), np.zeros(count))

    def equal(self, rows: Affine, value: Any) -> None:
        """Make every row a value."""
        self._linear.append((solver.ZeroConeT, rows + -np.asarray(value)))

    def atmost(self, rows: Affine, value: Any) -> None:
        """Keep every row at or below a value."""
        self._linear.append((solver.NonnegativeConeT, rows * -1.0 + value))

    def cone(self, most: Affine, *parts: Affine) -> None:
        """Keep the norm of (part, part, …) at or below `most`, row by row."""
        self._cones.append((most, *parts))

    def minimise(self, cost: Affine) -> np.ndarray | None:
        """The variables at the least sum of all rows of a cost; None where nothing is feasible."""
        blocks, cones = [], []
        for kind, rows in self._linear:
            blocks.append(rows)
            cones.append(kind(len(rows)))
        for parts in self._cones:
            width = max(part.columns.shape[1] for part in parts)
            wide = [_widened(part, width) for part in parts]
            columns, factors, constant = (  # part by part → row by row
                np.stack([getattr(part, name) for part in wide], axis=1)
                for name in ("columns", "factors", "constant")
            )
            blocks.append(
                Affine(columns.reshape(-1, width), factors.reshape(-1, width), constant.ravel())
            )
            cones += [solver.SecondOrderConeT(len(parts))] * len(parts[0])
        objective = np.zeros(self._count)
        np.add.at(objective, cost.columns, cost.factors)
        settings = solver.DefaultSettings()
        settings.verbose = False
        found = solver.DefaultSolver(
            sp.csc_matrix((self._count, self._count)), objective / np.abs(objective).max(),
            -self._matrix(blocks), np.concatenate([rows.constant for rows in blocks]), cones,
            settings,
        ).solve()  # fmt: skip
        return np.array(found.x) if str(found.status) in ("Solved", "AlmostSolved") else None

    def _matrix(self, blocks: list[Affine]) -> Any:
        row, column, factor, first = [], [], [], 0
        for rows in blocks:
            row.append(np.repeat(first + np.arange(len(rows)), rows.columns.shape[1]))
            column.append(rows.columns.ravel())
            factor.append(rows.factors.ravel())
            first += len(rows)
        where = np.concatenate(row), np.concatenate(column)
        found = sp.csc_matrix((np.concatenate(factor), where), shape=(first, self._count))
        found.eliminate_zeros()
        return found


def _widened(rows: Affine, width: int) -> Affine:
    lacking = ((0, 0), (0, width - rows.columns.shape[1]))
    return Affine(np.pad(rows.columns, lacking), np.pad(rows.factors, lacking), rows.constant)
