"""The coordinates of a robot whose task gives the coordinates of its word: ``start at``.

A task gives one value for each degree of freedom of the word. In the normal form of the robot,
joints about one axis are one coordinate, their sum, and joints that move nothing are left out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from compiler.expressions.evaluators.balls import closed_ball, working_precision
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.diagnostics.wording import counted
from grammar_lang.ir.constants import MagnitudeError, binary, evident, unary

PRECISION = 256
"""Bits for values and ends of ranges that cannot be compared exactly."""


@dataclass(frozen=True, slots=True)
class JointValue:
    """The value of the degree of freedom ``number`` of the word, from 0, and its range."""

    number: int
    value: ir.Expr
    range: ir.Interval


@dataclass(frozen=True, slots=True)
class GivenStart:
    """The start that a task gives a robot.

    ``values`` are the coordinates of the model, closed expressions in SI units. ``fault`` says why
    the robot is not a candidate of the task; ``values`` is empty then. The values in ``undecided``
    lie in the ranges of their joints, or so close to an end that this cannot be decided.

    Only joints that are merged or left out are checked here, as the range of a coordinate does not
    cover them. The range of any other joint is the range of its coordinate.
    """

    values: tuple[ir.Expr, ...]
    fault: str = ""
    undecided: tuple[JointValue, ...] = ()

    @property
    def key(self) -> str:
        """A text that is equal for two starts of one robot only if they are the same."""
        return f"start {self.values} {self.fault} {[(v.value, v.range) for v in self.undecided]}"


def given_start(model: RobotModel, start: ir.StartAt) -> GivenStart:
    """The start of a robot in normal form; it is the same at every working precision."""
    fault = _unfit(model, start)
    if fault:
        return GivenStart((), fault)
    terms: list[list[ir.Expr]] = [[] for _ in model.dofs]
    for joint, value in zip(model.word_dofs, start.values, strict=True):
        if joint.dof is not None:
            terms[joint.dof].append(value if joint.sign > 0 else _negative(value))
    undecided: list[JointValue] = []
    for joint_value in _hidden(model, start):
        known = _in_range(joint_value)
        if known is False:
            number = joint_value.number + 1
            return GivenStart((), f"value {number} of the start is out of the range of its joint")
        if known is None:
            undecided.append(joint_value)
    return GivenStart(tuple(_sum(values) for values in terms), "", tuple(undecided))


def _unfit(model: RobotModel, start: ir.StartAt) -> str:
    """Why the values do not fit the degrees of freedom of the word; empty if they do."""
    joints = model.word_dofs
    if len(joints) != len(start.values):
        given, due = counted(len(start.values), "coordinate"), counted(len(joints), "degree")
        return f"the start gives {given}, and the word has {due} of freedom"
    for number, joint in enumerate(joints):
        if start.kind(number) not in (None, joint.kind):
            what = "an angle" if start.kind(number) == "revolute" else "a length"
            return f"value {number + 1} of the start is {what}, and its joint is {joint.kind}"
    return ""


def _hidden(model: RobotModel, start: ir.StartAt) -> Iterator[JointValue]:
    """The values of the joints whose range is not the range of a coordinate."""
    joints = model.word_dofs
    summands = Counter(joint.dof for joint in joints)
    for number, (joint, value) in enumerate(zip(joints, start.values, strict=True)):
        alone = joint.dof is not None and summands[joint.dof] == 1
        if joint.range is not None and not alone:
            yield JointValue(number, value, joint.range)


# --- ranges ------------------------------------------------------------------------------------


def _in_range(joint: JointValue) -> bool | None:
    """Whether a value is in its closed range; None if that is not decided."""
    ends = _at_most(joint.range.lower, joint.value), _at_most(joint.value, joint.range.upper)
    if False in ends:
        return False
    return None if None in ends else True


def _at_most(a: ir.Expr, b: ir.Expr) -> bool | None:
    """Whether ``a <= b``: exactly for rational multiples of one power of pi, else in balls."""
    p, q = evident(a), evident(b)
    if p is not None and q is not None and (p[1] == q[1] or not p[0] or not q[0]):
        return p[0] <= q[0]  # a power of pi is positive
    with working_precision(PRECISION):
        left, right = closed_ball(a), closed_ball(b)
        if not (left.is_finite() and right.is_finite()):
            return None
        if a == b or left <= right:
            return True
        return False if left > right else None


# --- sums --------------------------------------------------------------------------------------


def _negative(value: ir.Expr) -> ir.Expr:
    try:
        return unary("neg", value)
    except MagnitudeError:
        return ir.Unary("neg", value)


def _sum(terms: Sequence[ir.Expr]) -> ir.Expr:
    """The sum of one or more terms, added in pairs to keep it shallow; one term is unchanged."""
    while len(terms) > 1:
        pairs = [terms[i : i + 2] for i in range(0, len(terms), 2)]
        terms = [pair[0] if len(pair) == 1 else _plus(*pair) for pair in pairs]
    return terms[0]


def _plus(a: ir.Expr, b: ir.Expr) -> ir.Expr:
    try:
        return binary("+", a, b)
    except MagnitudeError:
        return ir.Binary("+", a, b)
