"""The derivations of a word, and the structures of a robot family: all derivations of all words.

For an LR(1) grammar, the one derivation is read off its automaton in linear time; for any other,
the derivations come from a chart of the word's factors.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from compiler.automata.lr_automaton import LrAutomaton
from compiler.automata.lr_derivation import leftmost_derivation
from compiler.grammars.derivation import Derivation, tree
from compiler.grammars.grammar import Srg, cyclic, trimmed, useful_rules
from compiler.languages.chart import Chart, leftmost_derivations
from compiler.languages.language import Language


class InfiniteAmbiguityError(ValueError):
    """A grammar with a derivation A =>+ A, whose words may have infinitely many derivations."""

    def __init__(self, nonterminals: tuple[str, ...]) -> None:
        super().__init__(
            f"{nonterminals[0]} derives itself, so a word may have infinitely many derivations"
        )
        self.nonterminals = nonterminals


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
    return _Derivations(language).of(codes)


def structures(language: Language, max_modules: int) -> Iterator[Derivation]:
    """All derivations of all words with at most ``max_modules`` modules, lazily.

    Ordered by word (length, then symbols in order of declaration), then by production sequence.
    The empty word is no robot.  Where edges alone repeat without bound there are infinitely many:
    see ``Language.is_finite``.

    Raises:
        InfiniteAmbiguityError: at once, where the grammar has a useful derivation A =>+ A.
    """
    return structures_of(language, language.words(max_modules=max_modules))


def structures_of(language: Language, words: Iterable[tuple[str, ...]]) -> Iterator[Derivation]:
    """All derivations of given words of the language, lazily: by word, then as above.

    Raises:
        InfiniteAmbiguityError: at once, as above.
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
