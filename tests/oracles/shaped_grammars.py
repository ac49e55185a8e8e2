"""Random grammars of a given shape, so that every way to read a grammar is met often."""

from __future__ import annotations

from hypothesis import strategies as st

from grammar_lang import ir
from tests.oracles.grammars import accepts, random_grammars

LETTERS = ("a", "b")
Rights = tuple[tuple[str, ...], ...]


@st.composite
def _of(
    draw: st.DrawFn, nonterminals: tuple[str, ...], rights: st.SearchStrategy[tuple[str, ...]]
) -> ir.Grammar:
    """One to four right sides per nonterminal, and any accept condition."""
    chosen = {n: draw(st.lists(rights, min_size=1, max_size=4)) for n in nonterminals}
    return _grammar({n: tuple(r) for n, r in chosen.items()}, draw(accepts(LETTERS)))


def _grammar(rights: dict[str, Rights], accept: ir.Accept) -> ir.Grammar:
    productions = tuple(
        ir.Production(f"{left}{i}", left, tuple(_symbol(name) for name in right))
        for left, sides in rights.items()
        for i, right in enumerate(sides)
    )
    return ir.Grammar("G", "S", tuple(rights), productions, accept, None)


def _symbol(name: str) -> ir.Symbol:
    return ir.Symbol(name, "module" if name in LETTERS else "nonterminal")


def _string(names: tuple[str, ...], most: int, least: int = 0) -> st.SearchStrategy[Rights]:
    return st.lists(st.sampled_from(names).map(lambda n: (n,)), min_size=least, max_size=most).map(
        tuple
    )


def _joined(*parts: st.SearchStrategy[Rights]) -> st.SearchStrategy[tuple[str, ...]]:
    return st.tuples(*parts).map(
        lambda found: tuple(name for part in found for one in part for name in one)
    )


THREE = ("S", "T", "U")
FOUR = ("S", "T", "U", "V")


def left_linear() -> st.SearchStrategy[ir.Grammar]:
    """``A -> B w | w``."""
    return _of(THREE, _joined(_string(THREE, 1), _string(LETTERS, 2)))


def right_linear() -> st.SearchStrategy[ir.Grammar]:
    """``A -> w B | w``."""
    return _of(THREE, _joined(_string(LETTERS, 2), _string(THREE, 1)))


def left_recursive() -> st.SearchStrategy[ir.Grammar]:
    """Most right sides begin with a nonterminal, also a nullable one: direct, mutual and hidden."""
    recursive = _joined(_string(FOUR, 2, 1), _string(LETTERS, 2))
    return _of(FOUR, st.one_of(recursive, recursive, _joined(_string(LETTERS, 2))))


def right_recursive() -> st.SearchStrategy[ir.Grammar]:
    """Most right sides end with nonterminals."""
    recursive = _joined(_string(LETTERS, 2), _string(THREE, 2, 1))
    return _of(THREE, st.one_of(recursive, recursive, _joined(_string(LETTERS, 2))))


def cyclic() -> st.SearchStrategy[ir.Grammar]:
    """Many unit and empty productions."""
    return _of(
        FOUR,
        st.one_of(
            _joined(_string(FOUR, 1)),
            _joined(_string(LETTERS, 1)),
            _joined(_string((*FOUR, *LETTERS), 3, 2)),
        ),
    )


@st.composite
def announced(draw: st.DrawFn) -> ir.Grammar:
    """No two right sides of a nonterminal begin with the same terminal: LL(1), so LR(1)."""
    rest = _joined(_string((*THREE, *LETTERS), 3))
    rights: dict[str, Rights] = {}
    for name in THREE:
        first = draw(st.sampled_from((("a",), ("b",), ("a", "b"), ("b", "a"))))
        rights[name] = tuple((letter, *draw(rest)) for letter in first)
    return _grammar(rights, draw(accepts(LETTERS)))


@st.composite
def useless(draw: st.DrawFn) -> ir.Grammar:
    """A grammar with a symbol that derives nothing, used everywhere, and one that is not used."""
    grammar = draw(random_grammars(LETTERS))
    barren = ir.Symbol("X", "nonterminal")
    more = [
        ir.Production("x0", "X", (barren, ir.Symbol("a", "module"))),
        ir.Production("y0", "Y", (ir.Symbol("b", "module"),)),
    ]
    for i, production in enumerate(grammar.productions):
        at = draw(st.integers(0, len(production.right)))
        right = (*production.right[:at], barren, *production.right[at:])
        more.append(ir.Production(f"{production.left}x{i}", production.left, right))
    return ir.Grammar(
        "G",
        "S",
        (*grammar.nonterminals, "X", "Y"),
        (*grammar.productions, *more),
        grammar.accept,
        None,
    )


SHAPES = {
    "any": random_grammars(LETTERS),
    "left linear": left_linear(),
    "right linear": right_linear(),
    "left recursive": left_recursive(),
    "right recursive": right_recursive(),
    "cyclic": cyclic(),
    "announced": announced(),
    "useless": useless(),
}
