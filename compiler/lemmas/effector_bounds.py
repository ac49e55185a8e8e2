r"""Half-spaces that no effector leaves and balls that none enters, for all words of a condition.

No robot of any derivation of any of the words reaches a region outside such a half-space, or within
such a ball, whatever its parameters, joints and drives:

.. math:: \max_p n \cdot p \le h < \min_{x \in R} n \cdot x,
   \qquad \min_p |p - c| \ge d > \max_{x \in R} |x - c|,

where p ranges over the positions that :mod:`effector_placements` allows for effectors. If the
derivations of a word define no robot, the word has no robot that does the task either.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.lemmas.conditioned_derivations import conditioned_derivations
from compiler.lemmas.effector_placements import effector_placements
from compiler.lemmas.frame_placement import Placement
from compiler.robots.normal_form import RobotFamily
from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import Dfa, intersection
from compiler.workspaces.polytope import Polytope, refuting_polytope
from grammar_lang import ir

PRECISION = 128
"""The bits of all numbers that are not exact."""


@dataclass(frozen=True, slots=True)
class HalfSpaceBound:
    """No effector is farther than ``reach`` along ``normal``, (d,)."""

    normal: tuple[Fraction, ...]
    reach: Fraction

    def encloses(self, placements: Sequence[Placement]) -> bool:
        """Whether the bound holds for all effectors."""
        reach = ball(self.reach)
        return all(
            any(view.furthest(self.normal) <= reach for view in place.views) for place in placements
        )

    def excludes(self, region: Polytope) -> bool:
        """Whether a bounded region, including its boundary, is outside."""
        return all(_dot(self.normal, vertex) > self.reach for vertex in region.vertices)


@dataclass(frozen=True, slots=True)
class BallBound:
    """No effector is nearer than ``distance`` to ``centre``, (d,), in metres."""

    centre: tuple[Fraction, ...]
    distance: Fraction

    def encloses(self, placements: Sequence[Placement]) -> bool:
        """Whether the bound holds for all effectors."""
        distance = ball(self.distance)
        return all(
            any(view.nearest(self.centre) >= distance for view in place.views)
            for place in placements
        )

    def excludes(self, region: Polytope) -> bool:
        """Whether a bounded region is inside the ball, which is open."""
        return all(
            sum((x - c) ** 2 for x, c in zip(vertex, self.centre, strict=True)) < self.distance**2
            for vertex in region.vertices
        )


EffectorBound: TypeAlias = HalfSpaceBound | BallBound


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def placements_of(family: RobotFamily, condition: ir.Accept) -> tuple[Placement, ...]:
    """Where the effectors can be, over all robots of the family whose words satisfy a condition.

    Raises:
        ValueError: this cannot be determined, or takes too long.
    """
    language = family.language
    dfa = intersection(language.accept, accept_dfa(condition, language.srg.terminals))
    return placements_within(family, dfa)


def placements_within(family: RobotFamily, dfa: Dfa) -> tuple[Placement, ...]:
    """Where effectors can be, over all words that the grammar derives and the automaton accepts.

    Raises:
        ValueError: this cannot be determined, or takes too long.
    """
    derivations = conditioned_derivations(family.language.srg.cfg, dfa)
    with working_precision(PRECISION):
        return effector_placements(family.program.modules, family.grammar, derivations)


def place_of(workspace: ir.Workspace, region: str) -> Polytope:
    """The intersection of a region and the bounds: an effector that visits the region is in it."""
    shapes = (workspace.region(region).shape, workspace.bounds.shape)
    one, other = (refuting_polytope(shape, workspace.dimension) for shape in shapes)
    return one.intersection(other)


def keep_to(bound: EffectorBound, placements: Sequence[Placement]) -> bool:
    """Whether all effectors at these placements satisfy a bound, proved in ball arithmetic."""
    with working_precision(PRECISION):
        return bound.encloses(placements)
