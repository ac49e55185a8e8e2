"""Whether the mass matrix of a robot is positive definite for all poses and parameters.

M is proved positive definite from the velocities of the bodies, one group of joints after another.
If joints remain, a vector v with v'Mv <= 0 is searched for: first one that M annihilates
identically, then one at the natural points of the box (zero, right angles, ends, centres), where
v'Mv is computed exactly. Floating point chooses v and proves nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, islice, product
from math import gcd, lcm
from typing import Literal

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import (
    BALLS,
    ball,
    closed_ball,
    constant_ball,
    working_precision,
)
from compiler.expressions.evaluators.exact import PiLinear
from compiler.expressions.evaluators.trigonometric import CanonicalEvaluator, TooManyTerms
from compiler.expressions.scalars import Constant
from compiler.expressions.tape import Tape, tape
from compiler.expressions.trigonometric_polynomial import (
    Pi,
    PolynomialRing,
    TrigonometricPolynomial,
    Variable,
)
from compiler.mass_matrix.bodies_at_rest import (
    BodyMotions,
    body_motions,
    rest_test,
    still_joints,
)
from compiler.mass_matrix.boxes import Box, domains, natural_values, robot_box, side_text
from compiler.robots.robot import RobotModel

PRECISION = 128
BOXES = 4096
"""The default number of boxes examined."""
FEW, SHARE = 32, 8
"""The boxes that a group may use at first; later it may use 1 / ``SHARE`` of the budget."""
POINTS = 400
"""The number of natural points that are tried."""
SCATTERED = 5
"""Points at which M must annihilate a vector before it is tried as an identity."""
SINGULAR = 1e-9
DENOMINATOR = 1000


@dataclass(frozen=True, slots=True)
class Witness:
    """A witness of ``v'Mv <= 0`` at a point of the box; ``identically``: v'Mv = 0 at all points."""

    vector: tuple[Fraction, ...]
    point: tuple[PiLinear, ...] = ()
    identically: bool = False


@dataclass(frozen=True, slots=True)
class Definiteness:
    """Whether M is positive definite over a box (v'Mv > 0 for all v other than zero).

    M is symmetric by construction: a sum of m J'J and W'IW with I symmetric. ``groups`` of joints
    were proved; ``left`` is a part of the box that could not be proved. Coordinates and sides are
    in the order of ``names``.
    """

    status: Literal["proved", "fails", "undecided"]
    boxes: int
    groups: int
    names: tuple[str, ...]
    witness: Witness | None = None
    left: Box = ()

    @property
    def text(self) -> str:
        """The result in one line."""
        count = f"{self.boxes} box{'es' if self.boxes != 1 else ''}"
        if self.status == "proved":
            groups = f"{self.groups} group{'s' if self.groups != 1 else ''} of joints"
            rest = "every body at rest puts every joint at rest"
            return f"positive definite: {rest} ({groups}) ({count})"
        if self.witness is None:
            sides = zip(self.names, self.left, strict=True)
            parts = ", ".join(f"{name} in {side_text(side)}" for name, side in sides)
            return f"undecided ({count}): neither proved nor refuted where {parts}"
        vector = ", ".join(map(str, self.witness.vector))
        if self.witness.identically:
            every = f"v'Mv = 0 for v = ({vector}) at every point of the box"
            return f"not positive definite anywhere: {every} ({count})"
        pairs = zip(self.names, self.witness.point, strict=True)
        point = ", ".join(f"{name} = {value}" for name, value in pairs)
        return f"not positive definite: v'Mv <= 0 for v = ({vector}) at {point} ({count})"


def mass_matrix_check(model: RobotModel, *, budget: int = BOXES) -> Definiteness:
    """Whether M(q, theta) is positive definite for all q in range and all theta.

    Args:
        model: the robot, in its joints' own coordinates.
        budget: the most boxes to examine.
    """
    with working_precision(PRECISION):
        # M is the sum of the contributions of bodies and rotors: a rotor at rest implies a zero
        # rate.
        turning = (i for i, d in enumerate(model.dofs) if d.inertia and closed_ball(d.inertia) > 0)
        known = frozenset(turning)
        return _Check(model, body_motions(model), robot_box(model), budget, known).run()


@dataclass(slots=True)
class _Check:
    """One check; the rates of the joints ``known`` are zero, ``boxes`` were examined."""

    model: RobotModel
    motions: BodyMotions
    box: Box
    budget: int
    known: frozenset[int] = frozenset()
    groups: int = 0
    boxes: int = 0
    left: Box = ()

    def run(self) -> Definiteness:
        parameters = (f"{p.module}.{p.name} at {p.symbol}" for p in self.model.parameters)
        names = (*(f"q{i + 1}" for i in range(len(self.model.dofs))), *parameters)
        witness = None
        for share in (FEW, self.budget // SHARE, self.budget):
            rest = self.prove(share)
            if not rest:
                return Definiteness("proved", self.boxes, self.groups, names)
            if share == FEW:
                witness = SingularSearch(self.model, self.motions, self.box, rest).witness()
            if witness is not None:
                return Definiteness("fails", self.boxes, self.groups, names, witness)
        return Definiteness("undecided", self.boxes, self.groups, names, left=self.left)

    def prove(self, share: int) -> list[int]:
        """Prove groups of joints one by one, small ones first; return the remaining joints."""
        moved = [self.motions.moved_by(body) for body in range(len(self.model.bodies))]
        while rest := [i for i in range(len(self.model.dofs)) if i not in self.known]:
            groups = {tuple(i for i in dofs if i not in self.known) for dofs in (*moved, rest)}
            ordered = sorted(groups - {()}, key=lambda each: (len(each), each))
            if not any(self.proved(group, share) for group in ordered):
                break
        return rest

    def proved(self, group: Sequence[int], share: int) -> bool:
        """Whether the rates of a group are zero, given the known ones, with all bodies at rest."""
        allowed = min(share, self.budget - self.boxes)
        if allowed <= 0:
            self.left = self.left or self.box
            return False
        inside = self.known.union(group)
        bodies = [
            body
            for body in range(len(self.model.bodies))
            if inside.issuperset(dofs := self.motions.moved_by(body))
            and not set(group).isdisjoint(dofs)
        ]
        found = rest_test(self.motions, group, bodies).proof(self.box, allowed)
        self.boxes += found.boxes
        if found.left is not None:
            self.left = found.left
            return False
        self.known, self.groups = inside, self.groups + 1
        return True


class SingularSearch:
    """Searches for a witness against M in the rows and columns of some joints, over a box."""

    def __init__(
        self, model: RobotModel, motions: BodyMotions, box: Box, rest: Sequence[int]
    ) -> None:
        graph, n = robot_graph(model), len(model.dofs)
        self.model, self.box, self.rest = model, box, list(rest)
        z, k = motions.variables, ca.SX.sym("k", len(graph.constants))
        matrix = ca.densify(graph.mass_matrix(z[:n], z[n:], k))[self.rest, self.rest]
        # Joints that move all bodies as a whole change no entry of M.
        still = still_joints(model, range(n), range(len(model.bodies))) if model.bodies else []
        if still:
            matrix = ca.substitute(matrix, z[still], ca.SX.zeros(len(still)))
        entries = ca.densify(ca.vec(matrix))
        self.values: Tape = tape(ca.Function("values", [z, k], [ca.cse(entries)]))
        self.numeric = ca.Function("matrix", [z, k], [ca.densify(matrix)])
        pattern = ca.jacobian_sparsity(entries, z)
        self.active = sorted({int(column) for column in pattern.get_triplet()[1]})
        self.constants = graph.constants

    def witness(self) -> Witness | None:
        """A witness for all points of the box, else one at a natural point; None if not found."""
        if self.values.uses("sign"):
            return None
        points = list(self.scattered())
        matrices = [self.at(point) for point in points]
        if all(np.all(np.isfinite(matrix)) for matrix in matrices):
            ring = PolynomialRing()
            inputs = [ring.symbol(Variable("coordinate", i)) for i in range(len(self.box))]
            entries = self.exact(ring, inputs)
            for vector in null_vectors(matrices) if entries is not None else ():
                if not _form(ring, entries or [], vector).terms:
                    return Witness(self.whole(vector), identically=True)
        for natural in islice(self.natural_points(), POINTS):
            found = self.vector(natural)
            if found is not None:
                return Witness(self.whole(found), natural)
        return None

    def vector(self, point: Sequence[PiLinear]) -> tuple[Fraction, ...] | None:
        """A vector v with v'Mv <= 0 at a point, exactly zero or a negative ball, or None."""
        matrix = self.at([float(value.ball()) for value in point])
        if not np.all(np.isfinite(matrix)) or not _doubtful(matrix):
            return None
        ring = PolynomialRing()
        entries = self.exact(ring, [_number(ring, value) for value in point])
        inputs = [*(v.ball() for v in point), *map(constant_ball, self.constants)]
        balls, n = self.values.evaluate(inputs, BALLS), len(self.rest)
        for vector in (*null_vectors([matrix]), *_lowest(matrix)):
            if entries is not None and not _form(ring, entries, vector).terms:
                return vector
            pairs = product(range(n), repeat=2)
            if sum(ball(vector[i] * vector[j]) * balls[j * n + i] for i, j in pairs) < 0:
                return vector
        return None

    def exact(
        self, ring: PolynomialRing, inputs: Sequence[TrigonometricPolynomial]
    ) -> list[TrigonometricPolynomial] | None:
        """The entries of M, column by column, as polynomials; None if they get too long."""
        constants = [
            ring.rational(c.value) if isinstance(c, Constant) else ring.symbol(Pi())
            for c in self.constants
        ]
        try:
            return self.values.evaluate([*inputs, *constants], CanonicalEvaluator(ring))
        except TooManyTerms:
            return None

    def at(self, point: Sequence[float]) -> Array:
        """M in the rows and columns of the r joints, (r, r), in floating point."""
        constants = [float(constant_ball(constant)) for constant in self.constants]
        return np.asarray(self.numeric(ca.DM(list(point)), ca.DM(constants)).full())

    def whole(self, vector: Sequence[Fraction]) -> tuple[Fraction, ...]:
        """The vector with zeros inserted for the joints that are not examined."""
        found = [Fraction(0)] * len(self.model.dofs)
        for i, item in zip(self.rest, vector, strict=True):
            found[i] = item
        return tuple(found)

    def scattered(self) -> Iterator[list[float]]:
        """A few arbitrary points, the same on every call."""
        rng = np.random.default_rng(0)
        for _ in range(SCATTERED):
            parts = [side[int(rng.integers(len(side)))] for side in self.box]
            bounds = [(max(float(p.low), -3.0), float(p.high)) for p in parts]
            yield [
                rng.uniform(low, high if high < np.inf else max(low, 0) + 3) for low, high in bounds
            ]

    def natural_points(self) -> Iterator[tuple[PiLinear, ...]]:
        """The first natural values of all sides, and points that differ from them in one or two."""
        options = [natural_values(domain, angle=angle) for domain, angle in domains(self.model)]
        if not all(options):
            return
        base = tuple(values[0] for values in options)
        for count in range(3):
            for chosen in combinations(self.active, count):
                for values in product(*(options[i] for i in chosen)):
                    point = list(base)
                    for i, value in zip(chosen, values, strict=True):
                        point[i] = value
                    yield tuple(point)


def _form(
    ring: PolynomialRing, entries: Sequence[TrigonometricPolynomial], vector: Sequence[Fraction]
) -> TrigonometricPolynomial:
    """v'Mv; it has no terms, and is thus zero, if M v is zero."""
    total, n = ring.rational(0), len(vector)
    for i, j in product(range(n), repeat=2):
        if vector[i] and vector[j]:
            total = ring.add(total, ring.scaled(entries[j * n + i], vector[i] * vector[j]))
    return total


def _number(ring: PolynomialRing, value: PiLinear) -> TrigonometricPolynomial:
    turns = ring.scaled(ring.symbol(Pi()), value.pis) if value.pis else ring.rational(0)
    return ring.add(ring.rational(value.rational), turns)


def _doubtful(matrix: Array) -> bool:
    """Whether a matrix is not clearly positive definite in floating point."""
    diagonal = np.diag(matrix)
    # An absolute test as well: an exact zero may be rounded to a positive number.
    if not np.all(diagonal > SINGULAR):
        return True
    scale = 1 / np.sqrt(diagonal)
    return bool(np.linalg.eigvalsh(matrix * np.outer(scale, scale))[0] < SINGULAR)


def _lowest(matrix: Array) -> Iterator[tuple[Fraction, ...]]:
    """Short rationals near the eigenvector of the least eigenvalue."""
    vector = np.linalg.eigh(matrix)[1][:, 0]
    vector = vector / vector[int(np.argmax(np.abs(vector)))]
    for bound in (16, DENOMINATOR, 10**6):
        yield _integral([Fraction(float(item)).limit_denominator(bound) for item in vector])


def null_vectors(matrices: Sequence[Array]) -> list[tuple[Fraction, ...]]:
    """Short integer vectors that all matrices (n, n) seem to annihilate, in floating point."""
    n = len(matrices[0])
    # An exact zero may be rounded to a small number, which must not be scaled up.
    sizes = [max(float(np.abs(matrix).max()), SINGULAR) for matrix in matrices]
    stacked = np.vstack([matrix / size for matrix, size in zip(matrices, sizes, strict=True)])
    _, singular, rows = np.linalg.svd(stacked)
    null = np.array(rows[[i for i in range(n) if singular[i] < SINGULAR]])
    # The reduced row echelon form, with the largest pivots.
    for i in range(len(null)):
        column = int(np.argmax(np.abs(null[i])))
        null[i] /= null[i, column]
        others = [k for k in range(len(null)) if k != i]
        null[others] -= np.outer(null[others, column], null[i])
    found = [[Fraction(float(x)).limit_denominator(DENOMINATOR) for x in row] for row in null]
    return [_integral(row) for row in found if any(row)]


def _integral(vector: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """The multiple with coprime integer entries whose first non-zero entry is positive."""
    scale = lcm(*(item.denominator for item in vector))
    whole = [int(item * scale) for item in vector]
    common = gcd(*whole) * (1 if next(item for item in whole if item) > 0 else -1)
    return tuple(Fraction(item, common) for item in whole)
