"""The language of a robot family: L(SRG) intersected with L(accept) (Definitions 3 and 4).

Words come in length-lexicographic order, with symbols in declaration order, each word once however
many derivations it has.  Whatever a question needs is computed when it is first asked: the finite
automaton or the LR(1) automaton, if there is one, and the grammar of the intersection.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import prod
from typing import Any

from compiler.words.acceptance import accept_dfa, at_most
from compiler.words.budget import (
    LENGTH_LIMIT,
    MOVE_BUDGET,
    BudgetExceededError,
    WordsTooLongError,
)
from compiler.words.counting import (
    DerivationCounts,
    count_by_length,
    words_in_order,
    words_of_length,
)
from compiler.words.finite_automaton import Dfa, intersection
from compiler.words.grammar import Srg, components, srg
from compiler.words.intersection import BinaryGrammar, binary_form, binary_normal_form, intersect
from compiler.words.lr_automaton import LrAutomaton, LrConflict, LrTooLarge, lr_automaton
from compiler.words.recogniser import (
    ConditionedRecogniser,
    FiniteMembership,
    FiniteRecogniser,
    Membership,
    PushdownMembership,
    Recogniser,
)
from compiler.words.regular_automaton import regular_automaton
from compiler.words.residuals import Residuals
from grammar_lang import ir

QUICK_MOVES = 20_000
"""The most moves that are tried before the derivations of an LR(1) grammar are counted instead."""
LR_STEPS = 300_000
"""Larger LR(1) automata are not worth constructing for reading words."""


@dataclass(frozen=True)
class Language:
    """L(SRG) intersected with L(accept)."""

    srg: Srg
    accept: Dfa
    limit: int | None = None

    # --- Representations -----------------------------------------------------------------------

    @cached_property
    def normal(self) -> BinaryGrammar:
        """L(SRG) in binary normal form."""
        return binary_normal_form(self.srg.cfg)

    @cached_property
    def binary(self) -> BinaryGrammar:
        """L(SRG) in binary form, which has unit rules."""
        return binary_form(self.srg.cfg)

    @cached_property
    def product(self) -> BinaryGrammar:
        """The intersection in binary normal form; all nonterminals are useful."""
        return intersect(self.normal, self.accept, self.limit)

    def restricted(self, max_modules: int | None) -> BinaryGrammar:
        """The words with at most ``max_modules`` modules, in the form of ``product``."""
        if max_modules is None:
            return self.product
        return intersect(self.normal, self._bounded(self.accept, max_modules))

    def condition(self, max_modules: int | None) -> Dfa:
        """A condition for the grammar: met by words of the language with at most so many modules.

        If the language has a known finite automaton, the condition alone describes those words.
        """
        return self._bounded(self.finite_automaton or self.accept, max_modules)

    @cached_property
    def finite_automaton(self) -> Dfa | None:
        """The minimal finite automaton, if the form of the grammar shows that there is one."""
        return regular_automaton(self.srg, self.accept)

    @cached_property
    def lr_automaton(self) -> LrAutomaton | LrConflict | LrTooLarge:
        """The LR(1) automaton of the SRG, or the reason why there is none."""
        return lr_automaton(self.srg.cfg, LR_STEPS)

    @property
    def is_lr(self) -> bool:
        """Whether the SRG is LR(1), so that no word has two derivations."""
        return isinstance(self.lr_automaton, LrAutomaton)

    @cached_property
    def membership(self) -> Membership:
        """The membership test of the language."""
        if self.finite_automaton is not None:
            return Membership("finite automaton", FiniteMembership(self.finite_automaton), None)
        condition = None if all(self.accept.accepting) else FiniteMembership(self.accept)
        reader = PushdownMembership(self.binary, self.srg.terminals)
        return Membership("pushdown automaton", reader, condition)

    # --- Questions -----------------------------------------------------------------------------

    @cached_property
    def accepts(self) -> Callable[[Sequence[str]], bool]:
        """Whether a word is in the language; a word with a token that is not in Z is not.

        Bound to the reader once, because it may be called for millions of words.
        """
        return self.membership.accepts

    def is_empty(self, *, max_modules: int | None = None) -> bool:
        """Whether there is no word (with at most ``max_modules`` modules)."""
        return self._last(max_modules) == -1

    def is_finite(self, *, max_modules: int | None = None) -> bool:
        """Whether there are finitely many words (with at most ``max_modules`` modules)."""
        condition = self._bounded(self.accept, max_modules)
        if self.finite_automaton is None and self._bound(condition) is not None:
            return True
        return self._last(max_modules) is not None

    def longest(self, *, max_modules: int | None = None) -> int | None:
        """The length of the longest word; None for an infinite language, 0 for an empty one."""
        last = self._last(max_modules)
        return None if last is None else max(last, 0)

    def _last(self, max_modules: int | None) -> int | None:
        """The length of the longest word; None if there is no bound, -1 if there is no word."""
        if self.finite_automaton is not None:
            return self._bounded(self.finite_automaton, max_modules).longest()
        condition = self._bounded(self.accept, max_modules)
        if all(condition.accepting):
            return _longest(self.binary)
        bound = self._bound(condition)
        if bound is None:
            return _longest(self.restricted(max_modules))
        if bound > LENGTH_LIMIT:
            raise WordsTooLongError
        recogniser = self.recogniser(bound, max_modules=max_modules)
        for length in range(bound, -1, -1):
            if next(words_of_length(recogniser, length), None) is not None:
                return length
        return -1

    def shortest_word(self) -> tuple[str, ...] | None:
        """The first word in length-lexicographic order; None if there is none.

        Raises:
            WordsTooLongError: it has more than ``LENGTH_LIMIT`` symbols.
        """
        return next(self.words(), None)

    def fewest_modules(self) -> int | None:
        """The least number of modules in a non-empty word; None if there is no such word."""
        return self.product.lightest([int(name in self.srg.modules) for name in self.srg.terminals])

    def words(
        self, *, max_length: int | None = None, max_modules: int | None = None
    ) -> Iterator[tuple[str, ...]]:
        """The words, lazily, by length and then by the order of the symbols, without repetition.

        Args:
            max_length: the greatest number of symbols, edges included; None: no bound.
            max_modules: the greatest number of modules; None: no bound.

        Raises:
            WordsTooLongError: the enumeration reaches words of more than ``LENGTH_LIMIT`` symbols.
        """
        first = self.binary.shortest()
        if first is None:
            return
        longest = _least(self._bound(self._bounded(self.accept, max_modules)), max_length)
        recogniser = partial(self.recogniser, max_modules=max_modules)
        last = partial(self._last, max_modules)
        for codes in words_in_order(recogniser, first, longest, last):
            yield self.srg.decode(codes)

    def count_words(
        self,
        max_length: int | None = None,
        *,
        max_modules: int | None = None,
        budget: int | None = None,
    ) -> tuple[int, ...]:
        """The number of words of each length, from 0 to ``max_length``.

        Without a length the language must be finite; the counts end at its longest word.

        Raises:
            ValueError: no length is given and the language is infinite.
            BudgetExceededError: the grammar is not LR(1) and more than ``budget`` moves are needed.
                By default there is no bound for an evidently regular language, and ``MOVE_BUDGET``
                for any other.
        """
        longest = self.longest(max_modules=max_modules) if max_length is None else max_length
        if longest is None:
            raise ValueError("an infinite language needs a greatest length to be counted")
        if longest > LENGTH_LIMIT:
            raise WordsTooLongError
        recogniser = self.recogniser(longest, max_modules=max_modules)
        if self.finite_automaton is not None:
            return count_by_length(recogniser, longest, budget)
        most = MOVE_BUDGET if budget is None else budget
        try:
            return count_by_length(recogniser, longest, min(most, QUICK_MOVES))
        except BudgetExceededError:
            if not self.is_lr:
                return count_by_length(recogniser, longest, most)
        derivations = DerivationCounts(self.restricted(max_modules), longest)
        return tuple(derivations.total(length) for length in range(longest + 1))

    def recogniser(self, horizon: int, *, max_modules: int | None = None) -> Recogniser[Any]:
        """A recogniser of the words with few states, some of which may be dead ends."""
        if self.finite_automaton is not None:
            return FiniteRecogniser(self._bounded(self.finite_automaton, max_modules), horizon)
        residuals = Residuals(self.binary, self.srg.terminals, horizon)
        condition = self._bounded(self.accept, max_modules)
        return (
            residuals if all(condition.accepting) else ConditionedRecogniser(residuals, condition)
        )

    def _bound(self, condition: Dfa) -> int | None:
        """A length that no word exceeds, if the grammar or the condition alone gives one."""
        return _least(condition.longest(), _longest(self.binary))

    def _bounded(self, dfa: Dfa, max_modules: int | None) -> Dfa:
        if max_modules is None:
            return dfa
        return intersection(dfa, at_most(dfa.alphabet, self.srg.modules, max_modules))


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
    found = Language(rules, accept, limit)
    if limit is not None:
        _ = found.product
    return found


def _longest(grammar: BinaryGrammar) -> int | None:
    """The length of the longest word of a grammar without useless nonterminals; -1 for none."""
    if grammar.is_empty():
        return -1
    return grammar.longest() if grammar.is_finite() else None


def _least(first: int | None, second: int | None) -> int | None:
    if first is None or second is None:
        return second if first is None else first
    return min(first, second)


# --- The size of a finite language: the number of words, and the length of the longest ------------


MOVE_LIMIT = 500
SIZE_LIMIT = 100_000


def longest_word(language: Language) -> int | None:
    """The length of the longest word of a non-empty language; None if it is infinite."""
    product = language.product
    return product.longest() if product.is_finite() else None


def number_of_words(language: Language, longest: int, *, unambiguous: bool) -> int | None:
    """The number of words of a finite language, without the empty word.

    None if counting would take too long.

    Args:
        language: the language.
        longest: the length of its longest word.
        unambiguous: whether every word is known to have one derivation, so that derivations can be
            counted.  Otherwise words are counted prefix by prefix, with at most ``SIZE_LIMIT``
            moves of a finite automaton.  Without one, derivations are counted if the grammar is
            LR(1); if it is not, at most ``MOVE_LIMIT`` moves are made, and only if the number of
            nonterminals times ``longest`` is at most ``SIZE_LIMIT``.
    """
    if unambiguous:
        return _derivations(language.product)
    regular = language.finite_automaton is not None
    if not regular and language.is_lr:
        return _derivations(language.product)
    small = longest <= MOVE_LIMIT and longest * len(language.product.rules) <= SIZE_LIMIT
    if not regular and not small:
        return None
    try:
        counts = language.count_words(longest, budget=SIZE_LIMIT if regular else MOVE_LIMIT)
    except BudgetExceededError:
        return None
    return sum(counts[1:])


def _derivations(grammar: BinaryGrammar) -> int:
    """The number of derivations of a finite language.

    Neither the normal form nor the product with a deterministic automaton adds derivations.
    """
    first = grammar.terminals
    children = [
        [s - first for right in rights for s in right if s >= first] for rights in grammar.rules
    ]
    component = components(len(children), children.__getitem__)
    number = [0] * len(children)
    for k in sorted(range(len(children)), key=component.__getitem__):
        number[k] = sum(
            prod(1 if s < first else number[s - first] for s in right) for right in grammar.rules[k]
        )
    return sum(number[start - first] for start in grammar.starts)
