"""Random programs that are syntactically valid, drawn from the rules of ``srg.lark`` itself.

They are not meant to pass any later check.  No alternative of a rule is rare among them.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import cache

from hypothesis import strategies as st
from lark import Lark
from lark.grammar import NonTerminal, Rule, Symbol
from lark.lexer import PatternStr

from grammar_lang.parsing.table_generator import parser
from tests.oracles.sentences import Sentences

NAMES = (
    "N", "m", "s", "kg", "A", "B1", "L", "JO", "eps", "at", "length_of_the_upper_arm", "_", "e3",
    "E", "N1", "xy_", "Ab", "mm", "a_rather_long_name_of_a_region_at_the_far_end_of_the_hall",
)  # fmt: skip
NUMBERS = ("0", "1", "2", "10", "0.5", "3.14159", "1e3", "2.5E-3", "1e+6", "00.10")
UNITS = ("m", "N", "N*m", "kg/m", "deg", "m/s^2", "kg*m^2", "s^-1", "rad/s", "Hz", "mm", "N*m/rad")
STRINGS = ("'['", '"]"', "'a b'", "'// no comment'", '"/* nor this */"', "'ü°'", "''", "'*'")
POOLS = {"NAME": NAMES, "NUMBER": NUMBERS, "UNIT": UNITS, "STRING": STRINGS}

ITEM_BUDGET = 70
"""So many rules are expanded at random in an item, before it takes the shortest way to its end."""


@cache
def grammar() -> Lark:
    """The language as lark reads it."""
    return parser()


@cache
def sentences() -> Sentences:
    """Its rules, and the shortest way out of each."""
    return Sentences(grammar())


@cache
def _literals() -> dict[str, str]:
    """The texts of the terminals that are no patterns."""
    terminals = grammar().terminals
    return {t.name: str(t.pattern.value) for t in terminals if isinstance(t.pattern, PatternStr)}


@cache
def _ways() -> dict[str, tuple[Rule, ...]]:
    """Per nonterminal a shortest chain of rules from an item to it."""
    ways: dict[str, tuple[Rule, ...]] = {"item": ()}
    waiting = ["item"]
    for name in waiting:
        for rule in sentences().rules[name]:
            for symbol in rule.expansion:
                if isinstance(symbol, NonTerminal) and symbol.name not in ways:
                    ways[symbol.name] = (*ways[name], rule)
                    waiting.append(symbol.name)
    return ways


def _planned(rule: Rule, plan: tuple[Rule, ...]) -> list[tuple[Symbol, tuple[Rule, ...]]]:
    """The symbols of a rule; the first that a plan can go on with has the plan."""
    found: list[tuple[Symbol, tuple[Rule, ...]]] = []
    for symbol in rule.expansion:
        here = bool(plan) and symbol == plan[0].origin
        found.append((symbol, plan if here else ()))
        plan = () if here else plan
    return found


def random_item(choose: random.Random, used: set[Rule]) -> list[str]:
    """The texts of the tokens of one item; the rules of its derivation are added to ``used``.

    Its derivation goes by way of a rule that is drawn first, so that no rule is rare.
    """
    drawn, literals = sentences(), _literals()
    goal = choose.choice(grammar().rules)
    waiting: list[tuple[Symbol, tuple[Rule, ...]]] = [
        (NonTerminal("item"), (*_ways()[goal.origin.name], goal))
    ]
    texts: list[str] = []
    budget = ITEM_BUDGET
    while waiting:
        symbol, plan = waiting.pop()
        if not isinstance(symbol, NonTerminal):
            pool = POOLS.get(symbol.name)
            if texts[-1:] == ["horizon"] and pool is NAMES:
                pool = tuple(name for name in NAMES if name != "at")  # There it begins `at most`.
            texts.append(literals[symbol.name] if pool is None else choose.choice(pool))
            continue
        rules = drawn.rules[symbol.name]
        budget -= 1
        if plan:
            rule = plan[0]
        else:
            rule = choose.choice(rules) if budget > 0 else min(rules, key=drawn._depth)
        used.add(rule)
        waiting += reversed(_planned(rule, plan[1:]))
    return texts


def random_tokens(choose: random.Random, size: int, used: set[Rule] | None = None) -> list[str]:
    """The texts of the tokens of a program of ``size`` items."""
    used = set() if used is None else used
    return [text for _ in range(size) for text in random_item(choose, used)]


def random_program(choose: random.Random, size: int) -> str:
    """A program of ``size`` items; blanks part its tokens, also a number and its unit."""
    return " ".join(random_tokens(choose, size))


COMMENTS = (
    "// line", "// blanks at its end  \t", "//", "/**/", "/* block */", "/* two\n   lines  \n*/",
    "/* a * b / c; } */", "// /* not open", "//* odd", "/***/", "// é °", "/* crlf \r\n lf */",
    "// 'not a string", "/* \" nor this */",
)  # fmt: skip
BLANKS = (" ", "  ", "\t", "\n", "\n", "\n\n", "\n \n\n", "\r\n", " \f ")


def random_gap(choose: random.Random, comments: float) -> str:
    """Blanks and line breaks, and comments with a probability; never empty."""
    parts = []
    for _ in range(choose.randrange(1, 4)):
        if choose.random() < comments:
            comment = choose.choice(COMMENTS)
            parts.append(comment + choose.choice(("\n", "\r\n")) * comment.startswith("//"))
        else:
            parts.append(choose.choice(BLANKS))
    return "".join(parts)


def scattered(choose: random.Random, texts: Sequence[str], comments: float) -> str:
    """Tokens with a random gap before each and at the end; a ``/`` has a blank after it."""
    parts = []
    for text in texts:
        parts += [random_gap(choose, comments), text, " " * (text == "/")]
    end = choose.choice(("", "\n", "  ", "\n\n\n", "// end", "/* end */", "\n// end\n\n"))
    return "".join((*parts, end if comments else ""))


def programs(max_size: int = 6) -> st.SearchStrategy[str]:
    """Programs of up to so many items."""
    seeds = st.integers(0, 2**32 - 1).map(random.Random)
    return st.builds(random_program, seeds, st.integers(1, max_size))
