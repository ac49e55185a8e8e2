"""Nodes of trees: frozen values with slots, equal up to their places in the text.

Every command line begins by making some two hundred of these classes.  ``dataclass(frozen=True)``
writes and compiles six methods for each, which was a third of the time of a whole ``check``; here
only ``__init__`` is compiled.  That nodes are never changed is left to the type checker.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from operator import attrgetter
from typing import Any, TypeVar, dataclass_transform

Node = TypeVar("Node")


def _key(names: list[str]) -> Callable[[Any], object]:
    return attrgetter(*names) if names else lambda _: ()


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def node(cls: type[Node]) -> type[Node]:
    """Make a class a node: a dataclass whose fields are compared unless ``compare=False``."""
    made: Any = dataclass(slots=True, eq=False, repr=False)(cls)
    shown = [f.name for f in fields(made) if f.repr]
    compared = _key([f.name for f in fields(made) if f.compare])

    def equal(self: object, other: object) -> Any:
        if self is other:
            return True
        if other.__class__ is not made:
            return NotImplemented
        return compared(self) == compared(other)

    def hashed(self: object) -> int:
        return hash(compared(self))

    def text(self: object) -> str:
        values = (f"{name}={getattr(self, name)!r}" for name in shown)
        return f"{made.__name__}({', '.join(values)})"

    made.__eq__, made.__hash__, made.__repr__ = equal, hashed, text
    found: type[Node] = made
    return found
