"""A robot family (FRG): an SRG with its accept condition and semantics, in a task's dimension."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from compiler.robots.attributes import evaluate
from compiler.robots.evaluation_order import EvaluationOrder
from compiler.robots.normal_form import normalise
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation, replay
from compiler.words.language import Language, language
from grammar_lang import ir


@dataclass(frozen=True)
class RobotFamily:
    """A grammar of a program whose derivations are robots in the plane (2) or in space (3)."""

    program: ir.Program
    grammar: ir.Grammar
    dimension: Literal[2, 3]

    @cached_property
    def language(self) -> Language:
        """L(SRG) intersected with L(accept)."""
        return language(self.grammar, self.program.terminals, self.program.modules)

    @cached_property
    def evaluation_order(self) -> EvaluationOrder:
        """In which order attributes are evaluated, in all derivations of the grammar."""
        return EvaluationOrder(self.grammar.productions, self.grammar.semantics or {})

    def replay(self, labels: tuple[str, ...]) -> Derivation:
        """The derivation with these labels; BadDerivation if there is none."""
        return replay(self.grammar, labels)

    def built(self, derivation: Derivation) -> RobotModel:
        """The robot of a derivation as its rules build it.

        Raises:
            SemanticsError: the grammar has no semantics, or they define no robot here.
        """
        semantics = self.grammar.semantics or {}
        order = self.evaluation_order
        return evaluate(derivation, self.program.modules, semantics, self.dimension, order)

    def robot(self, derivation: Derivation) -> RobotModel:
        """The normalised robot of a derivation; errors as of ``built``."""
        return normalise(self.built(derivation))


def family_of(program: ir.Program, task: ir.Task) -> RobotFamily:
    """The robot family of a task."""
    workspace = program.workspaces[task.workspace]
    return RobotFamily(program, program.grammars[task.grammar], workspace.dimension)
