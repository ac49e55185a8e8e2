"""A sparse matrix whose entries are known in place before they are known in value."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csc_matrix

from compiler.arrays import Array
from solvers.motions.step_layout import Indices


@dataclass(slots=True)
class EntryList:
    """Places of entries, block by block; every place occurs once."""

    rows: int = 0
    row: list[Indices] = field(default_factory=list[Indices])
    column: list[Indices] = field(default_factory=list[Indices])

    def add(self, *blocks: Indices) -> None:
        """Further rows, with one entry in each of the columns of blocks of shape (rows, width)."""
        count = len(blocks[0])
        numbers = np.arange(self.rows, self.rows + count)
        for columns in blocks:
            self.row.append(np.broadcast_to(numbers[:, None], columns.shape).ravel())
            self.column.append(columns.ravel())
        self.rows += count

    def compressed(self, width: int) -> EntryPattern:
        """The pattern of a matrix with so many columns."""
        none = np.zeros(0, dtype=np.int64)
        row = np.concatenate([*self.row, none])
        column = np.concatenate([*self.column, none])
        order = np.lexsort((row, column))
        starts = np.searchsorted(column[order], np.arange(width + 1))
        shape = (self.rows, width)
        empty = csc_matrix((np.zeros(len(order)), row[order], starts), shape=shape)
        return EntryPattern(order, empty)


@dataclass(frozen=True, slots=True)
class EntryPattern:
    """Compressed columns whose data are values of entries in the order of the list."""

    order: Indices
    empty: csc_matrix
    """The pattern with zeros."""

    def matrix(self, values: Sequence[Array]) -> csc_matrix:
        """The matrix with these values, block by block as the entries were listed."""
        flat = np.concatenate([*values, np.zeros(0)])
        # The pattern is known to be sound: a copy is forty times as fast as building it anew.
        matrix = copy(self.empty)
        matrix.data = flat[self.order]
        return matrix
