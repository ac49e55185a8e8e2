"""Where robots start that are given the coordinates of their words, against chains by hand."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.pose_questions import effector_choices, pose_questions
from compiler.expressions.evaluators.balls import working_precision
from compiler.robots.given_start import GivenStart, given_start
from compiler.robots.normal_form import family_of, normalise
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key, robot_key_in_task
from compiler.words.structures import structures
from grammar_lang import ir
from grammar_lang.ir.constants import rational, to_float
from tests.oracles.formulas import program
from tests.oracles.joint_chains import Part, chain_spec, model_of, points_of, random_chain
from tests.oracles.robots import evaluate
from tests.oracles.some_cases import some

F = Fraction
WIDE = "in [-100, 100] deg"
ROD, TOOL = Part("rod", "x", F(1)), Part("tool")


def number(value: Fraction | int | str) -> ir.Expr:
    return ir.Num(F(value))


def start_of(model: RobotModel, *values: Fraction | int | str) -> GivenStart:
    return given_start(normalise(model), ir.StartAt(tuple(map(number, values))))


def exact(start: GivenStart) -> list[Fraction | None]:
    assert not start.fault
    return [rational(value) for value in start.values]


def turning(*axes: str, limits: tuple[int, int] | None = None) -> list[Part]:
    exact_limits = None if limits is None else (F(limits[0]), F(limits[1]))
    return [Part("revolute", axis, limits=exact_limits) for axis in axes]


# --- against chains by hand ----------------------------------------------------------------------


@pytest.mark.parametrize("dimension", [2, 3])
def test_random_chains_start_where_the_word_says(dimension: int) -> None:
    """All points are where the chain has them that is neither merged nor without idle joints."""
    merged = removed = 0
    for seed in range(120):
        parts = [replace(part, limits=None) for part in random_chain(seed, dimension)]
        rng = np.random.default_rng(seed)
        count = sum(part.moves for part in parts)
        values = [F(int(value), 16) for value in rng.integers(-40, 40, count)]
        normal = normalise(model_of(parts, dimension))
        start = given_start(normal, ir.StartAt(tuple(map(number, values))))
        assert start.fault == ""
        graph = robot_graph(normal)
        at = np.array([to_float(value) for value in start.values])
        for name, expected in zip(
            ("effectors", "body_points"), points_of(parts, values), strict=True
        ):
            found = evaluate(graph, name, at, np.zeros(0))
            np.testing.assert_allclose(found, expected[:, :dimension].ravel(), atol=1e-12)
        removed += len(normal.removed)
        merged += count - len(normal.removed) - len(normal.dofs)
    assert min(merged, removed) > 30  # there is something to be wrong about


def test_random_values_out_of_the_ranges_of_their_own_joints() -> None:
    """A joint that is a coordinate by itself is left to other checks; all others are compared."""
    seen = {False: 0, True: 0}
    for seed in range(200):
        parts = random_chain(seed)
        rng = np.random.default_rng(seed)
        joints = [part for part in parts if part.moves]
        values = [F(int(value), 2) for value in rng.integers(-3, 4, len(joints))]
        model = model_of(parts)
        normal = normalise(model)
        alone = {dof.symbols[0] for dof in normal.dofs if len(dof.symbols) == 1}
        hidden = [
            joint.limits is not None and not joint.limits[0] <= value <= joint.limits[1]
            for joint, value, dof in zip(joints, values, model.dofs, strict=True)
            if dof.symbols[0] not in alone
        ]
        start = given_start(normal, ir.StartAt(tuple(map(number, values))))
        assert bool(start.fault) is any(hidden)
        assert start.undecided == ()  # rationals are compared exactly
        seen[any(hidden)] += 1
    assert min(seen.values()) > 30


# --- sums ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("axes", "values", "sums"),
    [
        (("z", "z"), ("0.4", "0.3"), ["0.7"]),
        (("z", "-z"), ("1.2", "0.5"), ["0.7"]),
        (("-z", "z"), ("1.2", "0.5"), ["0.7"]),  # in the direction of the first
        (("z", "-z", "z"), ("1.2", "0.5", "0.2"), ["0.9"]),
        (("-z", "-z", "z"), ("1", "2", "4"), ["-1"]),
    ],
)
def test_coaxial_joints_start_at_their_signed_sum(
    axes: tuple[str, ...], values: tuple[str, ...], sums: list[str]
) -> None:
    model = model_of([*turning(*axes), ROD, TOOL])
    assert exact(start_of(model, *values)) == [F(each) for each in sums]


def test_slides_add_and_a_turn_between_is_no_matter() -> None:
    slides = [Part("prismatic", "x"), Part("turn", "x", F(1)), Part("prismatic", "-x")]
    assert exact(start_of(model_of([*slides, ROD, TOOL]), "0.5", "0.2")) == [F(3, 10)]


def test_the_values_of_idle_joints_are_left_out() -> None:
    about_itself = Part("revolute", "x")
    chain = [about_itself, *turning("z"), ROD, TOOL, *turning("z")]
    assert exact(start_of(model_of(chain), 7, "0.4", 8)) == [F(7), F(2, 5)]
    flat = [*turning("z"), ROD, about_itself, TOOL, *turning("z")]
    assert exact(start_of(model_of(flat), "0.4", 7, 8)) == [F(2, 5)]


def test_sums_of_unlike_numbers_are_kept_as_written() -> None:
    """Half a turn and the root of two: exact, and the same at any precision."""
    model = normalise(model_of([*turning("z", "-z"), ROD, TOOL]))
    start = ir.StartAt((ir.Pi(), ir.Unary("sqrt", number(2))))
    found = given_start(model, start)
    assert to_float(found.values[0]) == pytest.approx(np.pi - np.sqrt(2), abs=1e-15)
    with working_precision(20):
        assert given_start(model, start) == found


def test_a_thousand_coaxial_joints_have_a_shallow_sum() -> None:
    model = model_of([*turning(*["z"] * 1_000, limits=(-1, 1)), ROD, TOOL])
    assert exact(start_of(model, *["0.5"] * 1_000)) == [F(500)]
    root = ir.Unary("sqrt", number("0.5"))
    irrational = given_start(normalise(model), ir.StartAt((root,) * 1_000))
    assert to_float(irrational.values[0]) == pytest.approx(1_000 * np.sqrt(0.5))


# --- no candidates -------------------------------------------------------------------------------


def test_one_value_for_each_degree_of_freedom_of_the_word() -> None:
    model = model_of([*turning("z", "z"), ROD, TOOL, *turning("z")])
    assert len(normalise(model).dofs) == 1
    for values in ((), (0,), (0, 0), (0,) * 4):
        start = start_of(model, *values)
        assert start.values == ()
        assert f"the start gives {len(values)} coordinate" in start.fault
        assert start.fault.endswith("the word has 3 degrees of freedom")
    assert exact(start_of(model, 0, 0, 0)) == [F(0)]


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        (("1.5", "-1"), "value 1 of the start is out of the range of its joint"),
        (("-1", "1.0000000001"), "value 2 of the start is out of the range of its joint"),
        (("1", "-1"), ""),
    ],
)
def test_each_joint_keeps_its_own_range(values: tuple[str, str], fault: str) -> None:
    """The sum is always in the range of the sum; a range is closed."""
    model = model_of([*turning("z", "z", limits=(-1, 1)), ROD, TOOL])
    assert start_of(model, *values).fault == fault


@pytest.mark.parametrize(("value", "out"), [("1", False), ("1.0000000001", True)])
def test_an_idle_joint_keeps_its_range(value: str, *, out: bool) -> None:
    model = model_of([*turning("z"), ROD, TOOL, *turning("z", limits=(-1, 1))])
    fault = "value 2 of the start is out of the range of its joint"
    assert start_of(model, 9, value).fault == (fault if out else "")


def test_a_joint_by_itself_is_left_to_the_check_of_its_coordinate() -> None:
    model = model_of([*turning("z", limits=(-1, 1)), ROD, TOOL])
    assert exact(start_of(model, 2)) == [F(2)]


def degrees(value: int) -> ir.Expr:
    return ir.Binary("*", number(F(value, 180)), ir.Pi())


ROOTS = ir.Binary("+", ir.Unary("sqrt", number(2)), ir.Unary("sqrt", number(3)))
SAME_ROOT = ir.Unary(
    "sqrt", ir.Binary("+", number(5), ir.Binary("*", number(2), ir.Unary("sqrt", number(6))))
)


@pytest.mark.parametrize(
    ("upper", "value", "decided"),
    [
        (ir.Pi(), degrees(180), True),  # exactly the end, written in another way
        (degrees(100), degrees(100), True),
        (ROOTS, ROOTS, True),  # the same expression
        (ROOTS, SAME_ROOT, None),  # the same number, which no ball shows
        (ROOTS, number(3), True),
        (ROOTS, number("3.146264369941"), True),
        (ROOTS, number("3.146264369942"), False),
        (ir.Pi(), number("3.1415926535897932384626433832795028841971"), True),
        (ir.Pi(), number("3.1415926535897932384626433832795028841972"), False),
        (number(2), ir.Unary("sqrt", number(-1)), None),  # no number at all
    ],
)
def test_ends_of_ranges(upper: ir.Expr, value: ir.Expr, decided: bool | None) -> None:
    model = model_of([*turning("z", "z"), ROD, TOOL])
    limits = ir.Interval(number(-9), upper)
    model = replace(model, dofs=tuple(replace(dof, range=limits) for dof in model.dofs))
    for bits in (20, 300):
        with working_precision(bits):
            start = given_start(normalise(model), ir.StartAt((value, number(0))))
        assert bool(start.fault) is (decided is False)
        assert [each.number for each in start.undecided] == ([0] if decided is None else [])


def test_values_with_units_are_for_joints_of_their_kind() -> None:
    model = normalise(model_of([*turning("z"), Part("prismatic", "x"), ROD, TOOL]))

    def fault(*kinds: ir.DofKind | None) -> str:
        return given_start(model, ir.StartAt((number(0), number(0)), kinds=kinds)).fault

    assert fault(None, None) == fault("revolute", None) == fault("revolute", "prismatic") == ""
    assert fault("prismatic", None) == "value 1 of the start is a length, and its joint is revolute"
    assert fault(None, "revolute") == (
        "value 2 of the start is an angle, and its joint is prismatic"
    )


# --- robots of words -----------------------------------------------------------------------------


def robots(text: str) -> tuple[ir.Program, ir.Task, dict[str, RobotModel]]:
    """The robots of a family by their words without edges."""
    found = program(text)
    (task,) = found.tasks.values()
    family = family_of(found, task)
    return found, task, {
        " ".join(s for s in each.word if s != "eps"): family.robot(each)
        for each in structures(family.language, task.modules or 12)
    }  # fmt: skip


def starts(text: str) -> dict[str, list[Fraction | None] | str]:
    _, task, models = robots(text)
    assert isinstance(task.start, ir.StartAt)
    found = {word: given_start(model, task.start) for word, model in models.items()}
    return {word: start.fault or exact(start) for word, start in found.items()}


def test_the_order_is_that_of_the_word_not_of_the_chain() -> None:
    """K stands before J in the word, and behind it in the chain; of C the slide is declared first.

    J turns about z, K about -z: the coordinate is J's angle without K's.
    """
    text = """\
