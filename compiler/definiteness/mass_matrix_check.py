"""Whether the mass matrix of a robot is positive definite for all poses and parameters.

First from the velocities of the bodies, group of joints by group; what is left, or all of M where
a body has no inertia in the ordinary sense (a negative mass, an indefinite tensor), by the
preconditioned matrix itself, which also finds where M is not positive definite.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

from compiler.definiteness.bodies_at_rest import (
    BodyMotions,
    RestTest,
    body_motions,
    rest_test,
    still_joints,
)
from compiler.definiteness.box_search import Examined, Searched, search
from compiler.definiteness.boxes import Box, domain_side
from compiler.definiteness.enclosed_matrix import EnclosedMatrix
from compiler.definiteness.exact_witnesses import ExactWitnesses
from compiler.definiteness.indefiniteness import Refuter, Witness
from compiler.definiteness.positive_definite import (
    BOXES,
    PRECISION,
    Definiteness,
    DominanceTest,
    definiteness,
)
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import working_precision
from compiler.robots.robot import RobotModel

FEW, SHARE = 32, 8
"""A group of joints may use so many boxes at first, and later one part in so many of the budget."""


def robot_box(model: RobotModel) -> Box:
    """All coordinates, then all parameters; an unlimited angle takes one turn."""
    joints = [domain_side(dof.range, angle=dof.kind == "revolute") for dof in model.dofs]
    return (*joints, *(domain_side(parameter.domain) for parameter in model.parameters))


def robot_names(model: RobotModel) -> tuple[str, ...]:
    """What the variables of the box are called: q1 …, and parameters by module and place."""
    coordinates = (f"q{i + 1}" for i in range(len(model.dofs)))
    places = (f"{p.module}.{p.name} at {p.symbol}" for p in model.parameters)
    return (*coordinates, *places)


def mass_matrix_check(model: RobotModel, *, budget: int = BOXES) -> Definiteness:
    """Whether M(q, theta) is positive definite for all q in range and all theta.

    M is symmetric by construction: a sum of m J'J and W'IW with I symmetric.

    Args:
        model: the robot, in its joints' own coordinates.
        budget: the most boxes to examine.
    """
    with working_precision(PRECISION):
        return _Check(model, robot_box(model), budget).run()


@dataclass(slots=True)
class _Check:
    """One check; ``spent`` counts boxes."""

    model: RobotModel
    box: Box
    budget: int
    spent: int = 0

    def run(self) -> Definiteness:
        motions = body_motions(self.model)
        known: tuple[int, ...] = ()
        groups = 0
        shares = (FEW, max(self.budget // SHARE, FEW)) if self._ordinary(motions) else (0,)
        for share in shares:
            while share and (group := self._next_group(motions, known, share)) is not None:
                known = tuple(sorted({*known, *group}))
                groups += 1
            rest = tuple(i for i in range(len(self.model.dofs)) if i not in known)
            last = share == shares[-1]
            found = self._last_group(motions, rest, groups, last=last) if rest else None
            if found is not None:
                return found
        return Definiteness(
            "proved", self.spent, "construction", _argument(groups), names=robot_names(self.model)
        )

    def _ordinary(self, motions: BodyMotions) -> bool:
        """Whether no term of the kinetic energy can be negative, as far as one box shows."""
        weights = motions.enclosed(ca.vertcat(*motions.weights))
        sides = [side.ends for side in self.box]
        return all(weight.low >= 0 for weight in weights.enclosed(sides))

    def _next_group(
        self, motions: BodyMotions, known: Sequence[int], share: int
    ) -> tuple[int, ...] | None:
        """A group of joints whose rates are zero if those known are; small ones first."""
        moved = [motions.moved_by(body) for body in range(len(self.model.bodies))]
        groups = {tuple(i for i in dofs if i not in known) for dofs in moved} - {()}
        whole = len(self.model.dofs) - len(known)
        for group in sorted(groups, key=lambda each: (len(each), each)):
            if len(group) < whole or share == FEW:
                inside = {*known, *group}
                bodies = [b for b, dofs in enumerate(moved) if inside.issuperset(dofs)]
                bodies = [b for b in bodies if not set(group).isdisjoint(moved[b])]
                test = rest_test(motions, group, bodies)
                allowed = max(min(share, self.budget - self.spent), 1)
                found: Searched[Witness] = search(self.box, test.examine, lambda _: None, allowed)
                self.spent += found.boxes
                if found.status == "proved":
                    return group
        return None

    def _last_group(
        self, motions: BodyMotions, rest: tuple[int, ...], groups: int, *, last: bool
    ) -> Definiteness | None:
        """What no group proves: that part of M itself, proved or refuted; None if it is too early.

        Before the ``last`` round it is only tried to refute it on few boxes.
        """
        matrix = self._mass_matrix(motions, rest)
        dominance = DominanceTest(matrix)
        bodies = [
            b
            for b in range(len(self.model.bodies))
            if not set(rest).isdisjoint(motions.moved_by(b))
        ]
        test = _EitherTest(rest_test(motions, rest, bodies), dominance)
        left = max(self.budget - self.spent if last else FEW, 1)
        witness = ExactWitnesses(matrix, self.box).witness()
        found: Searched[Witness] = (
            search(self.box, test.examine, Refuter(matrix).refute, left)
            if witness is None
            else Searched("fails", 1, witness.box, witness)
        )
        if found.status == "undecided" and not last:
            self.spent += found.boxes
            return None
        result = definiteness(found, "construction", robot_names(self.model))
        if result.witness is not None:
            result = replace(result, witness=self._whole(result.witness, rest))
        argument = _argument(groups, test) if result.status == "proved" else ""
        return replace(result, boxes=self.spent + found.boxes, argument=argument)

    def _whole(self, witness: Witness, rest: Sequence[int]) -> Witness:
        """The witness with zeros for the joints that its part of M leaves out."""
        vector = [witness.vector[0] * 0] * len(self.model.dofs)
        for i, item in zip(rest, witness.vector, strict=True):
            vector[i] = item
        return replace(witness, vector=tuple(vector))

    def _mass_matrix(self, motions: BodyMotions, rest: Sequence[int]) -> EnclosedMatrix:
        """The rows and columns of M of some joints, without coordinates that M does not feel."""
        graph = robot_graph(self.model)
        n = len(self.model.dofs)
        k = ca.SX.sym("k", len(graph.constants))
        z = motions.variables
        matrix = ca.densify(graph.mass_matrix(z[:n], z[n:], k))[list(rest), list(rest)]
        still = self._roots()
        if still:
            matrix = ca.substitute(matrix, z[still], ca.SX.zeros(len(still)))
        return EnclosedMatrix(ca.tril2symm(ca.tril(matrix)), z, k, graph.constants)

    def _roots(self) -> list[int]:
        """The joints that move all bodies as a whole: the first one, where there is only one."""
        bodies = range(len(self.model.bodies))
        return still_joints(self.model, range(len(self.model.dofs)), bodies) if bodies else []


@dataclass(slots=True)
class _EitherTest:
    """Both sufficient tests: the bodies' velocities, then the matrix itself; who proved what."""

    rest: RestTest
    dominance: DominanceTest
    at_rest: int = 0
    dominant: int = 0

    def examine(self, box: Box) -> Examined:
        first = self.rest.examine(box)
        if first.proved:
            self.at_rest += 1
            return first
        second = self.dominance.examine(box)
        self.dominant += second.proved
        # Where a weight is negative the first test is hopeless, and the second one leads.
        return second if second.proved or first.score < -1 else first


def _argument(groups: int, last: _EitherTest | None = None) -> str:
    """What proved a robot: so many groups of joints, and the test of the rest."""
    if last is not None and last.at_rest and not last.dominant:
        groups, last = groups + 1, None
    plural = "group" if groups == 1 else "groups"
    parts = []
    if groups or last is None:
        parts.append(f"every body at rest puts every joint at rest ({groups} {plural} of joints)")
    if last is not None:
        both = f" on {last.dominant} boxes, by bodies at rest on {last.at_rest}"
        what = "M of the other joints" if groups else "M"
        parts.append(
            f"{what} is diagonally dominant after preconditioning{both if last.at_rest else ''}"
        )
    return "; ".join(parts)
