r"""The kinematic refutation of a robot in nonlinear real arithmetic, as an SMT-LIB 2 script.

Statement: for some parameters in range and some effector there are a start pose and a target pose
with the effector in the start region and in the target, both within the bounds. For a region that a
formula makes an effector visit, a separate question has this region as its target. ``unsat`` proves
that the structure cannot do the task; every relaxation only enlarges the set of solutions.

Along the frames to an effector, rigid *segments* lie between revolute joints. Segment j displaces
by a vector of length :math:`r_j(\theta)` that its joint turns freely. Vectors :math:`w_1, \dots,
w_n` of the plane, or of space, with :math:`|w_j| = r_j` and sum v exist iff

.. math:: |v| \le \sum_j r_j, \qquad r_k \le |v| + \sum_{j \ne k} r_j \quad (k = 1, \dots, n)

(the polygon inequality; for n = 1 it says :math:`|v| = r_1`), so the positions of the joints need
not be unknowns, which would take nearly all of the time of z3's nonlinear solver. In the plane this
is exact except for the limits of revolute joints. In space the leading joints about parallel axes
keep the components along their axis and turn those across it. All later joints turn freely about
any axis, so their segments add a vector across of length e and one along of length h with
:math:`e^2 + h^2 = |v|^2`, v as above.

Source: Kapovich & Millson, *On the moduli space of polygons in the Euclidean plane*.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

from compiler.encodings.pose_questions import PoseQuestion, effector_choices
from compiler.encodings.region_terms import (
    FALSE,
    Formula,
    Quantity,
    RealScript,
    add,
    all_of,
    any_of,
    at_most,
    constant,
    equal,
    inside,
    multiply,
    non_negative,
    subtract,
    sum_of_squares,
)
from compiler.encodings.scalar_terms import ScalarTerms, absolute, slide_term
from compiler.expressions.evaluators.balls import working_precision
from compiler.expressions.scalars import Constant
from compiler.robots.robot import Joint, Offset, RobotModel, Step, Turn
from grammar_lang import ir

PRECISION = 128
LETTERS = "xyz"

Pose: TypeAlias = Literal["start", "target"]
Vector: TypeAlias = tuple[Quantity, Quantity, Quantity]

HEADER = """\
Is there a robot of this structure with a pose that brings an effector into the start region and a
pose that brings {who} into {target}, within the bounds?  unsat: there is none, so no robot of this
structure does the task.  Limits of revolute joints, the dynamics and the obstacles are left out,
and irrational numbers lie in rational intervals: all this can only add solutions.  SI units."""

FIXED_START = """\
Is there a robot of this structure with a pose that brings an effector into {target}, within the
bounds?  unsat: there is none, so no robot of this structure does the task.  The start pose, limits
of revolute joints, the dynamics and the obstacles are left out, and irrational numbers lie in
rational intervals: all this can only add solutions.  SI units."""

NO_CANDIDATE = "No effector of the structure is a candidate, or the start pose is of another robot."


# --------------------------------------------------------------------------------------------------
# The rigid segments between the revolute joints of a chain, as far as positions depend on them.


@dataclass(frozen=True, slots=True)
class Segment:
    """The steps between two revolute joints; ``axis`` of the first joint, None at the base."""

    axis: int | None
    steps: tuple[Step, ...]


Chain: TypeAlias = tuple[Segment, ...]


def segments(model: RobotModel, frame: int) -> tuple[Segment, ...]:
    """The segments from the world to a frame, the base segment first.

    A rigid rotation directly after a revolute joint and about its axis is left out: the joint
    absorbs it. A displacement along its axis there commutes with the joint, so it belongs to the
    segment before. Joints after the last displacement move no effector.
    """
    found: list[tuple[int | None, list[Step]]] = [(None, [])]
    for step in model.steps(frame):
        if isinstance(step, Joint) and model.dofs[step.dof].kind == "revolute":
            found.append((step.axis, []))
            continue
        if isinstance(step, Turn) and found[-1] == (step.axis, []):
            continue
        place = len(found) - 1
        axis = _direction(model, step)
        while axis is not None and found[place] == (axis, []):
            place -= 1
        found[place][1].append(step)
    while len(found) > 1 and not found[-1][1]:
        found.pop()
    return tuple(Segment(axis, tuple(steps)) for axis, steps in found)


def _direction(model: RobotModel, step: Step) -> int | None:
    """The axis that a step displaces along; None if it rotates or has no known axis."""
    match step:
        case Joint(axis=axis):
            return axis
        case Offset(vector):
            along = [i for i in range(3) if model.scalars[vector[i]] != Constant(Fraction(0))]
            return along[0] if len(along) == 1 else None
        case Turn():
            return None


def refutation_script(model: RobotModel, question: PoseQuestion) -> str:
    """The script of a robot and a task: SMT-LIB 2, QF_NRA, the same bytes for the same input."""
    chains = [segments(model, frame) for frame in model.effectors]
    # A dict keeps the order: effectors that move alike are one alternative.
    pairs = list(
        dict.fromkeys((chains[i], chains[j]) for i, j in effector_choices(model, question))
    )
    script = RealScript()
    header = HEADER if question.start is not None else FIXED_START
    script.comment(header.format(who=question.who, target=question.goal))
    script.lines.append("(set-logic QF_NRA)")
    if pairs:
        with working_precision(PRECISION):
            _Encoding(model, question, script).write(pairs)
    else:
        script.comment(NO_CANDIDATE)
        script.assertion(FALSE)
    script.lines.append("(check-sat)")
    return "\n".join(script.lines) + "\n"


@dataclass(slots=True)
class _Encoding:
    model: RobotModel
    question: PoseQuestion
    script: RealScript
    scalars: ScalarTerms = field(init=False)
    _coordinates: dict[tuple[int, Pose], Quantity] = field(
        default_factory=dict[tuple[int, Pose], Quantity]
    )
    _displacements: dict[tuple[Segment, Pose | None], Vector] = field(
        default_factory=dict[tuple[Segment, "Pose | None"], Vector]
    )
    _radii: dict[tuple[Formula, ...], Quantity] = field(
        default_factory=dict[tuple[Formula, ...], Quantity]
    )

    def __post_init__(self) -> None:
        self.scalars = ScalarTerms(self.model, self.script)

    def write(self, pairs: list[tuple[Chain, Chain]]) -> None:
        """Write everything between the logic and the check."""
        script, question = self.script, self.question
        self._define_scalars(pairs)
        start = self._position("start", question.start) if question.start is not None else None
        target = self._position("target", question.target)
        alternatives: list[list[Formula]] = []
        for number, (starting, reaching) in enumerate(pairs, 1):
            many = f" (alternative {number} of {len(pairs)})" if len(pairs) > 1 else ""
            script.comment(
                "Reach: lengths r of the segments between revolute joints, and distances rho from\n"
                f"the first joint, with the polygon inequality{many}."
            )
            parts: list[Formula] = []
            if start is not None:
                parts += self._reached(starting, "start", start)
            parts += self._reached(reaching, "target", target)
            alternatives.append(parts)
        if len(alternatives) == 1:
            script.assertion(*alternatives[0])
        else:
            script.comment("One of the alternatives.")
            script.assertion(any_of([all_of(parts) for parts in alternatives]))

    def _define_scalars(self, pairs: list[tuple[Chain, Chain]]) -> None:
        lengths = set[int]()
        chains = [reaching for _, reaching in pairs]
        if self.question.start is not None:
            chains += [starting for starting, _ in pairs]
        for chain in chains:
            for segment in chain:
                for step in segment.steps:
                    if isinstance(step, Offset):
                        lengths.update(step.vector)
        self.scalars.define(lengths)

    def _position(self, pose: Pose, region: tuple[ir.HalfSpace, ...]) -> Vector:
        """The unknown position of the effector, in a region and within the bounds."""
        script = self.script
        script.comment(f"The position of the effector at the {pose} pose, in its region.")
        position = [script.declare(f"{pose}_{LETTERS[i]}") for i in range(self.model.dimension)]
        for row in (*region, *self.question.bounds):
            script.assertion(inside(row, position))
        position += [constant(0)] * (3 - len(position))
        return position[0], position[1], position[2]

    # --- segments ---

    def _displacement(self, segment: Segment, pose: Pose) -> Vector:
        """The vector from the segment's first origin to its last, in its first frame."""
        moving = any(isinstance(step, Joint) for step in segment.steps)
        key = (segment, pose if moving else None)
        if key not in self._displacements:
            self._displacements[key] = self._new_displacement(segment, pose)
        return self._displacements[key]

    def _new_displacement(self, segment: Segment, pose: Pose) -> Vector:
        """The displacement by Horner's scheme, from the far end: terms grow linearly with steps."""
        script = self.script
        vector = [constant(0)] * 3
        for step in reversed(segment.steps):
            match step:
                case Offset(offset):
                    pairs = zip(vector, offset, strict=True)
                    vector = [add(v, self.scalars.term(o)) for v, o in pairs]
                case Joint(dof, axis, sign):
                    way = multiply(constant(sign), self._coordinate(dof, pose))
                    vector[axis] = add(vector[axis], way)
                case Turn(axis, angle):
                    vector = self._turned(vector, axis, angle, 1)
        x, y, z = (script.named("d", v) for v in vector)
        return x, y, z

    def _turned(self, vector: list[Quantity], axis: int, angle: int, sign: int) -> list[Quantity]:
        """The vector rotated by ``sign`` times an angle."""
        script, turn = self.script, self.scalars.angle(angle)
        sine = multiply(constant(sign), turn.sine)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        u, v = (script.named("d", vector[k]) for k in (i, j))
        rotated = list(vector)
        rotated[i] = subtract(multiply(turn.cosine, u), multiply(sine, v))
        rotated[j] = add(multiply(sine, u), multiply(turn.cosine, v))
        return rotated

    def _coordinate(self, dof: int, pose: Pose) -> Quantity:
        """The coordinate of a prismatic joint at a pose, within its outer rational limits."""
        if (dof, pose) not in self._coordinates:
            self._coordinates[dof, pose] = slide_term(self.model, self.script, dof, pose)
        return self._coordinates[dof, pose]

    # --- positions ---

    def _reached(self, chain: Chain, pose: Pose, position: Vector) -> list[Formula]:
        """The constraints under which the chain's end can be at a position."""
        script, (base, *moving) = self.script, chain
        pairs = zip(position, self._displacement(base, pose), strict=True)
        rest = [subtract(p, d) for p, d in pairs]
        axis = moving[0].axis if moving else None
        if axis is None:
            return [equal(r, constant(0)) for r in rest]
        rest = self._from_base(base, rest, axis)
        count = _parallel(moving)
        head = [self._displacement(segment, pose) for segment in moving[:count]]
        tail = [self._displacement(segment, pose) for segment in moving[count:]]
        along = subtract(rest[axis], add(*(d[axis] for d in head)))
        across = [i for i in range(3) if i != axis]
        radii = self._lengths([tuple(d[i] for i in across) for d in head])
        formulas: list[Formula] = []
        later = self._lengths(tail)
        if later:
            # The later segments add a vector across, of any direction in the plane, and one along.
            aside = script.fresh(f"{pose}_r")
            script.assertion(non_negative(aside))
            formulas += self._polygon([aside, along], later, pose)
            radii.append(aside)
        else:
            formulas.append(equal(along, constant(0)))
        return formulas + self._polygon([rest[i] for i in across], radii, pose)

    def _from_base(self, base: Segment, vector: list[Quantity], axis: int) -> list[Quantity]:
        """A world vector in the frame of the first joint, up to a rotation about its axis."""
        turns = [step for step in base.steps if isinstance(step, Turn)]
        while turns and turns[-1].axis == axis:
            turns.pop()
        for turn in turns:
            vector = self._turned(vector, turn.axis, turn.angle, -1)
        return [self.script.named("d", v) for v in vector] if turns else vector

    def _lengths(self, vectors: Sequence[tuple[Quantity, ...]]) -> list[Quantity]:
        """The lengths of the non-zero vectors."""
        kept = [tuple(q for q in vector if q.value != 0) for vector in vectors]
        return [self._length(parts) for parts in kept if parts]

    def _length(self, parts: tuple[Quantity, ...]) -> Quantity:
        """The Euclidean norm of a vector, shared by both poses if the vector is."""
        script, key = self.script, tuple(part.text for part in parts)
        if key not in self._radii:
            if len(parts) == 1:
                self._radii[key] = absolute(script, parts[0])
            else:
                self._radii[key] = self._norm("r", parts)
        return self._radii[key]

    def _norm(self, prefix: str, parts: tuple[Quantity, ...]) -> Quantity:
        script, square = self.script, sum_of_squares(parts)
        known = script.number(square.ball.sqrt())
        if known is not None:
            return known
        norm = script.fresh(prefix)
        script.assertion(non_negative(norm))
        script.assertion(equal(multiply(norm, norm), square))
        return norm

    def _polygon(self, total: list[Quantity], radii: list[Quantity], pose: Pose) -> list[Formula]:
        """Formulas that vectors of these lengths, freely turned, can have this sum."""
        if not radii:
            return [equal(part, constant(0)) for part in total]
        if len(radii) == 1:
            squared = multiply(radii[0], radii[0])
            return [equal(sum_of_squares(tuple(total)), squared)]
        distance = self._norm(f"{pose}_rho", tuple(total))
        length = add(*radii)
        around = add(distance, *radii)
        twice = constant(Fraction(2))
        formulas = [at_most(distance, length)]
        sides = dict.fromkeys(radius.text for radius in radii)
        unique = [next(r for r in radii if r.text == side) for side in sides]
        return formulas + [at_most(multiply(twice, r), around) for r in unique]


def _parallel(moving: list[Segment]) -> int:
    """The number of leading joints that turn about parallel axes."""
    axis, count = moving[0].axis, 0
    for segment in moving:
        if segment.axis != axis:
            break
        count += 1
        if any(isinstance(step, Turn) and step.axis != axis for step in segment.steps):
            break
    return count
