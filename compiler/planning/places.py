"""Variables that say that an effector is in a cell at a layer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from compiler.planning.clauses import Ints


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Each variable is for a cell at a layer, a position or a sample; shapes (n,)."""

    cells: Ints
    layers: Ints
    variables: Ints

    def with_more(self, new: Places) -> Places:
        """These and others."""
        return Places(
            np.concatenate([self.cells, new.cells]),
            np.concatenate([self.layers, new.layers]),
            np.concatenate([self.variables, new.variables]),
        )


_NONE = np.zeros(0, dtype=np.int64)
NOWHERE: Final = Places(_NONE, _NONE, _NONE)