module B { role base; } module E { role effector; }
module K { role joint; dof q: revolute -z; } module J { role joint; dof q: revolute z; }
module C { role link; dof s: prismatic x in [0, 1] m; dof a: revolute z; }
grammar G { start S; all: S -> B K J C E; }
semantics G { all {
  this.arm = world * rot(z, J.q) * rot(-z, K.q) * move(x, 1 m) * rot(z, C.a) * move(x, C.s);
  point(frame: this.arm, mass: 1 kg); effector(frame: this.arm);
} }
workspace W { plane xy; bounds box [-4, 4] x [-4, 4] m; region T box [0, 1] x [0, 1] m; }
task Go { robot G; workspace W; start at (0.25, 1 rad, 0.5 m, 2); reach T; effort <= 1 N*m;
  effort <= 1 N; horizon 10 steps of 0.1 s; modules <= 5; }
"""
    _, task, models = robots(text)
    (model,) = models.values()
    assert [dof.kind for dof in model.dofs] == ["revolute", "prismatic", "revolute"]
    assert starts(text) == {"B K J C E": [F(3, 4), F(1, 2), F(2)]}
    at = np.array([to_float(value) for value in given_start(model, task.start).values])  # type: ignore[arg-type]
    tip = evaluate(robot_graph(model), "effectors", at, np.zeros(0))
    angle = 0.75
    elbow = np.array([np.cos(angle), np.sin(angle)])
    out = 0.5 * np.array([np.cos(angle + 2), np.sin(angle + 2)])
    np.testing.assert_allclose(tip, elbow + out, atol=1e-12)


IDLE = chain_spec({"J": f"revolute z {WIDE}"}, "B eps J (eps J)? eps L eps E (eps J)?", "0.5, 0.3")


def test_words_of_one_normal_form_start_differently() -> None:
    """Without the start both are one robot: with it, one joint turns by 0.8 rad, one by 0.5."""
    assert starts(IDLE) == {
        "B J L E": "the start gives 2 coordinates, and the word has 1 degree of freedom",
        "B J J L E": [F(4, 5)],
        "B J L E J": [F(1, 2)],
        "B J J L E J": "the start gives 2 coordinates, and the word has 3 degrees of freedom",
    }
    _, task, models = robots(IDLE)
    keys = {word: robot_key(model) for word, model in models.items()}
    assert keys["B J L E"] == keys["B J L E J"]
    in_task = {word: robot_key_in_task(model, task) for word, model in models.items()}
    assert len(set(in_task.values())) == 4
    anywhere = ir.StartIn("T", None, F(0))
    for word, model in models.items():
        assert robot_key_in_task(model, replace(task, start=anywhere)) == keys[word]


def test_words_that_start_alike_are_one_robot() -> None:
    text = chain_spec({"J": f"revolute z {WIDE}", "K": f"revolute z {WIDE}"},
                      "B eps (J eps K | K eps J) eps L eps E", "0.5, 0.3")  # fmt: skip
    _, task, models = robots(text)
    assert len(models) == 2
    assert len({robot_key_in_task(model, task) for model in models.values()}) == 1


@pytest.mark.parametrize(
    "start", some(["0.5, 0.3", "110 deg, 0", "0.5, 0.3, 0.1", "0.5 rad, 1.8"], 2)
)
def test_only_candidates_have_choices_of_effectors(start: str) -> None:
    found, task, models = robots(IDLE.replace("0.5, 0.3", start))
    (question,) = pose_questions(found.workspaces["W"], task)
    for word, model in models.items():
        expected = 0 if isinstance(starts(IDLE.replace("0.5, 0.3", start))[word], str) else 1
        assert len(effector_choices(model, question)) == expected
