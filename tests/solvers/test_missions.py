"""Missions of arms on one joint: these reach the points at the sum of their lengths."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from types import ModuleType

import pytest

from compiler.missions.parameter_ranges import Range
from compiler.missions.robot_changes import built
from compiler.time_limits.time_limit import OutOfTimeError, time_limit
from grammar_lang import ir
from grammar_lang.load import load_text
from solvers.missions import compared_structures, one_robot, rebuilt_robots, without_robots
from solvers.missions.mission_result import Existing, MissionResult
from solvers.missions.mission_search import solve
from solvers.missions.motions_sought import Listener, MotionsSought
from solvers.missions.task_robots import TaskRobots
from solvers.run_context import RunContext
from solvers.search.path_task import Design
from solvers.search.search_state import StructureState

ARMS = """\
module Base {{ role base; const price = 1; }}
module J {{ role joint; dof q: revolute z; const price = 1; }}
module L {{ role link; param length in {L} m; const price = 1; }}
module K {{ role link; param length in {K} m; const price = 2; }}
module Hand {{ role effector; const price = 1; }}
edge eps;
grammar Arms {{
  start Arm;
  base: Arm -> Base; j: Arm -> Arm eps J;
  l: Arm -> Arm eps L; k: Arm -> Arm eps K; hand: Arm -> Arm eps Hand;
  accept matches Base eps J (eps (L | K))+ eps Hand;
}}
semantics Arms {{
  base {{ this.frame = world; }}
  j {{ this.frame = Arm.frame * rot(z, J.q); point(frame: Arm.frame, mass: 0.1 kg); }}
  l {{ this.frame = Arm.frame * move(x, L.length); point(frame: this.frame, mass: 0.1 kg); }}
  k {{ this.frame = Arm.frame * move(x, K.length); point(frame: this.frame, mass: 0.1 kg); }}
  hand {{ this.frame = Arm.frame; effector(frame: Arm.frame); }}
}}
workspace Hall {{
  plane xy; bounds box [-5, 5] x [-5, 5] m;
  {regions}
}}
{tasks}
mission M {{ tasks {names}; {clauses} }}
"""
TASK = """\
task {0} {{
  robot Arms; workspace Hall; start in Home{0} at rest; reach Shelf{0};
  effort <= 50 N*m; control open loop; horizon 10 steps of 0.3 s; modules <= {1}; {2}
}}"""


def arms(
    clauses: str, *radii: str, lengths: str, others: str = "{0.3, 0.9}", modules: int = 5,
    origin: str = "",
) -> str:  # fmt: skip
    """A mission of tasks at some distances, each from the right of the base to above it."""
    regions, tasks = list[str](), list[str]()
    for name, radius in zip("ABCD", radii, strict=False):
        low, high = Fraction(radius) - Fraction(3, 100), Fraction(radius) + Fraction(3, 100)
        side, around = f"[{float(low)}, {float(high)}]", "[-0.05, 0.05]"
        regions.append(f"region Home{name} box {side} x {around} m;")
        regions.append(f"region Shelf{name} box {around} x {side} m;")
        tasks.append(TASK.format(name, modules, origin if name == "A" else ""))
    return ARMS.format(
        L=lengths, K=others, regions=" ".join(regions), tasks="\n".join(tasks),
        names=", ".join("ABCD"[: len(radii)]), clauses=clauses,
    )  # fmt: skip


def solved(text: str, context: RunContext | None = None) -> MissionResult:
    program = load_text(text, "arms.srg", Path()).program
    assert program is not None
    return solve(program, program.missions["M"], context or RunContext())


def test_a_fixed_length_is_not_taken_for_another_one() -> None:
    """K is 0.78 m long by `from`; arms of about 0.79 m keep it only without L of 0.35 m."""
    text = arms(
        "reconfigure add 2, remove 1; changes <= 2; minimize changes;", "1.13", "0.79",
        lengths="{0.35, 0.9}", others="{0.45, 0.78}",
        origin="from Base eps J eps L eps K eps Hand fixed K.length = 0.78 m;",
    )  # fmt: skip
    result = solved(text)
    assert result.verdict == "found"
    assert (result.cost, result.least) == (1, 1)


def test_what_a_solver_refutes_is_covered_choice_by_choice() -> None:
    """One link L does not reach 0.72 m, which lies between its 0.4 m and 0.95 m."""
    text = arms(
        "reconfigure add 2, remove 1, change 0.3; free L.length; minimize changes;",
        "1.9", "0.72", lengths="{0.4, 0.95}", others="{0.3, 0.32}",
    )  # fmt: skip
    result = solved(text)
    assert result.verdict == "found"
    assert (result.cost, result.least) == (Fraction("3.3"), Fraction("3.3"))


def test_robots_are_refuted_choice_by_choice() -> None:
    """Arms of two links are 0.6, 0.9, 1.2, 1.5 or 1.8 m long: none is of 0.9 m and of 1.5 m."""
    text = arms("one robot;", "0.9", "1.5", lengths="{0.3, 0.6, 0.9}", others="{0.3, 0.9}")
    assert solved(text).verdict == "impossible"


@pytest.mark.parametrize("clauses", ["one robot;", "reconfigure; changes <= 0; minimize changes;"])
def test_no_common_choice(clauses: str) -> None:
    """Arms of 0.4 and 0.95 m, of which none has both lengths, by choices of two parameters."""
    text = arms(clauses, "1.0", "1.5", lengths="{0.4, 0.6}", others="{0.6, 0.9}", modules=5)
    assert solved(text).verdict == "impossible"


# --- what ended the search ------------------------------------------------------------------------

REBUILT = "reconfigure; changes <= 0; minimize changes;"


def test_the_limit_of_cuts_says_which_parameter_to_narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same arms, of which no choices agree: with one cut that is not shown."""
    monkeypatch.setattr(rebuilt_robots, "MOST_CUTS", 1)
    monkeypatch.setattr(without_robots, "MOST_CUTS", 1)
    result = solved(arms(REBUILT, "1.0", "1.5", lengths="{0.4, 0.6}", others="{0.6, 0.9}"))
    assert (result.verdict, result.ended and result.ended.by) == ("unknown", "cuts")
    assert result.ended is not None
    assert result.ended.try_first in {
        f"a narrower range of `{name}`" for name in ("K.length", "L.length")
    }
    assert "limit of 1 boxes" in (result.reason or "")


