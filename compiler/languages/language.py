"""The language of a robot family: L(SRG) intersected with L(accept) (Definitions 3 and 4).

Membership, emptiness, finiteness, counting and enumeration, all on the grammar's side; the
automaton's side is ``compiler.automata.pushdown_automaton``.  Words come in length-lexicographic
order, symbols in order of declaration, each word once however many derivations it has.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count

from compiler.automata.acceptance import accept_dfa, at_most
from compiler.automata.finite_automaton import Dfa, intersection
from compiler.grammars.grammar import Srg, srg
from compiler.languages.intersection import BinaryGrammar, binary_normal_form, intersect
from compiler.languages.residuals import Residual, Residuals
from grammar_lang import ir

FIRST_HORIZON = 32


@dataclass(frozen=True, slots=True)
class Language:
    """L(SRG) intersected with L(accept)."""

    srg: Srg
    accept: Dfa
    normal: BinaryGrammar = field(compare=False, repr=False)
    product: BinaryGrammar = field(compare=False, repr=False)

    def accepts(self, word: Sequence[str]) -> bool:
        """Whether the word is in the language; a token that is no symbol of Z means no."""
        codes = self.srg.encode(word)
        if codes is None or not self.accept.accepts(word):
            return False
        residuals = Residuals(self.normal, 0)
        residual: Residual | None = residuals.root
        for code in codes:
            if residual is None:
                return False
            residual = residuals.after(residual, code)
        return residual is not None and residual.accepting

    def is_empty(self, *, max_modules: int | None = None) -> bool:
        """Whether there is no word (with at most ``max_modules`` modules)."""
        return self._restricted(max_modules).is_empty()

    def is_finite(self, *, max_modules: int | None = None) -> bool:
        """Whether there are finitely many words (with at most ``max_modules`` modules)."""
        return self._restricted(max_modules).is_finite()

    def words(
        self, *, max_length: int | None = None, max_modules: int | None = None
    ) -> Iterator[tuple[str, ...]]:
        """The words, lazily, by length and then by the order of the symbols, without repetition.

        Args:
            max_length: the greatest number of symbols, edges included; None: no bound.
            max_modules: the greatest number of modules; None: no bound.
        """
        grammar = self._restricted(max_modules)
        if grammar.empty_word and (max_length is None or max_length >= 0):
            yield ()
        if not grammar.starts:
            return
        last = max_length
        if grammar.is_finite():
            longest = grammar.longest()
            last = longest if max_length is None else min(longest, max_length)
        residuals = Residuals(grammar, FIRST_HORIZON)
        for length in count(1):
            if last is not None and length > last:
                return
            if length > residuals.horizon:
                residuals = Residuals(grammar, 2 * residuals.horizon)
            for codes in _of_length(residuals, length):
                yield self.srg.decode(codes)

    def count_words(
        self, max_length: int | None = None, *, max_modules: int | None = None
    ) -> tuple[int, ...]:
        """The number of words of each length, from 0 to ``max_length``.

        Without a length the language must be finite; the counts end at its longest word.

        Raises:
            ValueError: no length is given and the language is infinite.
        """
        grammar = self._restricted(max_modules)
        if max_length is None and not grammar.is_finite():
            raise ValueError("an infinite language needs a greatest length to be counted")
        last = grammar.longest() if max_length is None else max_length
        residuals = Residuals(grammar, last)
        counts = [int(grammar.empty_word)]
        level = {residuals.root: 1} if grammar.starts else {}
        for length in range(1, last + 1):
            level = _next_level(residuals, level, last - length)
            counts.append(sum(n for residual, n in level.items() if residual.accepting))
        return tuple(counts)

    def _restricted(self, max_modules: int | None) -> BinaryGrammar:
        if max_modules is None:
            return self.product
        bound = at_most(self.accept.alphabet, self.srg.modules, max_modules)
        return intersect(self.normal, intersection(self.accept, bound))


def language(
    grammar: ir.Grammar, program_terminals: tuple[str, ...], modules: Container[str]
) -> Language:
    """The language of a grammar with its accept condition; arguments and errors as in ``srg``.

    Raises:
        ValueError: an undeclared symbol.
        AutomatonTooLargeError: the accept condition has too many states.
    """
    rules = srg(grammar, program_terminals, modules)
    return restrict(rules, accept_dfa(grammar.accept, program_terminals))


def restrict(rules: Srg, accept: Dfa, limit: int | None = None) -> Language:
    """The words of an SRG that an automaton over the same symbols accepts.

    Raises:
        IntersectionTooLargeError: their grammar has more than ``limit`` rules.
    """
    if accept.alphabet != rules.terminals:
        raise ValueError("the accept condition and the grammar have different alphabets")
    normal = binary_normal_form(rules.cfg)
    return Language(rules, accept, normal, intersect(normal, accept, limit))


def _of_length(residuals: Residuals, length: int) -> Iterator[tuple[int, ...]]:
    """The words of one length in lexicographic order, by depth-first search without dead ends."""
    if not residuals.root.lengths >> length & 1:
        return
    word: list[int] = []
    path = [(residuals.root, iter(residuals.symbols(residuals.root)))]
    while path:
        residual, symbols = path[-1]
        rest = length - len(word)
        if rest == 0:
            yield tuple(word)
        symbol = None if rest == 0 else next(symbols, None)
        if symbol is None:
            path.pop()
            del word[-1:]
            continue
        following = residuals.after(residual, symbol)
        if following is not None and following.lengths >> (rest - 1) & 1:
            word.append(symbol)
            path.append((following, iter(residuals.symbols(following))))


def _next_level(residuals: Residuals, level: dict[Residual, int], rest: int) -> dict[Residual, int]:
    """Prefixes counted by residual, one symbol longer, that ``rest`` more symbols can complete."""
    mask = (1 << (rest + 1)) - 1
    following: dict[Residual, int] = {}
    for residual, number in level.items():
        for symbol in residuals.symbols(residual):
            target = residuals.after(residual, symbol)
            if target is not None and target.lengths & mask:
                following[target] = following.get(target, 0) + number
    return following
