"""The functional reconfiguration automaton (FRA): the SRA with semantic updates on its transitions.

The paper omits its definition (after Definition 6).  This module completes it: a transition that
applies a production carries its attribute rules and emissions, which refer to the symbol popped
(``this``) and to those pushed.  The productions along an accepting run are a leftmost derivation,
and the updates along it define the robot completely.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from compiler.words.finite_automaton import Dfa
from compiler.words.grammar import Srg
from compiler.words.pushdown_automaton import (
    Configuration,
    Pda,
    Transition,
    accepting_run,
    configurations,
    sra,
)
from grammar_lang import ir
from grammar_lang.ir.expression_text import updates_text
from grammar_lang.source import Source, written


@dataclass(frozen=True, slots=True)
class Fra:
    """A pushdown automaton with the semantics of the productions that its transitions apply."""

    pda: Pda
    productions: Mapping[str, ir.Production]
    semantics: Mapping[str, ir.SemanticBlock]
    sources: Sequence[Source] = ()
    """If given, updates are shown as they are written in these sources."""

    def updates(self, transition: Transition) -> tuple[str, ...]:
        """The updates of a transition as text; empty if it applies no production."""
        if transition.label is None:
            return ()
        block = self.semantics[transition.label]
        updates = updates_text(self.productions[transition.label], block)
        statements = (*block.rules, *block.emissions, *block.visuals)
        return tuple(
            written(statement.span, self.sources) or update
            for statement, update in zip(statements, updates, strict=True)
        )


@dataclass(frozen=True, slots=True)
class FunctionalStep:
    """A step of a run: the transition, the configuration that it leads to, and its updates.

    The first step has no transition, and the initial configuration.
    """

    configuration: Configuration
    transition: Transition | None
    updates: tuple[str, ...]

    @property
    def label(self) -> str | None:
        """The label of the production applied, if any."""
        return None if self.transition is None else self.transition.label


def fra(
    srg: Srg,
    accept: Dfa,
    semantics: Mapping[str, ir.SemanticBlock],
    sources: Sequence[Source] = (),
) -> Fra:
    """The FRA of a grammar with its accept condition and its semantics.

    With the ``sources`` of the program, its updates are shown as they are written.

    Raises:
        ValueError: a production has no block in the semantics.
    """
    for production in srg.productions:
        if production.label not in semantics:
            raise ValueError(f"production {production.label} has no semantics")
    productions = {production.label: production for production in srg.productions}
    return Fra(sra(srg, accept), productions, semantics, tuple(sources))


def functional_run(fra: Fra, word: Sequence[str]) -> Iterator[FunctionalStep] | None:
    """An accepting run, lazily; None if there is none."""
    run = accepting_run(fra.pda, word)
    return None if run is None else _steps(fra, word, run)


def _steps(fra: Fra, word: Sequence[str], run: Sequence[Transition]) -> Iterator[FunctionalStep]:
    places = configurations(fra.pda, word, run)
    for transition, place in zip((None, *run), places, strict=True):
        yield FunctionalStep(
            place, transition, () if transition is None else fra.updates(transition)
        )


def production_labels(run: Iterable[FunctionalStep]) -> tuple[str, ...]:
    """The labels of the productions applied along a run: a leftmost derivation of its word."""
    return tuple(step.label for step in run if step.label is not None)
