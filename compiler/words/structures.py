"""The derivations of a word, and the structures of a robot family: all derivations of all words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from compiler.time_limits.time_limit import check_time
from compiler.words.derivation import Derivation, tree
from compiler.words.grammar import Srg, cyclic, nullable, trimmed, useful_rules
from compiler.words.language import Language
from compiler.words.lr_automaton import LrAutomaton, leftmost_derivation

# --- The factors of a word that nonterminals derive, and all its derivations ----------------------
#
# The chart is that of Cocke, Younger and Kasami, with bit sets for the starts and rules of any
# length.  The leftmost search that uses it never enters a dead end.  Nothing is recursive in the
# length of the word.


class Chart:
    """The factors of a word that each nonterminal derives; consecutive words share their prefix.

    ``starts[A][j]`` is the bit set of the positions i such that A derives word[i:j];
    ``partial[r, k][j]`` is the same for the first k > 0 symbols of the right side of rule r.
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
        """Compute the chart of ``word``, keeping the columns of the common prefix."""
        common = 0
        while common < min(len(word), len(self.word)) and word[common] == self.word[common]:
            common += 1
        for table in (*self.starts, *self.partial.values()):
            del table[common + 1 :]
        del self.word[common:]
        kept = (1 << common) - 1
        self.masks = [mask & kept for mask in self.masks]
        for symbol in word[common:]:
            check_time()
            self.masks[symbol] |= 1 << len(self.word)
            self.word.append(symbol)
            self._column()

    def before(self, symbol: int, ends: int, least: int) -> int:
        """The i >= least such that the symbol derives word[i:j] for some j in ``ends``."""
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
        """Append the column of the last position: a least fixpoint, handling each bit once."""
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
        """Record that nonterminal number k derives word[i:j] for i in ``bits``; tell its users."""
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
    """Symbols still to be derived; ``starts`` are the positions from which they derive the rest."""

    symbol: int
    below: _Stack | None
    starts: int


def leftmost_derivations(srg: Srg, chart: Chart) -> Iterator[tuple[int, ...]]:
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
    chart: Chart, right: tuple[int, ...], below: _Stack | None, position: int
) -> _Stack | None:
    """The right side pushed on the symbols below; ``below`` itself if it is empty."""
    stack = below
    for symbol in reversed(right):
        ends = 1 << len(chart.word) if stack is None else stack.starts
        stack = _Stack(symbol, stack, chart.before(symbol, ends, position))
    return stack


# --------------------------------------------------------------------------------------------------
# The derivations of a word, and the structures of a robot family: all derivations of all words.
#
# For an LR(1) grammar, the one derivation is computed by its automaton in linear time; for any
# other grammar, the derivations come from a chart of the word's factors.


class InfiniteAmbiguityError(ValueError):
    """A grammar has a derivation A =>+ A, so words may have infinitely many derivations."""

    def __init__(self, nonterminals: tuple[str, ...]) -> None:
        super().__init__(
            f"{nonterminals[0]} derives itself, so a word may have infinitely many derivations"
        )
        self.nonterminals = nonterminals


def derivations_of(language: Language, word: Sequence[str]) -> Iterator[Derivation]:
    """All derivations of a word of the language, ordered by production sequence.

    Productions compare in declaration order.  A word that is not in the language has no derivation.

    Raises:
        InfiniteAmbiguityError: immediately, if the grammar has a useful derivation A =>+ A.
    """
    _refuse_cycles(language.srg)
    codes = language.srg.encode(word)
    if codes is None or not language.accept.accepts(word):
        return iter(())
    return _Derivations(language).of(codes)


def structures(language: Language, max_modules: int) -> Iterator[Derivation]:
    """All derivations of all words with at most ``max_modules`` modules, lazily.

    Ordered by word (length, then symbols in declaration order), then by production sequence.  The
    empty word is not a robot.  If edges can repeat without bound, there are infinitely many
    structures: see ``Language.is_finite``.

    Raises:
        InfiniteAmbiguityError: immediately, if the grammar has a useful derivation A =>+ A.
    """
    return structures_of(language, language.words(max_modules=max_modules))


def structures_of(language: Language, words: Iterable[tuple[str, ...]]) -> Iterator[Derivation]:
    """All derivations of the given words of the language, lazily: by word, then as above.

    Raises:
        InfiniteAmbiguityError: immediately, as above.
    """
    _refuse_cycles(language.srg)
    return _structures(language, words)


def _structures(language: Language, words: Iterable[tuple[str, ...]]) -> Iterator[Derivation]:
    derivations = _Derivations(language)
    for word in words:
        codes = language.srg.encode(word)
        if codes:
            yield from derivations.of(codes)


def _refuse_cycles(srg: Srg) -> None:
    loops = cyclic(trimmed(srg.cfg))
    if loops:
        raise InfiniteAmbiguityError(srg.names(loops))


class _Derivations:
    """The derivations of words of a grammar without cycles."""

    def __init__(self, language: Language) -> None:
        self._srg = language.srg
        found = language.lr_automaton
        self._automaton = found if isinstance(found, LrAutomaton) else None
        self._chart = Chart(language.srg) if self._automaton is None else None
        self._number = useful_rules(language.srg.cfg)

    def of(self, codes: tuple[int, ...]) -> Iterator[Derivation]:
        """All derivations of a word, in order."""
        for sequence in self._sequences(codes):
            yield tree(self._srg.start, [self._srg.productions[r] for r in sequence])

    def _sequences(self, codes: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        if self._automaton is not None:
            only = leftmost_derivation(self._automaton, codes)
            if only is not None:
                yield tuple(self._number[r] for r in only)
        elif self._chart is not None:
            self._chart.read(codes)
            yield from leftmost_derivations(self._srg, self._chart)
