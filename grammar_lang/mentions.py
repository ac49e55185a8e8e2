"""Which modules of a production expressions name: by a coordinate, a parameter or a constant.

Constants are folded away in the intermediate representation, so that this is read off the syntax.
"""

from __future__ import annotations

from collections.abc import Iterable

from grammar_lang import syntax as s
from grammar_lang.productions import ProductionInfo
from grammar_lang.readings import readings


def mentioned(expressions: Iterable[s.Expr], info: ProductionInfo) -> tuple[int, ...]:
    """The positions of the modules named on the right side, in order of their first mention."""
    right = info.production.right
    found: dict[int, None] = {}
    members = [each for each in readings(expressions) if isinstance(each, s.Member)]
    for member in sorted(members, key=lambda each: each.span):
        position = info.names.get(member.owner.text)
        if position is not None and position >= 0 and right[position].kind == "module":
            found[position] = None
    return tuple(found)
