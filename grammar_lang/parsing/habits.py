"""Hints for newcomers who write what other notations have."""

from __future__ import annotations

from grammar_lang.parsing.tokens import Tokens

_COMPARISONS = frozenset({"<", "<=", "==", ">=", ">"})
_HORIZON = "write a number of steps and how long one is, as in `horizon 10 steps of 0.2 s`"
_AT_MOST = (
    "write `horizon 10 steps of 0.2 s` for exactly that many steps, or `horizon at most 10 "
    "steps of 0.2 s` for any number up to that"
)
_POLYTOPE = "write inequalities with `;` between, as in `polytope { x >= 0; y >= 0; x + y <= 1 } m`"
_POINT = (
    "it takes a region: declare one in the workspace, such as `target T ball (3, 4) m radius 1 cm;`"
)
FOREIGN = {
    "acceleration": "accel",
    "polygon": "hull",
    "speed": "rate",
    "torque": "effort",
    "velocity": "rate",
    "vertices": "hull",
}
"""Words of other notations within clauses, and what is meant; ``MEANT`` has those at the start."""


def habit_hint(tokens: Tokens, here: int, wanted: str) -> str | None:
    """What to write instead of a token; ``wanted`` is what would fit.  None if there is no hint."""
    return (
        _in_horizon(tokens, here, wanted)
        or _in_task(tokens, here, wanted)
        or _in_reach_or_avoid(tokens, here, wanted)
        or _in_expression(tokens, here, wanted)
        or _elsewhere(tokens, here, wanted)
    )


def meant_hint(tokens: Tokens, here: int, wanted: str) -> str | None:
    """The word of the language for a word of other notations; ``wanted`` is what would fit."""
    meant = FOREIGN.get(tokens.at(here))
    return f"did you mean `{meant}`?" if meant is not None and f"`{meant}`" in wanted else None


def _in_horizon(tokens: Tokens, here: int, wanted: str) -> str | None:
    if wanted in {"`steps`", "`of`"}:
        return _HORIZON
    before = map(tokens.at, range(max(0, here - 3), here))
    return _AT_MOST if "horizon" in before else None


def _in_task(tokens: Tokens, here: int, wanted: str) -> str | None:
    before, found = tokens.at(here - 1), tokens.at(here)
    if wanted == "`(`" and before == "at":
        return "write coordinates of joints, as in `start at (30 deg, 0)`, or `start in` a region"
    if wanted == "`feedback` or `open`" and found == "closed":
        return "write `control feedback` for a closed loop"
    if wanted == "a name" and before == "margin":
        return "the margin comes before `except`"
    if wanted == "a name" and "except" in (before, tokens.at(here - 2)):
        return "modules come in pairs, as in `except Hand Tube, Tube Tube`"
    if wanted == "a name" and found == "(" and before in {"in", "reach", "avoid"}:
        return _POINT
    return None


def _in_reach_or_avoid(tokens: Tokens, here: int, wanted: str) -> str | None:
    before, found = tokens.at(here - 1), tokens.at(here)
    if wanted == "`,` or `with`" and found == "margin":
        return "write what keeps it: `with effector` or `with body`, then the margin"
    if before == "self" and tokens.at(here - 2) == "avoid":
        return "write `avoid self with body;`"
    if found == "for" and tokens.at(here - 2) == "reach":
        return f"the rates come first, as in `reach {before} at rest for 0.5 s;`"
    if before == "in" and tokens.at(here - 2) == "reach":
        return f"it takes the region itself: write `reach {found}`"
    if found in {"and", ","} and tokens.at(here - 2) == "reach":
        return "a task reaches one region; for more, write `satisfy eventually A and eventually B`"
    return None


def _in_expression(tokens: Tokens, here: int, wanted: str) -> str | None:
    found = tokens.at(here)
    if wanted == "`%`" and "within" in map(tokens.at, range(max(0, here - 6), here)):
        return "`within` takes a percentage, as in `within 5 %`"
    if wanted == "`;` or `}`" and found in _COMPARISONS:
        return "an inequality has two sides: write two of them, with `;` between"
    if tokens.at(here - 1) == "polytope" or (wanted == "`;` or `}`" and found == ","):
        return _POLYTOPE
    if found == "," and wanted == "`]`":
        return "a list of values is in braces, as in `{30, 40, 50} cm`; `[a, b]` is a range"
    if found == "!=":
        return "write `not count(…) == …`"
    return None


def _elsewhere(tokens: Tokens, here: int, wanted: str) -> str | None:
    before, found = tokens.at(here - 1), tokens.at(here)
    if wanted == "`:`" and found == "->":
        return f"a production has a label before its left side, as in `label: {before} -> …;`"
    if wanted == "`(` or `.`" and found == "=":
        return f"an attribute belongs to a symbol: write `this.{before} = …;`"
    if wanted == "`(` or `.`":
        return "an attribute is written `this.frame = …;`, and a body `rod(frame: …, …);`"
    if found == "," and wanted.endswith("a name or a quoted string"):
        return "symbols stand one after the other, without commas"
    if before == "|" or found == "|":
        return "write a production of its own, with its own label, for each choice"
    return None
