"""Lemmas from a refuted robot about variants: fewer joints, parts that change no pose, weights."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.lemmas.neutral_productions import NeutralProductions, spine
from compiler.lemmas.variants import holds_of_variants, holds_of_weighted, neutral_in_task
from compiler.lemmas.weighted import weighted_robot, weights
from compiler.robots.normal_form import RobotFamily
from compiler.words.acceptance import accept_dfa
from compiler.words.derivation import Derivation
from grammar_lang import ir
from solvers.impossibility.drive_search import BEFORE_MOTIONS, DriveEffort, drive_refutation
from solvers.lemma import VariantLemma, WeightsLemma

MOST_SYMBOLS = 60
"""Longer words are not generalised: their expressions would help nobody."""


def variant_lemma(family: RobotFamily, task: ir.Task, base: Derivation) -> VariantLemma | None:
    """The lemma about all variants of a structure that poses alone refute; None if not found."""
    neutral = neutral_in_task(family, task)
    if neutral.none or len(base.word) > MOST_SYMBOLS:
        return None
    condition = ir.Matches(_Words(family.grammar.productions, base, neutral).expression())
    try:
        if not holds_of_variants(family, task, base, condition):
            return None
        automaton = accept_dfa(condition, family.language.srg.terminals)
    except ValueError:
        return None
    return VariantLemma(condition, automaton, base.word, base.labels)


MOST_WEIGHTS = 4
"""The number of weights of each kind that is tried if nothing bounds it."""


def weights_lemma(
    family: RobotFamily, task: ir.Task, base: Derivation, effort: DriveEffort = BEFORE_MOTIONS
) -> WeightsLemma | None:
    """The lemma about a robot with weights anywhere, if the robot's drives are too weak for it."""
    kinds = weights(family, task)
    if not kinds or len(base.word) > MOST_SYMBOLS:
        return None
    modules = sum(family.program.is_module(symbol) for symbol in base.word)
    most = MOST_WEIGHTS if task.modules is None else task.modules - modules
    productions = family.grammar.productions
    numbers = frozenset(n for n, each in enumerate(productions) if each.label in kinds)
    words = _Words(productions, base, NeutralProductions(frozenset(), numbers)).expression()
    counts = (ir.Count(name, "<=", most) for name in dict.fromkeys(kinds.values()))
    condition = ir.AllOf((ir.Matches(words), *counts))
    try:
        model = weighted_robot(family, task, base, most) if most > 0 else None
        if model is None or not holds_of_weighted(family, task, base, condition, most):
            return None
        automaton = accept_dfa(condition, family.language.srg.terminals)
        graph = robot_graph(model, task.gravity)
    except ValueError:
        return None
    workspace = family.program.workspaces[task.workspace]
    found = drive_refutation(model, graph, workspace, task, effort)
    if found is None:
        return None
    return WeightsLemma(condition, automaton, base.word, base.labels, most, found.boxes)


class _Words:
    """The regular expression of the words of variants."""

    def __init__(
        self,
        productions: Sequence[ir.Production],
        base: Derivation,
        neutral: NeutralProductions,
    ) -> None:
        self._base = base
        self._removable = {productions[number].label for number in neutral.removable}
        self._added = [productions[number] for number in sorted(neutral.transparent)]

    def expression(self) -> ir.Regex:
        """The expression for the whole word."""
        parts = list(self._merged(self._of(0)))
        return parts[0] if len(parts) == 1 else ir.RSequence(tuple(parts))

    def _of(self, place: int) -> Iterator[ir.Regex]:
        """The expressions for what a node derives, with the parts that may be added there."""
        node = self._base.nodes[place]
        before = self._may_be_added(node.production.left, before=True)
        after = self._may_be_added(node.production.left, before=False)
        yield from before
        removable = node.production.label in self._removable
        inner = spine(node.production)
        own: list[ir.Regex] = []
        for symbol, child in zip(node.production.right, node.children, strict=True):
            if symbol.kind == "nonterminal":
                if own and removable:
                    yield _optional(own)
                    own = []
                yield from own
                own = []
                yield from self._of(child)
            else:
                own.append(ir.RSymbol(symbol.name))
        if own and removable and inner == 0:
            yield _optional(own)
        else:
            yield from own
        yield from after

    def _may_be_added(self, left: str, *, before: bool) -> list[ir.Regex]:
        """Any number of transparent productions of a nonterminal, on one side of it."""
        choices: list[ir.Regex] = []
        for production in self._added:
            place = spine(production)
            if production.left != left or place is None or (place > 0) is not before:
                continue
            symbols = production.right[1:] if place == 0 else production.right[:-1]
            choices.append(_sequence([ir.RSymbol(symbol.name) for symbol in symbols]))
        if not choices:
            return []
        part = choices[0] if len(choices) == 1 else ir.RChoice(tuple(choices))
        return [ir.RRepeat(part, "*")]

    def _merged(self, parts: Iterator[ir.Regex]) -> Iterator[ir.Regex]:
        """The expressions, with each repetition only once in a row."""
        last: ir.Regex | None = None
        for part in parts:
            if part != last or not isinstance(part, ir.RRepeat) or part.mark != "*":
                yield part
            last = part


def _sequence(parts: Sequence[ir.Regex]) -> ir.Regex:
    return parts[0] if len(parts) == 1 else ir.RSequence(tuple(parts))


def _optional(parts: Sequence[ir.Regex]) -> ir.Regex:
    return ir.RRepeat(_sequence(parts), "?")
