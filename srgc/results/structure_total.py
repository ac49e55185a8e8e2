"""How many structures a search may have to try."""

from __future__ import annotations

from itertools import islice

from compiler.robots.family import family_of
from compiler.words.structures import InfiniteAmbiguityError, structures
from grammar_lang import ir
from solvers.conclusion import module_bound, robot_limit

MOST_COUNTED = 500
"""More are not counted: that takes a tenth of a second."""


def structure_total(program: ir.Program, task: ir.Task) -> int | None:
    """The structures up to the bound of a task; None where they are very many, or only limited."""
    family = family_of(program, task)
    if robot_limit(family, task) is not None:
        return None
    try:
        found = structures(family.language, module_bound(family, task))
    except InfiniteAmbiguityError:
        return None
    number = sum(1 for _ in islice(found, MOST_COUNTED + 1))
    return None if number > MOST_COUNTED else number
