"""Algorithm 1: structures, paths, parameters and controls, until a verdict can be proved.

    S.Synthesis -> P.Planning -> P.Synthesis -> certificate, with counterexamples passed back.

``found`` is claimed only for a motion that the verifier's own proof accepts; ``impossible`` only if
every structure up to an explicit bound is refuted: by a script that a solver answered ``unsat``,
by a covering that the verifier's own replay accepts, or by both.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from compiler.robots.normal_form import family_of
from compiler.tasks.obstacle_pieces import expanded
from compiler.time_limits.time_limit import OutOfTimeError, check_time
from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.bisection import bisections
from grammar_lang import ir
from solvers.conclusion import StructureRecord, conclude
from solvers.impossibility.box_evidence import covered
from solvers.impossibility.disconnection import disconnected, separation_text
from solvers.lemma import Lemma
from solvers.run_context import RunContext
from solvers.search.configuration_search import PathSamples
from solvers.search.design_values import limits_of
from solvers.search.family_search import NO_COUNTS, FamilySearch, Proved
from solvers.search.least_search import LeastSearch
from solvers.search.narrowed_family import NoBoundError, Tried
from solvers.search.objective_result import Optimality
from solvers.search.optimality import optimality, stated
from solvers.search.path_task import Design
from solvers.search.robustness_bound import RobustnessBound
from solvers.search.search_queue import StructureUnderWay
from solvers.search.search_state import CounterExampleRecord, NearestMotion
from solvers.search.time_bound import time_bound
from solvers.verdict import Verdict
from solvers.verifier.claims.certificate import SeparationClaim

OUT_OF_TIME = "the time limit was reached"
BEGUN = "srgc was started and the spec was read"
NOT_COVERED = f"{OUT_OF_TIME} before every refutation had a second proof"
PUT_OFF = "another structure was proved"


@dataclass(frozen=True, slots=True)
class Synthesis:
    """The verdict with everything that was tried.

    ``abstraction`` contains the cells of the design, or else the unrefined cells.  A ``separation``
    proves the task impossible before anything is tried.  ``design`` is the first of ``designs``;
    there are several only if all were asked for, and then ``ended`` says why not all structures
    were tried.  For an unknown task, ``nearest`` is the motion that came nearest to a design.
    ``unfinished`` says that the time limit was reached and another run can continue; ``last_step``
    then names the step that took so long, if it could not be interrupted.  ``lemmas`` also cover
    structures that were not tried.  ``bound`` is on the robustness of all designs, if one was asked
    for and proved; ``unbounded`` says why none was.  ``optimality`` is the result for the task's
    objectives.
    """

    verdict: Verdict
    reason: str | None
    design: Design | None
    records: tuple[StructureRecord, ...]
    abstraction: Abstraction
    counts: dict[str, int]
    separation: SeparationClaim | None = None
    designs: tuple[Proved, ...] = ()
    samples: tuple[PathSamples, ...] = ()
    counterexamples: tuple[CounterExampleRecord, ...] = ()
    nearest: NearestMotion | None = None
    ended: str | None = None
    unfinished: bool = False
    last_step: str = ""
    lemmas: tuple[Lemma, ...] = ()
    bound: RobustnessBound | None = None
    unbounded: str | None = None
    optimality: Optimality | None = None


def synthesise(
    program: ir.Program,
    task: ir.Task,
    context: RunContext,
    least_cells: int | None = None,
    *,
    every: bool = False,
    gap: Fraction | None = None,
    told: Callable[[Synthesis], None] = lambda _: None,
) -> Synthesis:
    """Run Algorithm 1 on a task, with at least ``least_cells`` cells if given.

    With ``every`` the search continues after a design, over all structures up to the bound.  With a
    ``gap`` it continues until no design can be more robust than the best one by more than that
    share of it; only the best design is kept.  ``told`` receives an interim result with each proved
    design while the search continues.

    Raises:
        MapFault: if a map of obstacles cannot be used.
    """
    program, task = expanded(program, task)
    cells = Abstraction(program.workspaces[task.workspace].dimension, (), {})
    try:
        check_time(BEGUN)
        cells = abstract(program.workspaces[task.workspace])
        separation = disconnected(program, task, cells)
        if separation is not None:
            reason = separation_text(program, task, separation)
            return Synthesis("impossible", reason, None, (), cells, dict(NO_COUNTS), separation)
        finer = cells if least_cells is None else cells.cut(bisections(cells, least_cells))
        family = family_of(program, task)
    except OutOfTimeError as late:
        return Synthesis(
            "unknown", OUT_OF_TIME, None, (), cells, dict(NO_COUNTS),
            unfinished=True, last_step=late.step,
        )  # fmt: skip

    def better(search: FamilySearch) -> None:
        """Report an interim result with a design, as if time had run out."""
        told(_result(search, "found", None, cells, OutOfTimeError()))

    run = FamilySearch(program, task, context, family, finer, every, better, gap)
    least = LeastSearch(run, run.amounts)
    try:
        if run.amounts:
            least.search()
        else:
            run.structures()
        if run.designs:
            check_time()
            found = _result(run, "found", None, cells)
            return found if not run.amounts else _with_least(found, _optimality(run), least.ended)
        records: Sequence[StructureRecord] = run.all_records(PUT_OFF)
        verdict, reason = conclude(records, run.family, task, run.stopped)
    except OutOfTimeError as late:
        reason = OUT_OF_TIME + _under_way(run.queue.current)
        return _result(run, "unknown", reason, cells, late)
    uncovered = None
    if verdict == "impossible":
        records, uncovered = covered(records, family, task, context)
    if uncovered is not None:
        reason = f"{reason}; {NOT_COVERED}"
    return _result(run, verdict, reason, cells, uncovered, records)


def _with_least(found: Synthesis, optimality: Optimality, limits: Mapping[str, str]) -> Synthesis:
    """A result with the proved bounds on its objectives.

    ``limits`` are those that ended the search for less of a kind; they matter if less is possible.
    """
    unsettled = [each for each in optimality.objectives if not each.is_settled]
    kinds = [each.amount.objective.kind for each in unsettled]
    said = [found.ended, *(limits.get(kind) for kind in kinds)]
    ended = "; ".join(text for text in said if text)
    return replace(found, optimality=optimality, ended=ended or None)


def _optimality(run: FamilySearch) -> Optimality:
    """The proved bounds on the objectives of the best design."""
    values, records = run.values(run.designs[0].design), run.all_records(PUT_OFF)
    limits, _ = limits_of(run.all_values, run.amounts)
    found = optimality(run.whole, run.task, values, limits, records, run.lemmas, run.context)
    if not any(each.objective.kind == "time" for each in run.amounts) or not run.task.at_most:
        return found
    best = min(len(design.inputs) for each in run.all_searched for design in each.proved)
    step = run.task.step
    if best == run.task.fewest_steps:
        return found.with_least_time(best * step)
    tried = Tried(records, tuple(run.lemmas))
    try:
        bound = time_bound(run.whole, run.task, run.context, tried, best)
    except NoBoundError as why:
        return replace(found, untimed=str(why))
    return found.with_least_time((bound.steps + 1) * step, bound)


def _under_way(structure: StructureUnderWay | None) -> str:
    """A description of what the time limit interrupted, to follow its name."""
    if structure is None or structure.state.is_over:
        return ""
    word = " ".join(structure.derivation.word)
    waiting = structure.waiting
    if waiting is None or not waiting.feasible:
        return f" while a motion of {word} was searched"
    return f" while a motion of {word}, of robustness {waiting.robustness:.4g}, was proved"


def _result(
    run: FamilySearch,
    verdict: Verdict,
    reason: str | None,
    cells: Abstraction,
    late: OutOfTimeError | None = None,
    records: Sequence[StructureRecord] | None = None,
) -> Synthesis:
    """The result; if there is a design the verdict is found, whatever ended the search."""
    designs, searched = run.designs, run.all_searched
    if designs:
        verdict, reason, cells = "found", None, designs[0].design.abstraction
    unknown = verdict == "unknown"
    nearest = [each.nearest for each in searched if unknown and each.nearest is not None]
    if records is None:
        records = run.all_records(PUT_OFF if late is None else OUT_OF_TIME)
    return Synthesis(
        verdict,
        reason,
        designs[0].design if designs else None,
        tuple(records),
        cells,
        run.counts,
        designs=designs,
        samples=tuple(sample for each in searched for sample in each.samples),
        counterexamples=tuple(
            found for each in searched for found in each.state.counterexamples(each.number)
        ),
        nearest=max(nearest, key=lambda motion: motion.rank, default=None),
        ended=_ended(run, late),
        unfinished=late is not None,
        last_step="" if late is None else late.step,
        lemmas=tuple(run.lemmas),
        bound=run.bound if designs else None,
        unbounded=_unbounded(run, late) if designs else None,
        optimality=_stated(run, designs[0]) if designs and run.amounts else None,
    )


def _ended(run: FamilySearch, late: OutOfTimeError | None) -> str | None:
    """Why not all remaining structures were tried after a design."""
    if late is not None:
        return OUT_OF_TIME if run.every else None
    return run.stopped if run.every or run.amounts else None


def _stated(run: FamilySearch, best: Proved) -> Optimality:
    """The objectives of the best design, with no proved bounds yet."""
    return stated(run.task, run.amounts, run.values(best.design))


def _unbounded(run: FamilySearch, late: OutOfTimeError | None) -> str | None:
    """Why there is no bound although one was asked for."""
    if run.gap is None or run.bound is not None:
        return None
    return run.unbounded or (None if late is None else OUT_OF_TIME)
