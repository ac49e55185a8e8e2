"""``srgc model``: the equations of motion of one robot of a family, for people and for solvers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from compiler.descriptions.document import Fact, Section, section_of_lines, to_latex, to_text
from compiler.descriptions.model_formulas import model_formulas, motion_sections, robot_sections
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.body_smt import model_script
from compiler.expressions.tape import UndefinedValueError
from compiler.mass_matrix.mass_matrix_check import mass_matrix_check
from compiler.neutral_modules.neutral_parameters import neutral_parameters
from compiler.robots.defined_scalars import scalars_are_defined
from compiler.robots.robot import RodBody, SolidBody
from grammar_lang import ir
from srgc.chosen_robot import ChosenRobot, RobotRequest, chosen_robot
from srgc.session import UsageFault

MOST_WRITTEN = 8
"""With more degrees of freedom, the equations are thousands of lines long."""
BOXES = 512
"""The number of boxes that the check of M may examine, which takes a second or two."""

Form: TypeAlias = Literal["text", "latex", "smt2"]


@dataclass(frozen=True, slots=True)
class ModelReport:
    """The report, and remarks for the reader."""

    text: str
    remarks: tuple[str, ...]


def model_report(
    program: ir.Program, request: RobotRequest, form: Form = "text", *, whole: bool = False
) -> ModelReport:
    """The text of ``srgc model``; ``whole``: with the equations even of many degrees of freedom.

    Raises:
        UsageFault: the choices do not fit the program, or the word has no robot.
    """
    robot = chosen_robot(program, request)
    return ModelReport(model_text(robot, form, whole=whole), robot.remarks)


def model_text(robot: ChosenRobot, form: Form, *, whole: bool = False) -> str:
    """The report on a robot.

    Raises:
        UsageFault: its equations have no value anywhere.
    """
    try:
        if form == "smt2":
            return model_script(robot_graph(robot.model))
        sections = list(_sections(robot, whole=whole))
    except UndefinedValueError as error:
        raise UsageFault(str(error)) from None
    return to_latex(sections) if form == "latex" else to_text(sections)


def _sections(robot: ChosenRobot, *, whole: bool) -> Iterator[Section]:
    yield Section("Robot", tuple(_facts(robot)))
    yield from robot_sections(robot.model, robot.word, robot.task)
    if len(robot.model.dofs) <= MOST_WRITTEN or whole:
        yield from motion_sections(model_formulas(robot.model, robot.gravity))
    else:
        text = f"left out for {len(robot.model.dofs)} degrees of freedom: --whole writes them"
        yield section_of_lines("Equations of motion", [text])
    for title, lines in _checks(robot):
        yield section_of_lines(title, lines)


def _checks(robot: ChosenRobot) -> Iterator[tuple[str, list[str]]]:
    """Titles and lines of what is proved about the robot, for the last sections of the report."""
    if robot.model.dofs:
        text = (
            "undecided: a quotient or a root of parameters is not shown to have a value everywhere"
        )
        if scalars_are_defined(robot.model):
            text = mass_matrix_check(robot.model, budget=BOXES).text
        yield "M over the whole joint and parameter box", [text]
    used = set(robot.labels)
    neutral = neutral_parameters(robot.program, robot.grammar)
    lines = [item.text for item in neutral if item.production in used]
    yield "Hypothesis of Theorem 1: a value at which a module changes nothing", lines


def _facts(robot: ChosenRobot) -> Iterator[Fact]:
    model = robot.model
    yield Fact("word", f"{' '.join(robot.word)} (its symbols are counted from 0)")
    yield Fact("derivation", " ".join(robot.labels))
    yield Fact("moves in", "the plane" if model.dimension == 2 else "space")
    yield Fact("degrees of freedom", str(len(model.dofs)))
    rods = sum(isinstance(body, RodBody) for body in model.bodies)
    solids = sum(isinstance(body, SolidBody) for body in model.bodies)
    points = len(model.bodies) - rods - solids
    yield Fact("bodies", _listed({"rod": rods, "point": points, "solid": solids}) or "none")
    yield Fact("body points", str(2 * rods + points + solids))
    if model.shapes:
        yield Fact("shapes", _listed(Counter(shape.kind for shape in model.shapes)))
    yield Fact("gravity", _gravity(robot))


def _listed(counts: Mapping[str, int]) -> str:
    """A list such as ``2 rods, 1 sphere``; the plural of box is boxes."""
    plurals = {name: f"{name}{'es' if name.endswith('x') else 's'}" for name in counts}
    return ", ".join(f"{n} {name if n == 1 else plurals[name]}" for name, n in counts.items() if n)


def _gravity(robot: ChosenRobot) -> str:
    if robot.task is None:
        return "none, since no task is chosen"
    if not any(robot.gravity):
        return f"none in task {robot.task.name}"
    return f"that of task {robot.task.name}"
