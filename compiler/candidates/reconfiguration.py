"""What has to be done to make a robot of an existing one (Example 2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from compiler.candidates.alignment import Alignment, alignment
from compiler.candidates.configurations import configurations
from compiler.grammars.grammar import Srg


@dataclass(frozen=True, slots=True)
class Reconfiguration:
    """The way from the word of an existing robot to that of another one, both included."""

    aligned: Alignment
    configurations: tuple[tuple[str, ...], ...]

    def describe(self) -> dict[str, Any]:
        """As plain data, for ``design.json``; indices count from 0, in the old and the new word."""
        return {
            "from": list(self.configurations[0]),
            "added": len(self.aligned.added),
            "removed": len(self.aligned.removed),
            "kept": [list(pair) for pair in self.aligned.kept],
            "configurations": [list(word) for word in self.configurations],
        }


def reconfiguration(srg: Srg, old: tuple[str, ...], new: tuple[str, ...]) -> Reconfiguration:
    """How a robot becomes another one.

    Args:
        srg: the grammar of both.
        old: the word of the existing robot.
        new: that of the other one.
    """
    aligned = alignment(old, new, srg.modules)
    return Reconfiguration(aligned, configurations(srg, old, new, aligned))
