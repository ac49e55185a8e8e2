"""Statements and bodies: the braces and semicolons of a parsed text as a tree.

It is at most four deep (item, block, statement, inequality), whatever the text.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

_SPREAD = frozenset({"grammar", "semantics", "workspace", "task"})


@dataclass(slots=True)
class Statement:
    """The tokens ``first <= i < stop``, with a body between the braces ``opens`` and ``closes``.

    Without a body ``opens`` is -1.  A body that is ``spread`` has one statement a line in any case.
    """

    first: int
    stop: int = -1
    opens: int = -1
    closes: int = -1
    spread: bool = False
    body: list[Statement] = field(default_factory=list["Statement"])


def outline(kinds: Sequence[str]) -> list[Statement]:
    """The items of a text without errors, given as its terminals."""
    stack = [Statement(0)]
    first = 0
    ended: Statement | None = None
    """The statement whose body has ended; its ``;`` is yet to come."""
    choices = False
    for here, kind in enumerate(kinds):
        if kind == "{":
            if kinds[here - 1] == "in":
                choices = True
                continue
            spread = len(stack) == 1 and kinds[first] in _SPREAD
            stack.append(Statement(first, opens=here, spread=spread))
            first = here + 1
        elif kind == ";":
            done = ended or Statement(first)
            done.stop = first = here + 1
            stack[-1].body.append(done)
            ended = None
        elif kind == "}" and choices:
            choices = False
        elif kind == "}":
            closed = stack.pop()
            if first < here:
                closed.body.append(Statement(first, here))
            closed.closes = here
            if kinds[closed.opens - 1] == "polytope":
                ended = closed
            else:
                closed.stop = here + 1
                stack[-1].body.append(closed)
            first = here + 1
    return stack[0].body
