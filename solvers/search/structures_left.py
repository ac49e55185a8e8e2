"""The structures that are still to be tried: in order, without those that lemmas cover.

A lemma narrows the language of the family.  The remaining structures are then enumerated anew,
skipping those that were tried before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

from compiler.robots.candidate import Candidate, candidates
from compiler.robots.normal_form import RobotFamily
from compiler.words.finite_automaton import AutomatonTooLargeError
from grammar_lang import ir
from solvers.conclusion import module_bound
from solvers.impossibility.distance_lemmas import distance_lemma
from solvers.impossibility.variant_lemmas import variant_lemma, weights_lemma
from solvers.lemma import Lemma
from solvers.run_context import RunContext
from solvers.search.prefetch import Prefetch


@dataclass(slots=True)
class StructuresLeft:
    """The structures of ``family`` still to be tried; ``following`` is the next, None at the end.

    ``whole`` is the family before any lemma.  ``lemmas`` and the derivations in ``tried`` grow in
    place.  ``order`` lists the structures of a family.
    """

    program: ir.Program
    task: ir.Task
    context: RunContext
    whole: RobotFamily
    lemmas: list[Lemma] = field(default_factory=list[Lemma])
    tried: set[tuple[str, ...]] = field(default_factory=set[tuple[str, ...]])
    order: Callable[[RobotFamily], Iterator[Candidate]] | None = None
    family: RobotFamily = field(init=False)
    ahead: Prefetch = field(init=False)
    following: Candidate | None = field(init=False, default=None)
    _drawn: Iterator[Candidate] = field(init=False)

    def __post_init__(self) -> None:
        self.family = self.whole
        for lemma in self.lemmas:
            self.family = self.family.with_condition(ir.NotAccept(lemma.condition))
        self._draw()

    def taken(self) -> Candidate:
        """The next structure, which counts as tried from now on.

        Raises:
            ValueError: if there is none.
        """
        candidate = self.following
        if candidate is None:
            raise ValueError("no structure is left")
        self.tried.add(candidate.derivation.labels)
        return candidate

    def go_on(self) -> None:
        """Advance to the next structure."""
        self.following = next(self._drawn, None)

    def stop(self) -> None:
        """End the enumeration."""
        self.following = None

    def learn(self, refuted: Candidate, *, by_poses: bool) -> None:
        """Narrow the family by a lemma from a refuted structure, if it covers more than that one.

        ``by_poses`` says that the refutation holds whatever the drives, the dynamics and the
        horizon.
        """
        word = refuted.derivation.word
        known = any(lemma.is_about(word) for lemma in self.lemmas)
        if self.following is None or known or not self.context.lemmas:
            return
        # About the whole family, so that each lemma holds independently of the others.
        lemma: Lemma | None = distance_lemma(self.whole, self.task, word)
        if lemma is None:
            about = variant_lemma if by_poses else weights_lemma
            lemma = about(self.whole, self.task, refuted.derivation)
        if lemma is not None:
            self.add(lemma, word)

    def add(self, lemma: Lemma, word: Sequence[str]) -> None:
        """Narrow the family by a lemma from a refuted word, if it covers more than that word."""
        try:
            narrowed = self.family.with_condition(ir.NotAccept(lemma.condition))
            if not self._is_wider(lemma, word):
                return
        except AutomatonTooLargeError:
            return
        self.lemmas[:] = [each for each in self.lemmas if not lemma.covers(each)] + [lemma]
        self.family = narrowed
        self.context.reporter.note(lemma.text)
        self._draw()

    def _is_wider(self, lemma: Lemma, word: Sequence[str]) -> bool:
        """Whether a lemma covers remaining words other than this one."""
        about = self.family.with_condition(lemma.condition)
        words = about.language.words(max_modules=module_bound(self.family, self.task))
        return any(other != tuple(word) for other in islice(words, 2))

    def _draw(self) -> None:
        self.ahead = Prefetch(self._left(), self.program, self.task, self.context)
        self._drawn = iter(self.ahead)
        self.following = next(self._drawn, None)

    def _left(self) -> Iterator[Candidate]:
        """The structures that were not tried, with consecutive numbers."""
        number = len(self.tried)
        for candidate in (self.order or self._usual)(self.family):
            if candidate.derivation.labels not in self.tried:
                yield replace(candidate, number=number)
                number += 1

    def _usual(self, family: RobotFamily) -> Iterator[Candidate]:
        """The structures up to the bound on modules, in the order of section 2."""
        return candidates(family, module_bound(family, self.task), self.task.origin)
