"""Derivations: the structures of robots (Definition 3; a structure is a derivation, not a word).

A leftmost derivation is given by the labels of its productions; ``replay`` checks one.  All
derivations of a word come from a chart of the word's factors (Cocke, Younger, Kasami, with bit
sets for the starts and rules of any length) and a leftmost search that the chart keeps from ever
entering a dead end.  Nothing here is recursive in the length of the word.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from compiler.grammars.grammar import Srg, cyclic, nullable, trimmed, useful_rules
from compiler.languages.language import Language
from grammar_lang import ir


class BadDerivation(ValueError):
    """Labels that are not a leftmost derivation of a word from the start symbol."""


class InfiniteAmbiguityError(ValueError):
    """A grammar with a derivation A =>+ A, whose words may have infinitely many derivations."""

    def __init__(self, nonterminals: tuple[str, ...]) -> None:
        super().__init__(
            f"{nonterminals[0]} derives itself, so a word may have infinitely many derivations"
        )
        self.nonterminals = nonterminals


@dataclass(frozen=True, slots=True)
class DerivationNode:
    """One application of a production.

    ``children`` has one entry per symbol of the right side: for a terminal its index in the word,
    for a nonterminal the index of its node.
    """

    production: ir.Production
    children: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Derivation:
    """A derivation tree; ``nodes`` in leftmost order (pre-order), node 0 derives the start."""

    word: tuple[str, ...]
    nodes: tuple[DerivationNode, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """The leftmost derivation as labels of productions."""
        return tuple(node.production.label for node in self.nodes)

    def spans(self) -> list[tuple[int, int]]:
        """Per node, the positions in the word between which stands what it derives."""
        inner = [
            [
                child
                for child, symbol in zip(node.children, node.production.right, strict=True)
                if symbol.kind == "nonterminal"
            ]
            for node in self.nodes
        ]
        length = [0] * len(self.nodes)
        for i in range(len(self.nodes) - 1, -1, -1):
            terminals = len(self.nodes[i].children) - len(inner[i])
            length[i] = terminals + sum(length[child] for child in inner[i])
        begin = [0] * len(self.nodes)
        for i, node in enumerate(self.nodes):
            place, following = begin[i], iter(inner[i])
            for symbol in node.production.right:
                if symbol.kind != "nonterminal":
                    place += 1
                    continue
                child = next(following)
                begin[child] = place
                place += length[child]
        return [(b, b + n) for b, n in zip(begin, length, strict=True)]


def replay(grammar: ir.Grammar, labels: Iterable[str]) -> Derivation:
    """The derivation with these labels, leftmost, from the start symbol.

    The accept condition is not looked at.

    Raises:
        BadDerivation: an unknown label, a production of another nonterminal than the leftmost,
            too few labels or too many.
    """
    by_label = {production.label: production for production in grammar.productions}
    productions: list[ir.Production] = []
    for label in labels:
        if label not in by_label:
            raise BadDerivation(f"grammar {grammar.name} has no production {label!r}")
        productions.append(by_label[label])
    return _tree(grammar.start, productions)


def _tree(start: str, productions: Sequence[ir.Production]) -> Derivation:
    word: list[str] = []
    children: list[list[int]] = []
    todo = [ir.Symbol(start, "nonterminal")]
    parents: list[list[int] | None] = [None]
    while todo:
        symbol, siblings = todo.pop(), parents.pop()
        if symbol.kind != "nonterminal":
            if siblings is not None:
                siblings.append(len(word))
            word.append(symbol.name)
            continue
        step = len(children)
        if step == len(productions):
            raise BadDerivation(f"the derivation stops before {symbol.name} is replaced")
        production = productions[step]
        if production.left != symbol.name:
            raise BadDerivation(
                f"step {step + 1}: {production.label} replaces {production.left}, "
                f"but the leftmost nonterminal is {symbol.name}"
            )
        if siblings is not None:
            siblings.append(step)
        own: list[int] = []
        children.append(own)
        todo += reversed(production.right)
        parents += [own] * len(production.right)
    if len(children) < len(productions):
        rest = productions[len(children)].label
        raise BadDerivation(
            f"{rest} is left over: the word is complete after {len(children)} steps"
        )
    nodes = (DerivationNode(p, tuple(c)) for p, c in zip(productions, children, strict=True))
    return Derivation(tuple(word), tuple(nodes))


def derivations_of(language: Language, word: Sequence[str]) -> Iterator[Derivation]:
    """All derivations of a word of the language, ordered by production sequence.

    Productions compare in order of declaration.  A word that is not in the language has none.

    Raises:
        InfiniteAmbiguityError: at once, where the grammar has a useful derivation A =>+ A.
    """
    _refuse_cycles(language.srg)
    codes = language.srg.encode(word)
    if codes is None or not language.accept.accepts(word):
        return iter(())
    return _all(language.srg, _Chart(language.srg), codes)


def structures(language: Language, max_modules: int) -> Iterator[Derivation]:
    """All derivations of all words with at most ``max_modules`` modules, lazily.

    Ordered by word (length, then symbols in order of declaration), then by production sequence.
    The empty word is no robot.  Where edges alone repeat without bound there are infinitely many:
    see ``Language.is_finite``.

    Raises:
        InfiniteAmbiguityError: at once, where the grammar has a useful derivation A =>+ A.
    """
    _refuse_cycles(language.srg)
    return _structures(language, max_modules)


def _structures(language: Language, max_modules: int) -> Iterator[Derivation]:
    chart = _Chart(language.srg)
    for word in language.words(max_modules=max_modules):
        codes = language.srg.encode(word)
        if codes:
            yield from _all(language.srg, chart, codes)


def _refuse_cycles(srg: Srg) -> None:
    loops = cyclic(trimmed(srg.cfg))
    if loops:
        raise InfiniteAmbiguityError(srg.names(loops))


def _all(srg: Srg, chart: _Chart, codes: tuple[int, ...]) -> Iterator[Derivation]:
    chart.read(codes)
    for sequence in _leftmost(srg, chart):
        yield _tree(srg.start, [srg.productions[r] for r in sequence])


class _Chart:
    """Which nonterminals derive which factors of a word; consecutive words share their prefix.

    ``starts[A][j]`` is the bit set of the positions i such that A derives word[i:j];
    ``partial[r, k][j]`` the same for the first k > 0 symbols of the right side of rule r.
    """

    def __init__(self, srg: Srg) -> None:
        cfg = trimmed(srg.cfg)
        self.first = cfg.terminals
        self.useful = useful_rules(srg.cfg)
        self.rules = {r: srg.cfg.rules[r] for r in self.useful}
        self.word: list[int] = []
        self.masks: list[int] = [0] * cfg.terminals
        self.starts: list[list[int]] = [[] for _ in range(cfg.nonterminals)]
        self.partial: dict[tuple[int, int], list[int]] = {}
        self._reading: list[list[tuple[int, int]]] = [[] for _ in range(cfg.terminals)]
        self._using: list[list[tuple[int, int]]] = [[] for _ in range(cfg.nonterminals)]
        self._empty: list[tuple[int, int]] = []
        self._nullable = nullable(cfg)
        for r, (_, right) in self.rules.items():
            open_prefix = True
            if not right:
                self._empty.append((r, 0))
            for k, symbol in enumerate(right):
                self.partial[r, k + 1] = []
                open_prefix = open_prefix and symbol in self._nullable
                if open_prefix:
                    self._empty.append((r, k + 1))
                table, s = (
                    (self._reading, symbol)
                    if symbol < self.first
                    else (self._using, symbol - self.first)
                )
                table[s].append((r, k))
        self._column()

    def read(self, word: tuple[int, ...]) -> None:
        """Make the chart that of ``word``, keeping the columns of the common prefix."""
        common = 0
        while common < min(len(word), len(self.word)) and word[common] == self.word[common]:
            common += 1
        for table in (*self.starts, *self.partial.values()):
            del table[common + 1 :]
        del self.word[common:]
        kept = (1 << common) - 1
        self.masks = [mask & kept for mask in self.masks]
        for symbol in word[common:]:
            self.masks[symbol] |= 1 << len(self.word)
            self.word.append(symbol)
            self._column()

    def before(self, symbol: int, ends: int, least: int) -> int:
        """The i >= least such that the symbol derives word[i:j] for some j of ``ends``."""
        if symbol < self.first:
            found = (ends >> 1) & self.masks[symbol]
        else:
            column = self.starts[symbol - self.first]
            ends = ends >> least << least
            found = 0
            while ends:
                low = ends & -ends
                found |= column[low.bit_length() - 1]
                ends ^= low
        return found >> least << least

    def _column(self) -> None:
        """Append the column of the last position: a least fixpoint, each new bit handled once."""
        j = len(self.word)
        for table in (*self.starts, *self.partial.values()):
            table.append(0)
        todo = [(r, k, 1 << j) for r, k in self._empty]
        if j:
            for r, k in self._reading[self.word[-1]]:
                todo.append((r, k + 1, self.partial[r, k][j - 1] if k else 1 << (j - 1)))
        while todo:
            r, k, bits = todo.pop()
            left, right = self.rules[r]
            if k:
                row = self.partial[r, k]
                bits &= ~row[j]
                row[j] |= bits
            if not bits:
                continue
            if k == len(right):
                self._derived(left - self.first, bits, j, todo)
            elif right[k] in self._nullable:
                todo.append((r, k + 1, bits))

    def _derived(self, k: int, bits: int, j: int, todo: list[tuple[int, int, int]]) -> None:
        """Nonterminal number k derives word[i:j] for the i in ``bits``: tell its users."""
        bits &= ~self.starts[k][j]
        self.starts[k][j] |= bits
        if not bits:
            return
        for r, dot in self._using[k]:
            if dot == 0:
                todo.append((r, 1, bits))
                continue
            row, found, rest = self.partial[r, dot], 0, bits & ~(1 << j)
            while rest:
                low = rest & -rest
                found |= row[low.bit_length() - 1]
                rest ^= low
            todo.append((r, dot + 1, found))


@dataclass(frozen=True, slots=True, eq=False)
class _Stack:
    """Symbols still to be derived; ``starts``: from which positions they derive the rest."""

    symbol: int
    below: _Stack | None
    starts: int


def _leftmost(srg: Srg, chart: _Chart) -> Iterator[tuple[int, ...]]:
    """The leftmost derivations of the chart's word as rule numbers, in lexicographic order."""
    end = len(chart.word)
    start = chart.before(srg.cfg.start, 1 << end, 0)
    if not start & 1:
        return
    by_left: dict[int, list[int]] = {}
    for r in chart.useful:
        by_left.setdefault(chart.rules[r].left, []).append(r)
    sequence: list[int] = []
    choices = [(0, _Stack(srg.cfg.start, None, start), iter(by_left[srg.cfg.start]))]
    while choices:
        position, top, rules = choices[-1]
        del sequence[len(choices) - 1 :]
        chosen = next(rules, None)
        if chosen is None:
            choices.pop()
            continue
        pushed = _push(chart, chart.rules[chosen].right, top.below, position)
        if not (1 << end if pushed is None else pushed.starts) >> position & 1:
            continue
        sequence.append(chosen)
        while pushed is not None and pushed.symbol < chart.first:
            pushed = pushed.below
            position += 1
        if pushed is None:
            yield tuple(sequence)
        else:
            choices.append((position, pushed, iter(by_left[pushed.symbol])))


def _push(
    chart: _Chart, right: tuple[int, ...], below: _Stack | None, position: int
) -> _Stack | None:
    """The right side on top of the symbols below; ``below`` itself where it is empty."""
    stack = below
    for symbol in reversed(right):
        ends = 1 << len(chart.word) if stack is None else stack.starts
        stack = _Stack(symbol, stack, chart.before(symbol, ends, position))
    return stack
