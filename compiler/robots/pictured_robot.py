"""A robot with the frames of its visuals, which searches and proofs do not use."""

from __future__ import annotations

from dataclasses import replace

from compiler.robots.attributes import evaluate
from compiler.robots.evaluation_order import EvaluationOrder
from compiler.robots.normal_form import RobotFamily, normalise
from compiler.robots.payloads import with_payloads
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation, emission_order
from grammar_lang import ir


def visuals_of(family: RobotFamily, derivation: Derivation) -> tuple[ir.Visual, ...]:
    """The visuals of a derivation, in the order of the frames ``seen`` of its robot."""
    blocks = family.grammar.semantics or {}
    labels = (derivation.nodes[node].production.label for node in emission_order(derivation))
    return tuple(visual for label in labels for visual in blocks[label].visuals)


def pictured_robot(family: RobotFamily, derivation: Derivation) -> RobotModel:
    """The normalised robot of a derivation with the frames of its visuals.

    Its joints are the same as without visuals: a joint that moves only visuals is fixed at zero,
    and visuals between merged joints move with the first of them.

    Raises:
        SemanticsError: its rules define no robot, or no frame for a visual.
    """
    blocks = family.grammar.semantics or {}
    order = EvaluationOrder(family.grammar.productions, blocks, visuals=True)
    found = evaluate(derivation, family.program.modules, blocks, family.dimension, order)
    built = with_payloads(replace(found, posed=family.posed), family.payloads, family.carries)
    return normalise(built)
