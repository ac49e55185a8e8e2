"""``srgc plan``: formulas, several effectors, dumps, and why there is no path."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest
import z3
from pysmt.shortcuts import Solver
from pysmt.smtlib.parser import SmtLibParser

from tests.oracles.formulas import TWO_ARMS
from tests.oracles.formulas import spec as written
from tests.srgc.conftest import ROOT, Ran

Srgc = Callable[..., Ran]
Spec = Callable[[str], Path]

REGIONS = """region S box [-1, 0] x [-1, 0] m; region A box [1, 2] x [0, 1] m;
region C box [3, 4] x [3, 4] m;"""
WALL = "obstacle O box [2, 2.5] x [-1, 4] m;"
LINE = re.compile(r"([\w.]+)\tat sample (\d+) \(([\d.]+) s\)")


def lines(text: str) -> list[tuple[str, int, float]]:
    found = [LINE.fullmatch(line) for line in text.splitlines()]
    return [(m[1], int(m[2]), float(m[3])) for m in found if m is not None]


def test_samples_where_the_task_cares_when(srgc: Srgc) -> None:
    """Patrol: A within 3 s, then B, never C, in B throughout the last second of 8; 8 samples/s."""
    ran = srgc("plan", ROOT / "specs" / "patrol.srg")
    assert (ran.status, ran.err) == (0, "")
    path = lines(ran.out)
    assert len(path) == len(ran.out.splitlines())
    names = [name for name, _, _ in path]
    assert (names[0], path[0][1]) == ("Home", 0)
    assert all(sample / 8 == seconds for _, sample, seconds in path)
    assert [sample for _, sample, _ in path] == sorted({sample for _, sample, _ in path})
    assert min(seconds for name, _, seconds in path if name == "A") <= 3
    assert names[-1] == "B"
    assert path[-1][2] <= 7
    assert names.index("A") < names.index("B")
    assert not any(name.startswith("C") for name in names)


def test_without_times_a_cell_may_come_back(srgc: Srgc, spec: Spec) -> None:
    """From a dead end, to the far region and back into it."""
    text = written(
        "start in S; satisfy eventually A; satisfy last[0 s] S;", REGIONS, horizon="20 steps of 1 s"
    )
    ran = srgc("plan", spec(text))
    names = ran.out.split()
    assert ran.status == 0
    assert (names[0], names[-1]) == ("S", "S")
    assert "A" in names


def test_a_heading_per_effector(srgc: Srgc, spec: Spec) -> None:
    text = written(
        "start in S by effector 1; satisfy eventually C by effector 2; "
        "satisfy eventually A by effector 1;",
        REGIONS,
        horizon="12 steps of 0.5 s",
        arms=TWO_ARMS,
    )
    ran = srgc("plan", spec(text))
    assert ran.status == 0
    first, second = re.fullmatch(
        r"effector 1:\n(.*)\neffector 2:\n(.*)\n", ran.out, re.DOTALL
    ).groups()  # type: ignore[union-attr]
    assert lines(first)[0][:2] == ("S", 0)
    assert "A" in [name for name, _, _ in lines(first)]
    assert "C" in [name for name, _, _ in lines(second)]


@pytest.mark.parametrize(
    ("clauses", "regions", "why"),
    [
        ("start in S; reach C; avoid O with effector;", REGIONS + WALL, "neighbouring cells"),
        ("start in S; reach C; satisfy always not O;", REGIONS + WALL, "formula"),
        ("start in S; reach C;", REGIONS, "than the 2 samples allow"),
        ("start in S; satisfy eventually C;", REGIONS, "formula"),
    ],
)
def test_why_there_is_no_path(srgc: Srgc, spec: Spec, clauses: str, regions: str, why: str) -> None:
    steps = "1 steps of 1 s" if regions != REGIONS + WALL else "40 steps of 1 s"
    path = spec(written(clauses, regions, horizon=steps))
    ran = srgc("plan", path)
    assert ran.status == 3
    assert ran.out.startswith("no path: ")
    assert why in ran.out
    assert not satisfiable(srgc("plan", path, "--dump", "smt2").out)


def satisfiable(script: str) -> bool:
    parsed = SmtLibParser().get_script(io.StringIO(script))
    with Solver(name="z3", logic="QF_UF") as solver:
        (answer,) = [value for name, value in parsed.evaluate(solver) if name == "check-sat"]
    return bool(answer)


def test_the_problem_for_other_solvers(srgc: Srgc, arm_file: Path) -> None:
    script = srgc("plan", arm_file, "--dump", "smt2")
    assert (script.status, script.err) == (0, "")
    assert satisfiable(script.out)
    cnf = srgc("plan", arm_file, "--dump", "dimacs")
    assert cnf.status == 0
    assert re.search(r"^c \d+ effector 1 in S at position 0$", cnf.out, re.MULTILINE)
    (count,) = re.findall(r"^p cnf \d+ (\d+)$", cnf.out, re.MULTILINE)
    rows = [line for line in cnf.out.splitlines() if not line.startswith(("c", "p"))]
    assert len(rows) == int(count)
    assert all(row.endswith(" 0") for row in rows)
    assert srgc("plan", arm_file, "--dump", "text").status == 2


def test_more_cells(srgc: Srgc, arm_file: Path) -> None:
    few, many = (srgc("plan", arm_file, *more).out.split() for more in ((), ("--cells", 60)))
    assert (few[0], few[-1]) == ("S", "T")
    assert many[0].startswith("S")
    assert many[-1].startswith("T")
    assert len(many) > len(few)


# --- pictures -----------------------------------------------------------------------------------


def test_a_plan_is_drawn(srgc: Srgc, spec: Spec, tmp_path: Path) -> None:
    path = spec(written("start in S; satisfy eventually A;", REGIONS))
    picture = tmp_path / "plan.svg"
    plain = srgc("plan", path)
    ran = srgc("plan", path, "-o", picture)
    assert (ran.status, ran.out, ran.err) == (0, plain.out, "")
    assert ElementTree.parse(picture).getroot().tag.endswith("svg")
    again = tmp_path / "again.svg"
    srgc("plan", path, "-o", again)
    assert again.read_bytes() == picture.read_bytes()


def test_cells_are_drawn_where_there_is_no_plan(srgc: Srgc, spec: Spec, tmp_path: Path) -> None:
    text = written("start in S; satisfy eventually C; avoid O with effector;", REGIONS + WALL)
    ran = srgc("plan", spec(text), "-o", tmp_path / "plan.svg")
    assert ran.status == 3
    assert (tmp_path / "plan.svg").exists()


def test_a_dump_goes_to_a_file(srgc: Srgc, spec: Spec, tmp_path: Path) -> None:
    path = spec(written("start in S; satisfy eventually A;", REGIONS))
    printed = srgc("plan", path, "--dump", "smt2").out
    ran = srgc("plan", path, "--dump", "smt2", "-o", tmp_path / "plan.smt2")
    assert (ran.status, ran.out) == (0, "")
    assert (tmp_path / "plan.smt2").read_text(encoding="utf-8") == printed


@pytest.mark.parametrize(("goal", "answer"), [("A", z3.sat), ("C", z3.unsat)])
def test_z3_reads_a_dump_from_its_file(
    srgc: Srgc, spec: Spec, tmp_path: Path, goal: str, answer: z3.CheckSatResult
) -> None:
    """By its own reader: what pysmt reads, as the other tests do, z3 need not take."""
    file = tmp_path / "plan.smt2"
    clauses = f"start in S; satisfy eventually {goal}; satisfy always not O;"
    path = spec(written(clauses, REGIONS + WALL, horizon="40 steps of 1 s"))
    srgc("plan", path, "--dump", "smt2", "-o", file)
    solver = z3.Solver()
    solver.from_file(str(file))
    assert len(solver.assertions()) == file.read_text(encoding="utf-8").count("\n(assert ")
    assert solver.check() == answer


@pytest.mark.parametrize("name", ["plan.png", "missing/plan.svg"])
def test_what_cannot_be_drawn_or_written(srgc: Srgc, spec: Spec, tmp_path: Path, name: str) -> None:
    path = spec(written("start in S; satisfy eventually A;", REGIONS))
    ran = srgc("plan", path, "-o", tmp_path / name)
    assert ran.status == 2
    assert ran.err.startswith("error: ")
    assert not (tmp_path / name).exists()


LIMBS = """
module Base { role base; }
module Limb { role link; dof q: revolute z in [-170, 170] deg; param length in [0.4, 0.9] m; }
module Hand { role effector; }
grammar Arm { start R; hand: R -> Ls Hand; limb: Ls -> Ls Limb; base: Ls -> Base; }
semantics Arm {
  base { this.tip = world; }
  hand { effector(frame: Ls.tip); }
  limb { this.tip = Ls.tip * rot(z, Limb.q) * move(x, Limb.length);
         rod(frame: this.tip, axis: -x, length: Limb.length, density: 1 kg/m); }
}
workspace Place {
  plane xy;
  bounds box [-2, 2] x [-2, 2] m;
  region Home box [0.9, 1.1] x [-0.6, -0.4] m;
  target Goal box [0.9, 1.1] x [0.5, 0.7] m;
  region Mud box [0.6, 1.5] x [-0.1, 0.1] m;
}
task T {
  robot Arm; workspace Place; start in Home at rest; reach Goal; avoid Mud with body;
  effort <= 20 N*m; horizon 40 steps of 0.1 s;
}
"""


@pytest.mark.parametrize(
    ("old", "new", "through"),
    [
        ("", "", False),
        ("avoid Mud with body;", "", True),
        # The hand is not on a body.
        ("effector(frame: Ls.tip);", "effector(frame: Ls.tip * move(y, 0.3 m));", True),
        # There is no other way.
        ("Mud box [0.6, 1.5]", "Mud box [-2, 2]", True),
    ],
)
def test_effectors_on_bodies_keep_out_of_what_bodies_avoid(
    srgc: Srgc, tmp_path: Path, old: str, new: str, through: bool
) -> None:
    spec = tmp_path / "limbs.srg"
    spec.write_text(LIMBS.replace(old, new) if old else LIMBS, encoding="utf-8")
    ran = srgc("plan", spec)
    assert (ran.status, ran.err) == (0, "")
    assert any(line.startswith("Mud") for line in ran.out.splitlines()) is through


def test_motions_that_end_at_several_times(srgc: Srgc, spec: Spec) -> None:
    """Back in S from 3 s on is no demand on a motion of two seconds; A is out of reach by then."""
    clauses = "start in S; satisfy eventually A; satisfy always[3 s, 4 s] C;"
    for horizon, steps in [("4 steps of 1 s", None), ("at most 4 steps of 1 s", "2 steps:")]:
        ran = srgc("plan", spec(written(clauses, REGIONS, horizon=horizon)))
        if steps is None:
            assert (ran.status, ran.out.splitlines()[0]) == (
                3, "no path: no path within the 5 samples satisfies the formula"
            )  # fmt: skip
            continue
        first, *rest = ran.out.splitlines()
        assert (ran.status, first) == (0, steps)
        assert lines("\n".join(rest))[-1][1] <= 2


def test_a_number_of_steps_that_is_no_part_of_the_horizon(srgc: Srgc, spec: Spec) -> None:
    """In A at the end after 2 s, and from 4 s on in S: of 8 steps at most, only 3 will do."""
    clauses = "start in S; satisfy last[0 s] A; satisfy always[4 s, 9 s] S; "
    clauses += "satisfy always[0 s, 2 s] not A;"
    ran = srgc("plan", spec(written(clauses, REGIONS, horizon="at most 8 steps of 1 s")))
    assert (ran.status, ran.out.splitlines()[0]) == (0, "3 steps:")


def test_that_some_ends_have_no_plan_refutes_nothing(srgc: Srgc, spec: Spec) -> None:
    clauses = "start in S; satisfy eventually[0 s, 1 s] A and always[0 s, 2 s] not A;"
    ran = srgc("plan", spec(written(clauses, REGIONS, horizon="at most 8 steps of 1 s")))
    assert ran.status == 4
    assert "no path satisfies the formula, of any number of steps that was looked at" in ran.out
    dumped = srgc("plan", spec(written(clauses, REGIONS, horizon="at most 8 steps of 1 s")),
                  "--dump", "smt2")  # fmt: skip
    assert dumped.status == 2
    assert "no single problem" in dumped.err


def test_without_formulas_the_longest_motion_has_all_plans(srgc: Srgc, spec: Spec) -> None:
    plain = written("start in S; reach A;", REGIONS, horizon="8 steps of 1 s")
    most = written("start in S; reach A;", REGIONS, horizon="at most 8 steps of 1 s")
    assert srgc("plan", spec(plain)).out == srgc("plan", spec(most)).out
    few = written("start in S; reach C;", REGIONS, horizon="at most 1 steps of 1 s")
    ran = srgc("plan", spec(few))
    assert (ran.status, ran.out) == (
        3, "no path: every path has more changes of cell than the 2 samples allow\n"
    )  # fmt: skip
    dumps = [srgc("plan", spec(text), "--dump", "smt2").out for text in (plain, most)]
    assert dumps[0] == dumps[1]
