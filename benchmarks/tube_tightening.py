"""Motion and gains in turn, as the search chooses them, against both optimised for the tube.

Every task has disturbances and feedback. Its search runs once as it is. From the motion with which
its constraints are tightened for the first time, the tightening is then repeated with each method,
proofs included:

- `in turn`: the motion with room for the spread of the last one, then the gains (decision 69);
- `settled`: the same, where a motion is found twice more with the spread of the last one before it
  is proved: what the methods below would gain by that alone;
- `motion`: the motion optimised for the tube, which costs three tenths of the effort bound as long
  as it is as wide as at first, gains as before;
- `dearer`: the same at ten times that price;
- `gains`: in turn, the gains refined for the tube by a quasi-Newton method;
- `both`: motion and gains optimised for the tube.

Rows are kept in the folder of ``-o`` and not measured again: a run goes on where the last one
ended.

    python benchmarks/tube_tightening.py
    python benchmarks/tube_tightening.py --cases prismatic --methods "in turn" both
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from timing import ROOT, machine

sys.path.insert(0, str(ROOT))

from flint import arb_mat
from tube_optimisation import Method, TubeProblem, tube_problem

from compiler.arrays import Array
from grammar_lang.load import load_text
from solvers.run_context import RunContext
from solvers.search import motion_proof
from solvers.search.certified_design import certified_design
from solvers.search.configuration_search import Configuration
from solvers.search.motion_proof import MotionProof, ProofAttempt
from solvers.search.path_task import Design
from solvers.search.search_state import Blocked, Found
from solvers.search.synthesis import synthesise
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.task_limits import input_groups
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.proofs import tube_proof
from solvers.verifier.proofs.enclosure import TubeSegment, tube
from solvers.verifier.proofs.tube_checks import Status
from srgc.session import check_loaded
from tests.oracles.small_specs import replaced

METHODS = {
    "in turn": Method(),
    "settled": Method(settled=True),
    "motion": Method(price=0.3),
    "dearer": Method(price=3.0),
    "gains": Method(refined=True),
    "both": Method(price=0.3, refined=True),
}


@dataclass(frozen=True)
class Case:
    """A specification with disturbances, and what they are, for people.

    Methods that are ``left_out`` take minutes there, and are done only where they are asked for.
    """

    name: str
    text: str
    says: str
    left_out: tuple[str, ...] = ()


def cases() -> tuple[Case, ...]:
    """The tasks: two to three coordinates, two with gravity, one with a current of its own."""
    few = "start 1 deg, 1 deg/s; effort 1 % of bound"
    more = "start 2 deg, 2 deg/s; effort 5 % of bound; mass 5 %"
    half = "start 0.5 deg, 0.5 deg/s; effort 1 % of bound"
    arm, slide, motor = shipped("planar_arm"), shipped("prismatic"), shipped("motor_arm")
    slide = replaced(slide, "reach Shelf at rest;", "reach Shelf rates <= 0.2 rad/s;")
    motor = replaced(motor, "reach Bin at rest;", "reach Bin rates <= 0.5 rad/s;")
    lines = shipped("robust_arm").splitlines(keepends=True)
    calm = "".join(line for line in lines if not line.strip().startswith("robust "))
    upright = "  effort <= 10 N*m;\n  gravity (0, -3) m/s^2;\n"
    hanging = replaced(calm, "  effort <= 10 N*m;\n", upright)
    return (
        Case("robust_arm-hanging", disturbed(hanging, half), half),
        Case("prismatic", disturbed(slide, half), half),
        Case("motor_arm", disturbed(motor, half), half),
        Case("planar_arm-2", disturbed(arm, more), more, ("both",)),
        Case("planar_arm-1", disturbed(arm, few), few, ("both",)),
    )


def chosen(options: argparse.Namespace) -> list[Case]:
    """Those of the options."""
    if options.specs:
        return [
            Case(path.stem, path.read_text(encoding="utf-8"), str(path)) for path in options.specs
        ]
    return [case for case in cases() if not options.cases or case.name in options.cases]


def shipped(name: str) -> str:
    """The text of a specification that comes with srgc."""
    return (ROOT / "specs" / f"{name}.srg").read_text(encoding="utf-8")


def disturbed(text: str, what: str) -> str:
    """The specification, whose task is its last block, with feedback and disturbances."""
    end = text.rindex("}")
    clauses = "".join(f"  robust {each};\n" for each in what.split("; "))
    return f"{text[:end]}  control feedback;\n{clauses}{text[end:]}"


# --- One run --------------------------------------------------------------------------------------


@dataclass(slots=True)
class Proofs:
    """The proofs that were tried: how many, their seconds, and the tube of the last one."""

    tried: int = 0
    seconds: float = 0.0
    segments: list[TubeSegment] = field(default_factory=list[TubeSegment])

    def proved(self, *arguments: Any, **options: bool) -> Any:
        """Try a proof."""
        self.tried += 1
        begun = time.process_time()
        try:
            return certified_design(*arguments, **options)
        finally:
            self.seconds += time.process_time() - begun

    def enclosed(self, *arguments: Any, **options: bool) -> Iterator[TubeSegment]:
        """Enclose, and keep the tube: that of all disturbed motions is the last."""
        self.segments = []
        for segment in tube(*arguments, **options):
            self.segments.append(segment)
            yield segment


@dataclass(frozen=True)
class Tightening:
    """Where the search of a task begins to tighten its constraints."""

    search: MotionProof
    path_problem: PathProblem
    found: Configuration


@dataclass(frozen=True)
class Row:
    """What a method has come to.

    Attributes:
        spreads: the number of spreads that constraints are narrowed by in the end.
        estimated: the mean over time of the widest half-width of a point's position, in m.
        enclosed: the same of the proof's tube; NaN where that does not get to the end.
        widest: the largest of the latter.
        robustness: of the planned motion, in the inputs' units, as parts of the bound.
        left: the least part of an effort bound that is proved to be left in the tube; NaN: none.
        proofs: how many were tried.
        seconds: of processor time, proofs included; ``proving``: of these.
        estimates: the tubes that were estimated for gradients.
        why: why there is no proof.
    """

    spreads: float
    estimated: float
    enclosed: float
    widest: float
    robustness: float
    left: float
    proofs: int
    seconds: float
    proving: float
    estimates: int
    why: str


def begun(case: Case) -> Tightening:
    """The search of a case, up to where it tightens its constraints for the motion it ends with."""
    program = check_loaded(load_text(case.text, f"{case.name}.srg")).program
    if program is None:
        raise SystemExit(f"{case.name}: the specification has errors")
    (task,) = program.tasks.values()
    known: list[Tightening] = []

    def kept(
        search: MotionProof,
        path_problem: PathProblem,
        found: Configuration,
        *more: Any,
        **options: Any,
    ) -> ProofAttempt:
        # Early proofs are of a first motion, and tried with fewer margins.
        if not more:
            known.append(Tightening(search, path_problem, found))
        return WITH_MARGINS(search, path_problem, found, *more, **options)

    with mock.patch.object(MotionProof, "with_margins", kept):
        verdict = synthesise(program, task, RunContext()).verdict
    if not known:
        raise SystemExit(f"{case.name}: {verdict}, and no motion was found")
    return known[-1]


WITH_MARGINS = MotionProof.with_margins


def tightened(start: Tightening, method: Method) -> Row:
    """The rest of the search with one method."""
    problem = tube_problem(start.path_problem, method)
    proofs, last = Proofs(), list[tuple[TubeProblem, Trajectory]]()

    def proved(*arguments: Any, **options: bool) -> Any:
        last.append((arguments[3], arguments[4].outcome.trajectory))
        return proofs.proved(*arguments, **options)

    begin = time.process_time()
    with (
        mock.patch.object(motion_proof, "certified_design", proved),
        mock.patch.object(tube_proof, "tube", proofs.enclosed),
    ):
        attempt = start.search.with_margins(problem, start.found)
    seconds = time.process_time() - begin
    nan = float("nan")
    why = attempt.answer.text if isinstance(attempt.answer, Blocked) else ""
    if not last:
        return Row(nan, nan, nan, nan, nan, nan, 0, seconds, 0.0, problem.record.estimates, why)
    asked, motion = last[-1]
    spread = asked.controlled(motion)[1]
    mean = nan if spread is None else float(np.max(spread.points[1:], axis=1).mean())
    widths = tube_widths(asked, motion, proofs.segments)
    complete = len(widths) == len(motion.u)
    return Row(
        asked.factor,
        mean,
        float(widths.mean()) if complete else nan,
        float(widths.max()) if complete else nan,
        attempt.robustness / widest_bound(asked),
        effort_left(asked, attempt.answer.design) if isinstance(attempt.answer, Found) else nan,
        proofs.tried,
        seconds,
        proofs.seconds,
        problem.record.estimates,
        why,
    )


def widest_bound(path_problem: PathProblem) -> float:
    """The bound of the inputs that the robustness is compared with."""
    groups = input_groups(path_problem.model, path_problem.task)
    return max(group.widest_margin for group in groups)


def tube_widths(
    path_problem: PathProblem, motion: Trajectory, segments: list[TubeSegment]
) -> Array:
    """The half-widths in m of the widest point's position, to first order, at the ends of steps."""
    numeric = path_problem.numeric
    sets = [each.last for each in segments if each.steps[1].denominator == 1]
    n, rows = numeric.n, np.array(numeric.graph.coordinates.rows, float)
    by_q = numeric.points(motion.x[:, :n], motion.theta).by_q
    found = list[float]()
    for sample, states in enumerate(sets, start=1):
        if states is None or sample >= len(by_q):
            break
        turned = (by_q[sample] @ rows).reshape(-1, n)
        padded = np.pad(turned, ((0, 0), (0, len(states.middle) - n)))
        radii = [float(each.upper()) for each in states.radii_under(arb_mat(padded.tolist()))]
        places = np.array(radii).reshape(by_q.shape[1:3])
        found.append(float(np.max(np.linalg.norm(places, axis=1))))
    return np.array(found)