@pytest.mark.parametrize("clauses", ["one robot;", REBUILT])
def test_a_time_limit_is_said_where_time_ended_it(clauses: str) -> None:
    text = arms(clauses, "1.0", "1.5", lengths="{0.4, 0.6}", others="{0.6, 0.9}")
    result = solved(text, RunContext(out_of_time=lambda: True))
    assert (result.verdict, result.ended and result.ended.by) == ("unknown", "time")
    assert result.ended is not None
    assert "--time-limit" in result.ended.try_first


@pytest.mark.parametrize("clauses", ["one robot;", REBUILT])
def test_the_limit_of_robots_without_a_motion(
    clauses: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(one_robot, "MOTION_SEARCHES", 0)
    monkeypatch.setattr(rebuilt_robots, "MOTION_SEARCHES", 0)
    result = solved(arms(clauses, "1.0", "1.5", lengths="{0.4, 0.6}", others="{0.6, 0.9}"))
    assert result.ended is not None
    assert (result.verdict, result.ended.by) == ("unknown", "motions")
    assert "`accept`" in result.ended.try_first
    assert "time" not in result.ended.try_first


FIXED = {"lengths": "0.4", "others": "0.6", "modules": 12}
"""Arms of links of 0.4 and 0.6 m: of n links 2^n, up to 8 links 510 and up to 9 links 1,022."""


def fixed(text: str) -> str:
    """With lengths that are no parameters."""
    for length in ("0.4", "0.6"):
        text = text.replace(f"param length in {length} m", f"const length = {length} m")
    return text


def test_among_the_first_of_too_many_structures_robots_are_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """L K is 1 m long, and with one L more 1.4 m; that nothing costs less is not proved."""
    monkeypatch.setattr(compared_structures, "MOST_ROBOTS", 12)
    text = fixed(arms("reconfigure; minimize changes;", "1.0", "1.4", **FIXED))
    result = solved(text)
    assert (result.verdict, result.cost, result.least) == ("found", 1, 0)
    assert result.ended is None


def test_without_any_of_too_many_structures_it_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first 6 arms have at most two links, of 1.2 m in all."""
    monkeypatch.setattr(compared_structures, "MOST_ROBOTS", 6)
    result = solved(fixed(arms("reconfigure; minimize changes;", "1.0", "2.0", **FIXED)))
    assert result.ended is not None
    assert (result.verdict, result.least, result.ended.by) == ("unknown", None, "structures")
    assert result.ended.try_first.startswith("`modules <= 5` in all tasks, which leaves 6,")
    assert "of more than 6 structures of at most 12 modules 6 were compared" in str(result.reason)


def test_modules_that_leave_few_enough_structures() -> None:
    text = fixed(arms("reconfigure; minimize changes;", "1.0", "1.4", **FIXED))
    program = load_text(text, "arms.srg", Path()).program
    assert program is not None
    tasks = [TaskRobots(program, task, RunContext()) for task in program.tasks.values()]
    compared = compared_structures.compared_structures(tasks, ir.Prices(), None)
    assert compared.left_out is not None
    assert (len(compared.structures), compared.modules) == (1000, 12)
    first = compared.left_out.ended.try_first
    assert first.startswith("`modules <= 11` in all tasks, which leaves 510,")


def test_of_too_many_structures_those_near_the_robot_there_is_are_compared(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """K K K is 1.8 m long, and one K exchanged for L leaves 1.6 m; the first 12 arms end before."""
    monkeypatch.setattr(compared_structures, "MOST_ROBOTS", 12)
    word = "Base eps J eps K eps K eps K eps Hand"
    text = arms("reconfigure; minimize changes;", "1.8", "1.6", origin=f"from {word};", **FIXED)
    result = solved(fixed(text))
    assert (result.verdict, result.cost, result.least) == ("found", 2, 0)
    assert result.designs[0].derivation.word == tuple(word.split())


def test_the_values_of_an_existing_robot_are_tried_first() -> None:
    """Its length of 1.13 m does the task, so no other length is searched for."""
    text = arms("reconfigure add 1, remove 1; minimize changes;", "1.13", lengths="[0.3, 1.5]")
    program = load_text(text, "arms.srg", Path()).program
    assert program is not None
    word, length = ("Base", "eps", "J", "eps", "L", "eps", "Hand"), Fraction(113, 100)
    values = {(word.index("L"), "length"): (Range(length, length),)}
    existing = Existing(word, built(word, program.modules, values))
    result = solve(program, program.missions["M"], RunContext(), existing)
    assert (result.verdict, result.cost, result.counts["motion searches"]) == ("found", 0, 1)
    assert [value.stated for value in result.designs[0].parameters] == [length]


def test_a_design_proved_within_the_time_is_kept() -> None:
    """The time ends while the motion of the first proof is being improved."""
    design = solved(arms("one robot;", "0.9", lengths="{0.9}")).designs[0]

    def sought(*designs: Design) -> MotionsSought:
        def states() -> Iterator[StructureState]:
            for each in designs:
                listener.keep(each)
            raise OutOfTimeError
            yield StructureState()

        listener = Listener()
        return MotionsSought(states(), listener, lambda found: found[-1])

    late = sought(design)
    assert late.first() is design
    assert late.best() is design
    with pytest.raises(OutOfTimeError):
        sought().first()


@pytest.mark.parametrize(
    ("clauses", "search"),
    [
        ("one robot;", one_robot),
        ("one robot; minimize modules;", one_robot),
        ("reconfigure add 2, remove 1; minimize changes;", rebuilt_robots),
    ],
    ids=["one-robot", "fewest-modules", "rebuilt"],
)
def test_designs_proved_at_once_outlive_the_time(
    monkeypatch: pytest.MonkeyPatch, clauses: str, search: ModuleType
) -> None:
    """The time is up as soon as there is a design for every task, before any is improved."""
    late = False
    original = search.proved_at_once

    def proved(*asked: object) -> tuple[Design, ...] | None:
        nonlocal late
        found = original(*asked)
        late = True
        return found

    monkeypatch.setattr(search, "proved_at_once", proved)
    text = arms(clauses, "0.9", "0.92", lengths="[0.3, 1.5]")
    with time_limit(lambda: late):
        result = solved(text, RunContext(out_of_time=lambda: late))
    assert late
    assert (result.verdict, result.unfinished, len(result.designs)) == ("found", True, 2)
    first, second = ([value.stated for value in each.parameters] for each in result.designs)
    assert first == second
    assert Fraction(87, 100) <= first[0] <= Fraction(95, 100)


@pytest.mark.parametrize("search", [one_robot, rebuilt_robots], ids=["one-robot", "rebuilt"])
def test_without_a_limit_nothing_is_proved_at_once(
    monkeypatch: pytest.MonkeyPatch, search: ModuleType
) -> None:
    def proved(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(search, "proved_at_once", proved)
    clauses = "one robot;" if search is one_robot else "reconfigure add 2, remove 1;"
    assert solved(arms(clauses, "0.9", "0.9", lengths="{0.9}")).verdict == "found"
