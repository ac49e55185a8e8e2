"""Grammars of small families of arms, told twice: as text, and as all words of modules."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

Word = tuple[str, ...]
"""Modules without edges."""


@dataclass(frozen=True)
class Kinds:
    """The names of modules; ``most`` links stand on a joint."""

    bases: tuple[str, ...]
    joints: tuple[str, ...]
    links: tuple[str, ...]
    most: int


@dataclass(frozen=True)
class Condition:
    """What `accept` says besides the form of the word, and the same of the modules of a word."""

    text: str
    holds: Callable[[Word], bool]


@dataclass(frozen=True)
class Grammar:
    """A grammar: its text, with that of its semantics; its words; and how it spells one."""

    text: str
    words: tuple[Word, ...]
    spelled: Callable[[Word], str]


def conditions(kinds: Kinds) -> list[Condition]:
    """Conditions to choose from."""
    one, last = kinds.links[0], kinds.links[-1]
    return [
        Condition("", lambda _: True),
        Condition(f" and count({one}) <= 1", lambda w: w.count(one) <= 1),
        Condition(f" and contains {last}", lambda w: last in w),
        Condition(
            f" and (count({one}) == 1 or count({last}) >= 2)",
            lambda w: w.count(one) == 1 or w.count(last) >= 2,
        ),
        Condition(
            f" and not (count({last}) == 1 and count({one}) == 1)",
            lambda w: not (w.count(last) == 1 and w.count(one) == 1),
        ),
    ]


def _links(kinds: Kinds) -> Iterator[Word]:
    for size in range(1, kinds.most + 1):
        yield from product(kinds.links, repeat=size)


def chains(kinds: Kinds) -> Iterator[Word]:
    """A base, a joint, links and a hand."""
    for base, joint, links in product(kinds.bases, kinds.joints, list(_links(kinds))):
        yield base, joint, *links, "Hand"


def _chained(word: Word) -> str:
    return " eps ".join(word)


def below(kinds: Kinds, condition: Condition, blocks: Sequence[str], pairs: int = 1) -> Grammar:
    """Robots that grow at the hand, of joints with links; `accept` says which are meant."""
    rules = [f"b{n}: Arm -> {name};" for n, name in enumerate(kinds.bases)]
    rules += [f"p{name}: Arm -> Arm eps {name};" for name in (*kinds.joints, *kinds.links, "Hand")]
    bases, joints, links = (" | ".join(names) for names in (kinds.bases, kinds.joints, kinds.links))
    if pairs > 1:
        form = f"matches ({bases}) (eps ({joints}) eps ({links}))+ eps Hand"
        words = [
            (base, *(name for pair in some for name in pair), "Hand")
            for base in kinds.bases
            for size in range(1, pairs + 1)
            for some in product(product(kinds.joints, kinds.links), repeat=size)
        ]
    else:
        form = f"matches ({bases}) eps ({joints}) (eps ({links}))+ eps Hand"
        words = list(chains(kinds))
    text = _grammar("Arm", rules, f"accept {form}{condition.text};", blocks)
    return Grammar(text, tuple(w for w in words if condition.holds(w)), _chained)


def once(kinds: Kinds, blocks: Sequence[str]) -> Grammar:
    """Robots with every link once at most, in their order."""
    rules = [f"b{n}: Arm -> {name};" for n, name in enumerate(kinds.bases)]
    rules += [f"p{name}: Arm -> Arm eps {name};" for name in (*kinds.joints, *kinds.links, "Hand")]
    bases, joints = (" | ".join(names) for names in (kinds.bases, kinds.joints))
    links = " ".join(f"(eps {name})?" for name in kinds.links)
    some = " or ".join(f"contains {name}" for name in kinds.links)
    accept = f"accept matches ({bases}) eps ({joints}) {links} eps Hand and ({some});"
    words = [
        (base, joint, *(n for n, there in zip(kinds.links, which, strict=True) if there), "Hand")
        for base, joint in product(kinds.bases, kinds.joints)
        for which in product([False, True], repeat=len(kinds.links))
        if any(which)
    ]
    return Grammar(_grammar("Arm", rules, accept, blocks), tuple(words), _chained)


def above(kinds: Kinds, condition: Condition, blocks: Sequence[str]) -> Grammar:
    """Robots that are derived from the base; links end with a hand."""
    rules = [f"b{n}: R -> {name} eps A;" for n, name in enumerate(kinds.bases)]
    rules += [f"p{name}: A -> {name} eps S;" for name in kinds.joints]
    rules += [f"p{name}: S -> {name} eps S;" for name in kinds.links]
    rules += [f"q{name}: S -> {name} eps H;" for name in kinds.links]
    rules.append("hand: H -> Hand;")
    accept = f"accept contains Hand{condition.text};"
    words = tuple(w for w in chains(kinds) if condition.holds(w))
    return Grammar(_grammar("R", rules, accept, blocks), words, _chained)


def finite(kinds: Kinds, blocks: Sequence[str]) -> Grammar:
    """Robots of one or two links, of which there are finitely many without any bound."""
    rules = [f"b{n}: R -> {name} eps A;" for n, name in enumerate(kinds.bases)]
    rules += [f"p{name}: A -> {name} eps S;" for name in kinds.joints]
    rules += [f"p{name}: S -> {name} eps T;" for name in kinds.links]
    rules += [f"q{name}: S -> {name} eps H;" for name in kinds.links]
    rules += [f"r{name}: T -> {name} eps H;" for name in kinds.links]
    rules.append("hand: H -> Hand;")
    kinds = Kinds(kinds.bases, kinds.joints, kinds.links, 2)
    return Grammar(_grammar("R", rules, "", blocks), tuple(chains(kinds)), _chained)


def branches(kinds: Kinds, condition: Condition, blocks: Sequence[str]) -> Grammar:
    """Robots with two arms from one base."""
    rules = [
        f"b{n}: R -> {name} open left:A close open right:A close;"
        for n, name in enumerate(kinds.bases)
    ]
    rules += [f"p{name}: A -> {name} eps S;" for name in kinds.joints]
    rules += [f"p{name}: S -> {name} eps S;" for name in kinds.links]
    rules += [f"q{name}: S -> {name} eps H;" for name in kinds.links]
    rules.append("hand: H -> Hand;")
    longest = 2 * kinds.most - 1
    arms = [chain[1:] for chain in chains(Kinds(("",), kinds.joints, kinds.links, longest))]
    words = [
        (base, *one, *other)
        for base, one, other in product(kinds.bases, arms, arms)
        if len(one) + len(other) <= 2 * (kinds.most + 2)
    ]
    accept = f"accept contains Hand{condition.text};"
    kept = tuple(word for word in words if condition.holds(word))
    return Grammar(_grammar("R", rules, accept, blocks), kept, _branched)


def _branched(word: Word) -> str:
    cut = word.index("Hand") + 1
    one, other = word[1:cut], word[cut:]
    return f"{word[0]} open {_chained(one)} close open {_chained(other)} close"


def _grammar(start: str, rules: Sequence[str], accept: str, blocks: Sequence[str]) -> str:
    return "\n".join([
        f"grammar Arms {{ start {start};",
        *(f"  {rule}" for rule in rules),
        *([f"  {accept}"] if accept else []),
        "}",
        "semantics Arms {",
        *(f"  {block}" for block in blocks),
        "}",
    ])  # fmt: skip