def effort_left(path_problem: PathProblem, design: Design) -> float:
    """The least part of a bound that no input of the tube uses, as the proof has it."""
    groups = [g for g in input_groups(path_problem.model, path_problem.task) if g.effort]
    kinds = [each for each in design.conditions if each.name.startswith("effort")]
    found = [
        each.margin / group.widest_margin
        for each, group in zip(kinds, groups, strict=False)
        if each.status is Status.HOLDS
    ]
    return min(found, default=float("nan"))


# --- The table ------------------------------------------------------------------------------------

HEAD = (
    f"{'task':<20}{'method':<9}{'proved':>7}{'spreads':>9}{'estimated':>11}{'enclosed':>10}"
    f"{'widest':>9}{'robust':>8}{'left':>8}{'proofs':>8}{'cpu s':>8}{'proving':>9}{'tubes':>8}"
)


def line(case: Case, method: str, row: Row) -> str:
    """A row in a line of the table; lengths are in cm."""
    sizes = "".join(
        f"{100 * value:>{room}.2f}"
        for value, room in ((row.estimated, 11), (row.enclosed, 10), (row.widest, 9))
    )
    parts = f"{row.robustness:>8.1%}{row.left:>8.1%}"
    times = f"{row.proofs:>8}{row.seconds:>8.1f}{row.proving:>9.1f}{row.estimates:>8}"
    proved = "no" if row.why else "yes"
    return f"{case.name:<20}{method:<9}{proved:>7}{row.spreads:>9.2f}{sizes}{parts}{times}"


