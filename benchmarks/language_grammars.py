"""Six grammars, words of a given length that they derive, and near misses.

Every word is judged by an oracle written for its language alone: a regular expression, or a scan
with a counter or a stack.  Words are drawn with a fixed seed, so that all runs read the same.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

from grammar_lang import ir

Word = tuple[str, ...]
SEED = 1
EDGES = ("eps", "[", "]")
Oracle = Callable[[Word], bool]
Draw = Callable[[random.Random, int], Word | None]


@dataclass(frozen=True)
class Subject:
    """A grammar to be measured; ``draw`` gives a word of a length, or None where it has none."""

    name: str
    what: str
    grammar: ir.Grammar
    terminals: Word
    oracle: Oracle
    draw: Draw

    @property
    def modules(self) -> frozenset[str]:
        """The terminals that are no edges."""
        return frozenset(self.terminals) - frozenset(EDGES)


def grammar(name: str, terminals: str, rules: str) -> ir.Grammar:
    """``A -> x y | empty`` per line; what is no terminal is a nonterminal, the first the start."""
    letters = terminals.split()
    productions: list[ir.Production] = []
    for left, rights in (line.split("->") for line in rules.strip().splitlines()):
        for right in rights.split("|"):
            tokens = [token for token in right.split() if token != "empty"]
            symbols = tuple(ir.Symbol(token, _kind(token, letters)) for token in tokens)
            productions.append(ir.Production(f"p{len(productions)}", left.strip(), symbols))
    nonterminals = tuple(dict.fromkeys(production.left for production in productions))
    every = ir.AllOf(())
    return ir.Grammar(name, nonterminals[0], nonterminals, tuple(productions), every, None)


def _kind(token: str, letters: list[str]) -> ir.SymbolKind:
    if token not in letters:
        return "nonterminal"
    return "edge" if token in EDGES else "module"


def accepted(subject: Subject, length: int, count: int) -> list[Word]:
    """Up to ``count`` distinct words of the least length from ``length`` on that there is."""
    rng = random.Random(f"{SEED} {subject.name} {length} accepted")
    while subject.draw(rng, length) is None:
        length += 1
    found: dict[Word, None] = {}
    for _ in range(20 * count):
        word = subject.draw(rng, length)
        if word is None or len(word) != length or not subject.oracle(word):
            raise ValueError(f"{subject.name}: not a word of its language: {word}")
        found[word] = None
        if len(found) == count:
            break
    return list(found)


def refused(subject: Subject, length: int, count: int) -> list[Word]:
    """Up to ``count`` distinct words that differ in one symbol from an accepted word of ``length``.

    In turn the symbol is among the last tenth, in the middle, the last one (missing or replaced),
    or among the first tenth: those that take longest come first.
    """
    rng = random.Random(f"{SEED} {subject.name} {length} refused")
    origins = accepted(subject, length, count)
    kinds = _mutations(subject, rng)
    found: dict[Word, None] = {}
    for attempt in range(400 * count):
        word = kinds[len(found) % len(kinds)](origins[attempt % len(origins)])
        if word is not None and not subject.oracle(word):
            found[word] = None
            if len(found) == count:
                break
    return list(found)


def _mutations(subject: Subject, rng: random.Random) -> tuple[Callable[[Word], Word | None], ...]:
    def replaced(word: Word, place: int) -> Word:
        other = rng.choice([t for t in subject.terminals if t != word[place]])
        return (*word[:place], other, *word[place + 1 :])

    def within(first: float, last: float) -> Callable[[Word], Word]:
        def change(word: Word) -> Word:
            places = range(int(first * len(word)), max(int(last * len(word)), 1))
            return replaced(word, rng.choice(places or range(len(word))))

        return change

    def wrong_end(word: Word) -> Word:
        return word[:-1] if rng.random() < 0.5 else replaced(word, len(word) - 1)

    return within(0.9, 1), within(0.4, 0.6), wrong_end, within(0, 0.1)


# --- finite automata ------------------------------------------------------------------------------


def _pattern(expression: str) -> Oracle:
    compiled = re.compile(expression)
    return lambda word: compiled.fullmatch(" ".join(word)) is not None


def _draw_paper(rng: random.Random, length: int) -> Word | None:
    if length % 2 == 0:
        return None
    return ("B", *(t for _ in range(length // 2) for t in ("eps", rng.choice(("JO", "L", "EN")))))


RIGHT_LINEAR = """
S -> B T
T -> eps JO U | eps SL U | eps EN | eps GR
U -> eps L T | eps M T | eps EN | eps GR
"""


def _draw_right_linear(rng: random.Random, length: int) -> Word | None:
    if length % 2 == 0 or length < 3:
        return None
    pairs, tools = divmod(length - 1, 4)
    word = ["B"]
    for _ in range(pairs if tools else pairs - 1):
        word += ["eps", rng.choice(("JO", "SL")), "eps", rng.choice(("L", "M"))]
    if not tools:
        word += ["eps", rng.choice(("JO", "SL"))]
    return (*word, "eps", rng.choice(("EN", "GR")))


# --- deterministic pushdown automata --------------------------------------------------------------


def is_branching(word: Word) -> bool:
    """``B``, then segments; ``[`` opens a branch, a tool ends the branch or the trunk."""
    depth, i = 0, 1
    if word[:1] != ("B",):
        return False
    while i < len(word):
        pair = word[i : i + 2]
        if word[i] == "[":
            depth, i = depth + 1, i + 1
        elif pair in (("eps", "JO"), ("eps", "L")):
            i += 2
        elif pair == ("eps", "EN") and depth == 0:
            return i + 2 == len(word)
        elif pair == ("eps", "EN") and word[i + 2 : i + 3] == ("]",):
            depth, i = depth - 1, i + 3
        else:
            return False
    return False


def _draw_branching(rng: random.Random, length: int) -> Word | None:
    """Trees of even size: a tool of 2, a segment more, or a branch in brackets and the rest."""
    if length % 2 == 0 or length < 3:
        return None
    word = ["B"]
    todo: list[str | int] = [length - 1]
    while todo:
        rest = todo.pop()
        if isinstance(rest, str):
            word.append(rest)
        elif rest == 2:
            word += ["eps", "EN"]
        elif rest < 6 or rng.random() < 0.7:
            word += ["eps", rng.choice(("JO", "L"))]
            todo.append(rest - 2)
        else:
            inner = 2 * rng.randint(1, rest // 2 - 2)
            word.append("[")
            todo += [rest - 2 - inner, "]", inner]
    return tuple(word)


PARTNER = {"JO": "L", "SL": "M"}


def is_matched(word: Word) -> bool:
    """Joints, then the links that belong to them, mirrored; at least one pair."""
    half = len(word) // 2
    if len(word) % 2 or not half or any(joint not in PARTNER for joint in word[:half]):
        return False
    return word[half:] == tuple(PARTNER[joint] for joint in reversed(word[:half]))


def _draw_matched(rng: random.Random, length: int) -> Word | None:
    if length % 2 or not length:
        return None
    joints = [rng.choice(("JO", "SL")) for _ in range(length // 2)]
    return (*joints, *(PARTNER[joint] for joint in reversed(joints)))


# --- ambiguous grammars ---------------------------------------------------------------------------


def is_expression(word: Word) -> bool:
    """Operand and operator take turns; brackets balance."""
    depth, operand = 0, False
    for token in word:
        if token in ("(", "id") if operand else token not in ("(", "id"):
            return False
        depth += (token == "(") - (token == ")")
        if depth < 0:
            return False
        operand = token in ("id", ")")
    return operand and depth == 0


def _draw_expression(rng: random.Random, length: int) -> Word | None:
    if length % 2 == 0:
        return None
    word: list[str] = []
    todo: list[str | int] = [length]
    while todo:
        rest = todo.pop()
        if isinstance(rest, str):
            word.append(rest)
        elif rest == 1:
            word.append("id")
        elif rng.random() < 0.25:
            todo += [")", rest - 2, "("]
        else:
            left = 2 * rng.randrange((rest - 1) // 2) + 1
            todo += [rest - 1 - left, rng.choice("+*"), left]
    return tuple(word)


CHAIN = 60
CHAIN_LETTERS = "abcd"
CHAIN_ITEMS = tuple(
    CHAIN_LETTERS[i % 4] + (CHAIN_LETTERS[(i + 1) % 4] if i % 3 == 0 else "")
    for i in reversed(range(CHAIN - 2))
)
"""What follows the groups of a level: some of these, in this order, one letter or two each."""


def chain_rules() -> str:
    """N0 to N57 may add an item each; N58 is at most two groups, a group is (N0) or nothing.

    No nonterminal derives itself alone; a word may have very many derivations.
    """
    items = enumerate(reversed(CHAIN_ITEMS))
    links = [f"N{i} -> N{i + 1} | N{i + 1} {' '.join(item)}" for i, item in items]
    return "\n".join([*links, "N58 -> N59 N59", "N59 -> ( N0 ) | empty"])


def is_chain(word: Word) -> bool:
    """Per level the groups, and the numbers of items that its letters may have used up so far.

    The numbers are bits; the second set is of those whose last item has its second letter to come.
    """
    levels = [(0, 1, 0)]
    for token in word:
        groups, ended, half = levels[-1]
        if token == "(":
            if ended != 1 or half or groups == 2:
                return False
            levels.append((0, 1, 0))
        elif token == ")":
            levels.pop()
            if (half and not ended) or not levels:
                return False
            groups, ended, half = levels[-1]
            levels[-1] = (groups + 1, ended, half)
        else:
            after = _after_letter(token, ended, half)
            if after == (0, 0):
                return False
            levels[-1] = (groups, *after)
    return len(levels) == 1 and levels[0][1] != 0


@cache
def _after_letter(letter: str, ended: int, half: int) -> tuple[int, int]:
    """One letter more: it ends the item begun, or is the first of an item not yet reached."""
    now, begun, reachable = 0, 0, False
    for number, item in enumerate(CHAIN_ITEMS, 1):
        reachable = reachable or bool(ended >> (number - 1) & 1)
        if reachable and item == letter:
            now |= 1 << number
        elif reachable and item[0] == letter:
            begun |= 1 << number
        if half >> number & 1 and item[1] == letter:
            now |= 1 << number
    return now, begun


def _draw_chain(rng: random.Random, length: int) -> Word | None:
    word: list[str] = []
    todo: list[str | int] = [length]
    while todo:
        rest = todo.pop()
        if isinstance(rest, str):
            word.append(rest)
            continue
        letters = _draw_items(rng, rest)
        todo += reversed(letters)
        inside = rest - len(letters) - 2
        if inside >= 2 and rng.random() < 0.5:
            second = rng.randint(0, inside - 2)
            todo += [")", second, "("]
            inside -= second + 2
        if inside >= 0:
            todo += [")", inside, "("]
    return tuple(word)


def _draw_items(rng: random.Random, rest: int) -> str:
    """Letters of some items in order; they leave nothing of the rest, or room for two brackets."""
    most = min(rest, rng.choice((0, 1, 2, 3, 5, 8, 13, 30, 2 * len(CHAIN_ITEMS))))
    chosen: list[int] = []
    size = 0
    for place in rng.sample(range(len(CHAIN_ITEMS)), len(CHAIN_ITEMS)):
        if size + len(CHAIN_ITEMS[place]) <= most:
            chosen.append(place)
            size += len(CHAIN_ITEMS[place])
    if rest - size == 1:
        singles = [place for place, item in enumerate(CHAIN_ITEMS) if len(item) == 1]
        spare = [place for place in singles if place in chosen][:1]
        chosen = [p for p in chosen if p not in spare] if spare else [*chosen, singles[0]]
    return "".join(CHAIN_ITEMS[place] for place in sorted(chosen))


def subjects() -> Iterator[Subject]:
    """The six, in the order of the report."""
    for name, what, terminals, rules, oracle, draw in _SUBJECTS:
        read = grammar(name, terminals, rules)
        yield Subject(name, what, read, tuple(terminals.split()), oracle, draw)


_SUBJECTS: tuple[tuple[str, str, str, str, Oracle, Draw], ...] = (
    (
        "paper",
        "left-linear, the running example: N -> B | N eps JO | N eps L | N eps EN",
        "B JO L EN eps",
        "N -> B | N eps JO | N eps L | N eps EN",
        _pattern(r"B( eps (JO|L|EN))*"),
        _draw_paper,
    ),
    (
        "right-linear",
        "joints of two kinds and links of two kinds take turns, a tool ends",
        "B JO SL L M EN GR eps",
        RIGHT_LINEAR,
        _pattern(r"B( eps (JO|SL) eps (L|M))*( eps (JO|SL))? eps (EN|GR)"),
        _draw_right_linear,
    ),
    (
        "branching",
        "LR(1): S -> B T, T -> eps JO T | eps L T | eps EN | [ T ] T",
        "B JO L EN eps [ ]",
        "S -> B T\nT -> eps JO T | eps L T | eps EN | [ T ] T",
        is_branching,
        _draw_branching,
    ),
    (
        "matched",
        "LR(1), linear, not regular: P -> JO P L | SL P M | JO L | SL M",
        "JO SL L M",
        "P -> JO P L | SL P M | JO L | SL M",
        is_matched,
        _draw_matched,
    ),
    (
        "ambiguous",
        "E -> E + E | E * E | ( E ) | id",
        "id + * ( )",
        "E -> E + E | E * E | ( E ) | id",
        is_expression,
        _draw_expression,
    ),
    (
        "chain",
        "60 nonterminals, ambiguous: Ni -> Ni+1 | Ni+1 x (y), N58 -> N59 N59, N59 -> (N0) | empty",
        "( ) a b c d",
        chain_rules(),
        is_chain,
        _draw_chain,
    ),
)
