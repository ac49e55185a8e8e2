"""Grammars for tests: random ones, and the families that grammar tools are known to fail on."""

from __future__ import annotations

from hypothesis import strategies as st

from grammar_lang import ir

EVERY = ir.AllOf(())
ARM_TERMINALS = ("B", "JO", "L", "EN", "eps")
ARM_MODULES = frozenset({"B", "JO", "L", "EN"})
ARM_ACCEPT = ir.AllOf((ir.Contains(("EN",)), ir.StartsWith(("B", "eps", "JO"))))


def grammar(
    text: str, terminals: tuple[str, ...], accept: ir.Accept = EVERY, name: str = "G"
) -> ir.Grammar:
    """``A -> x y | empty`` per line, labels p0, p1, ...; what is not in ``terminals`` is a
    nonterminal, the first left side is the start symbol."""
    productions: list[ir.Production] = []
    nonterminals: dict[str, None] = {}

    def symbol(token: str) -> ir.Symbol:
        if token in terminals:
            return ir.Symbol(token, "edge" if token in ("eps", "[", "]") else "module")
        nonterminals[token] = None
        return ir.Symbol(token, "nonterminal")

    for line in text.strip().splitlines():
        left, _, rights = line.partition("->")
        nonterminals[left.strip()] = None
        for right in rights.split("|"):
            symbols = tuple(symbol(token) for token in right.split() if token != "empty")
            productions.append(ir.Production(f"p{len(productions)}", left.strip(), symbols))
    start = next(iter(nonterminals))
    return ir.Grammar(name, start, tuple(nonterminals), tuple(productions), accept, None)


def arm(accept: ir.Accept = ARM_ACCEPT) -> ir.Grammar:
    """The running example."""
    return grammar("N -> B | N eps JO | N eps L | N eps EN", ARM_TERMINALS, accept, "PlanarArm")


ALPHABET = ("a", "b", "c")

# Each is a text for ``grammar`` over ``ALPHABET``.
TRAPS = {
    "left linear": "N -> a | N b | N b c",
    "right linear": "N -> a M | b\nM -> b N | c | a",
    "hidden left recursion": "S -> E S a | b\nE -> empty | c",
    "odd palindromes": "S -> a S a | a",
    "even palindromes": "S -> a S a | b S b | empty",
    "counted": "S -> a S b | empty",
    "branching": "T -> a | a b T c | a b T c b T c",
    "ambiguous": "E -> E b E | a",
    "unit cycle": "A -> A | B | a\nB -> A | b",
    "empty cycle": "A -> A A | empty | a",
    "useless": "S -> a | U b | S b\nU -> U a\nR -> a",
    "empty language": "S -> a S",
    "empty word only": "S -> T T\nT -> empty",
    "not LALR": "S -> a A a | b A b | a B b | b B a\nA -> c\nB -> c",
    "self and empty": "S -> S S S | a | empty",
    "nullable chain": "S -> A B C\nA -> a | empty\nB -> b | A | empty\nC -> c B | empty",
    "mutual left": "S -> T a | b\nT -> S c | T b | empty",
}


@st.composite
def random_grammars(draw: st.DrawFn, terminals: tuple[str, ...] = ("a", "b")) -> ir.Grammar:
    """Two or three nonterminals, right sides of up to three symbols, empty ones included."""
    nonterminals = ("S", "T", "U")[: draw(st.integers(2, 3))]
    symbols = st.sampled_from(
        [ir.Symbol(t, "module") for t in terminals]
        + [ir.Symbol(n, "nonterminal") for n in nonterminals]
    )
    rights = st.lists(symbols, max_size=3).map(tuple)
    productions: list[ir.Production] = []
    for name in nonterminals:
        productions += [
            ir.Production(f"{name}{i}", name, right)
            for i, right in enumerate(draw(st.lists(rights, min_size=1, max_size=4)))
        ]
    return ir.Grammar("G", "S", nonterminals, tuple(productions), draw(accepts(terminals)), None)


def regexes(terminals: tuple[str, ...]) -> st.SearchStrategy[ir.Regex]:
    """Regular expressions over one-character symbols."""
    leaves: st.SearchStrategy[ir.Regex] = st.one_of(
        st.sampled_from(terminals).map(ir.RSymbol), st.just(ir.REmpty())
    )
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.lists(inner, max_size=3).map(lambda p: ir.RSequence(tuple(p))),
            st.lists(inner, min_size=1, max_size=3).map(lambda p: ir.RChoice(tuple(p))),
            st.builds(ir.RRepeat, inner, st.sampled_from(("*", "+", "?"))),
        ),
        max_leaves=6,
    )


def accepts(terminals: tuple[str, ...]) -> st.SearchStrategy[ir.Accept]:
    """Accept conditions of every form."""
    words = st.lists(st.sampled_from(terminals), min_size=1, max_size=3).map(tuple)
    leaves: st.SearchStrategy[ir.Accept] = st.one_of(
        words.map(ir.Contains),
        words.map(ir.StartsWith),
        words.map(ir.EndsWith),
        st.builds(
            ir.Count,
            st.one_of(st.none(), st.sampled_from(terminals)),
            st.sampled_from(("<=", "<", ">=", ">", "==")),
            st.integers(-1, 4),
        ),
        regexes(terminals).map(ir.Matches),
        st.just(EVERY),
    )
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.lists(inner, max_size=3).map(lambda p: ir.AllOf(tuple(p))),
            st.lists(inner, max_size=3).map(lambda p: ir.AnyOf(tuple(p))),
            inner.map(ir.NotAccept),
        ),
        max_leaves=4,
    )