def lines(case: Case, methods: Sequence[str], folder: Path) -> Iterator[str]:
    """The lines of a case; those that a folder keeps are not measured again."""
    start: Tightening | None = None
    folder.mkdir(parents=True, exist_ok=True)
    for method in methods:
        digest = hashlib.sha256(case.text.encode()).hexdigest()
        asked = {"specification_sha256": digest, "method": str(METHODS[method])}
        file = folder / f"{case.name}-{method.replace(' ', '-')}.json"
        known = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        if known.get("asked") != asked:
            start = start or begun(case)
            row = tightened(start, METHODS[method])
            known = {"asked": asked, "line": line(case, method, row), "why": row.why.lstrip("; ")}
            file.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
        yield known["line"]
        if known["why"]:
            yield f"  {known['why']}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", nargs="*", help="names; default all")
    parser.add_argument("--specs", nargs="*", type=Path, help="files, instead of the cases")
    parser.add_argument("--methods", nargs="*", choices=METHODS, help="of the above")
    parser.add_argument("-o", type=Path, default=ROOT / "out" / "tube", help="the folder")
    options = parser.parse_args()
    print(f"{machine()}\n\n{HEAD}", flush=True)
    asked = chosen(options)
    for case in asked:
        usual = [each for each in METHODS if each not in case.left_out]
        for each in lines(case, options.methods or usual, options.o):
            print(each, flush=True)
    print("\nlengths in cm, robustness and what the proof leaves as parts of the bounds")
    for case in asked:
        print(f"{case.name}: {case.says}")


if __name__ == "__main__":
    main()
