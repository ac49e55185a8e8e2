"""`aligned`, `oriented` and `payload` in tasks: what they mean, and what is reported."""

from __future__ import annotations

from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Diagnostic, Sink
from grammar_lang.formatting.formatter import canonical
from grammar_lang.ir.constants import to_float
from grammar_lang.ir.formula_parts import asked_poses
from grammar_lang.load import load_text
from tests.oracles.small_specs import TURNER, replaced


def read(clauses: str, text: str = TURNER) -> tuple[ir.Task | None, tuple[Diagnostic, ...]]:
    found = load_text(replaced(text, "reach T;", clauses), "spec.srg")
    task = None if found.program is None else found.program.tasks["Turn"]
    return task, found.diagnostics


def reach(clauses: str) -> ir.Reach:
    task, diagnostics = read(clauses)
    assert task is not None, diagnostics
    return task.goal


def test_poses_of_a_reach() -> None:
    found = reach("reach T by effector 1 aligned -y to (3, -4) within 5 deg at rest;")
    (pose,) = found.poses
    assert isinstance(pose, ir.Aligned)
    assert pose.axis == "-y"
    assert pose.direction == (3, -4)
    assert to_float(pose.within) == pytest.approx(5 * 3.141592653589793 / 180)
    assert found.rates is not None
    assert reach("reach T;").poses == ()
    found = reach(
        "reach T oriented rot(z, 30 deg) * (world * rot(-z, 1/2)) within 2 deg "
        "aligned x to (0, 1) within 1;"
    )
    turned, aligned = found.poses
    assert isinstance(aligned, ir.Aligned)
    assert isinstance(turned, ir.Oriented)
    assert [axis for axis, _ in turned.turns] == ["z", "-z"]
    assert to_float(turned.turns[0][1]) == pytest.approx(3.141592653589793 / 6)
    assert turned.turns[1][1] == ir.Num(Fraction(1, 2))


@pytest.mark.parametrize(
    ("clauses", "said"),
    [
        ("reach T aligned z to (0, 1) within 5 deg;", "is perpendicular to the plane"),
        ("reach T aligned x to (0, 0) within 5 deg;", "a direction is not zero"),
        ("reach T aligned x to (0, 1, 0) within 5 deg;", "expected 2 coordinates"),
        ("reach T aligned x to (0, 1) m within 5 deg;", "expected a plain number"),
        ("reach T aligned x to (0, 1) within 0;", "not between zero and a half turn"),
        ("reach T aligned x to (0, 1) within 180 deg;", "not between zero and a half turn"),
        ("reach T aligned x to (0, 1) within 1 m;", "found a length"),
        ("reach T oriented rot(x, 3) within 1;", "leaves the plane"),
        ("reach T oriented move(x, 3 m) within 1;", "rotations, without moves"),
        ("reach T oriented 3 within 1;", "expected a frame"),
        ("reach T oriented rot(z, JO.q) within 1;", "is not a constant"),
        ("reach T aligned w to (0, 1) within 1;", "expected `x`, `y` or `z`"),
        ("reach T at rest aligned x to (0, 1) within 1;", "expected `;` or `for`"),
    ],
)
def test_poses_that_are_none(clauses: str, said: str) -> None:
    task, diagnostics = read(clauses)
    assert any(said in each.message and each.hint for each in diagnostics), diagnostics
    assert task is None or all(each.span for each in diagnostics)


def test_poses_of_atoms() -> None:
    task, diagnostics = read(
        "reach T; satisfy eventually (T by effector 1 aligned x to (0, 1) within 5 deg "
        "oriented rot(z, 1) within 1 and not T);"
    )
    assert task is not None, diagnostics
    formula = task.satisfy[0].formula
    assert isinstance(formula, ir.Eventually)
    assert isinstance(formula.operand, ir.And)
    posed, plain = formula.operand.operands
    assert isinstance(posed, ir.Atom)
    assert plain == ir.Not(ir.Atom("T", 1))
    aligned, turned = posed.poses
    assert posed == ir.Atom("T", 1, poses=(aligned, turned))
    assert posed != ir.Atom("T", 1)
    assert isinstance(aligned, ir.Aligned)
    assert aligned.direction == (0, 1)
    assert isinstance(turned, ir.Oriented)
    assert asked_poses(task) == (aligned, turned)


@pytest.mark.parametrize(
    ("atom", "said"),
    [
        ("T aligned z to (0, 1) within 5 deg", "is perpendicular to the plane"),
        ("T aligned x to (0, 0) within 5 deg", "a direction is not zero"),
        ("T oriented move(x, 3 m) within 1", "rotations, without moves"),
        ("T aligned x to (0, 1) within 0", "not between zero and a half turn"),
        ("T aligned x to (0, 1)", "expected `within`"),
        ("aligned x to (0, 1) within 1", "expected"),
    ],
)
def test_poses_of_atoms_that_are_none(atom: str, said: str) -> None:
    task, diagnostics = read(f"reach T; satisfy always not ({atom});")
    assert any(said in each.message and each.hint for each in diagnostics), diagnostics
    assert task is None or all(each.span for each in diagnostics)


def test_a_motion_without_end_may_come_to_a_pose() -> None:
    task, diagnostics = read("reach T aligned x to (0, 1) within 1; repeat;")
    assert task is not None, diagnostics
    assert len(task.goal.poses) == 1


def test_payloads() -> None:
    task, _ = read("reach T; payload 500 g; robust payload 5 %;")
    assert task is not None
    assert task.payloads == (ir.Payload(Fraction(1, 2), None),)
    assert task.robust is not None
    assert task.robust.payload == Fraction(1, 20)
    task, _ = read("reach T by effector 2; payload 1 kg; payload (1/3) kg by effector 1;")
    assert task is not None
    assert task.payloads == (ir.Payload(Fraction(1), 2), ir.Payload(Fraction(1, 3), 1))


@pytest.mark.parametrize(
    ("clauses", "said"),
    [
        ("reach T; payload 0 kg;", "the payload is not positive"),
        ("reach T; payload 2 m;", "expected a mass (kg)"),
        ("reach T; payload pi * 1 kg;", "not a rational number"),
        ("reach T; payload 1 kg; payload 2 kg;", "a second `payload`"),
        ("reach T by effector 1; payload 1 kg; payload 2 kg by effector 1;", "a second `payload`"),
        ("reach T; payload 1 kg by effector 0;", "at least 1"),
        ("reach T; robust payload 5 %;", "has no `payload`"),
        ("reach T; payload 1 kg; robust payload 100 %;", "not between 0 % and 100 %"),
    ],
)
def test_payloads_that_are_none(clauses: str, said: str) -> None:
    _, diagnostics = read(clauses)
    assert any(said in each.message and each.hint for each in diagnostics), diagnostics


def test_canonical_form() -> None:
    loose = (
        "reach   T aligned  - x  to(0,1)within 5deg   oriented rot( z,1 )within 2 ;payload 2kg ;"
    )
    written = canonical(replaced(TURNER, "reach T;", loose), Sink())
    assert written is not None
    due = "reach T aligned -x to (0, 1) within 5 deg oriented rot(z, 1) within 2;"
    assert due in written
    assert "  payload 2 kg;\n" in written
