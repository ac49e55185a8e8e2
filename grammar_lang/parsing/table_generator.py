"""Compile ``srg.lark`` into the tables of the parser with lark, at development time.

At run time the parser then needs neither lark nor the seconds to build its tables.
``make grammar`` runs this file; a test compares its result with ``tables.json``.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from lark import Lark
    from lark.grammar import Rule, Symbol

FOLDER = Path(__file__).parent

Row: TypeAlias = dict[str, int]
Reduction: TypeAlias = dict[str, str | int | bool | list[int] | list[bool]]


def parser() -> Lark:
    """Lark's own parser for the grammar: LALR(1) with a contextual lexer."""
    from lark import Lark

    return Lark(
        (FOLDER / "srg.lark").read_text(encoding="utf-8"),
        start="item",
        parser="lalr",
        lexer="contextual",
        propagate_positions=True,
        maybe_placeholders=True,
    )


def _kept(rule: Rule, symbol: Symbol) -> bool:
    return rule.options.keep_all_tokens or not (symbol.is_term and vars(symbol)["filter_out"])


def _reduction(rule: Rule) -> Reduction:
    """How a rule makes its value from the values of its symbols, as in lark's tree builder.

    ``keep`` are positions of children, -1 for an absent optional one; a child that is an unnamed
    repetition is spliced in.
    """
    keep: list[int] = []
    splice: list[bool] = []
    absent = rule.options.empty_indices or (False,) * (len(rule.expansion) + 1)
    places = iter(range(len(rule.expansion)))
    for missing in absent:
        if missing:
            keep.append(-1)
            splice.append(False)
            continue
        place = next(places, None)
        if place is not None and _kept(rule, rule.expansion[place]):
            keep.append(place)
            symbol = rule.expansion[place]
            splice.append(not symbol.is_term and symbol.name.startswith("__"))
    origin = str(rule.origin.name)
    return {
        "origin": origin,
        "size": len(rule.expansion),
        "builder": "" if origin.startswith("__") else str(rule.alias or origin),
        "keep": keep,
        "splice": splice,
        "transparent": bool(rule.options.expand1 and not rule.alias),
    }


def _name(entry: tuple[object, object]) -> str:
    return str(entry[0])


def tables() -> str:
    """The tables as JSON text.

    A terminal is named by its text, or by its name if it is a pattern.  For each state, ``actions``
    maps a terminal to the next state, or to ``-1 - k`` for the reduction by rule ``k``; ``gotos``
    maps the name of a rule to the next state.
    """
    from lark.lexer import PatternStr
    from lark.parsers.lalr_analysis import Shift

    made = parser()
    table = vars(vars(made.parser)["parser"])["_parse_table"]
    called = {
        t.name: str(t.pattern.value) if isinstance(t.pattern, PatternStr) else t.name
        for t in made.terminals
    }
    reductions = [_reduction(rule) for rule in made.rules]
    origins = {reduction["origin"] for reduction in reductions}
    texts = [json.dumps(reduction) for reduction in reductions]
    order = sorted(range(len(texts)), key=lambda k: texts[k])
    numbers = {made.rules[k]: index for index, k in enumerate(order)}
    # lark's state numbers vary; numbering in order of discovery keeps the file the same.
    found = {table.start_states["item"]: 0}
    actions: list[Row] = []
    gotos: list[Row] = []
    for state in (waiting := list(found)):
        action: Row = {}
        goto: Row = {}
        for symbol, (kind, target) in sorted(table.states[state].items(), key=_name):
            if kind is Shift and target not in found:
                found[target] = len(found)
                waiting.append(target)
            name = str(symbol)
            row = goto if name in origins else action
            row[called.get(name, name)] = found[target] if kind is Shift else -1 - numbers[target]
        actions.append(action)
        gotos.append(goto)
    content = {
        "end": found[table.end_states["item"]],
        "words": sorted(text for text in called.values() if text[0].islower()),
        "rules": [reductions[k] for k in order],
        "actions": actions,
        "gotos": gotos,
    }
    return json.dumps(content, separators=(",", ":")) + "\n"


def main() -> None:
    """Write the tables next to the grammar."""
    (FOLDER / "tables.json").write_text(tables(), encoding="utf-8")


if __name__ == "__main__":
    main()
