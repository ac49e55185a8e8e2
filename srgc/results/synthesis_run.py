"""``srgc synth``: one synthesis, from a file to a result folder."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice
from pathlib import Path

import numpy as np

from compiler.expressions.exact_numbers import decimal
from compiler.robots.normal_form import family_of
from compiler.robots.state_and_input import family_unit
from compiler.tasks.obstacle_pieces import expanded
from compiler.words.structures import InfiniteAmbiguityError, structures
from grammar_lang import ir
from solvers.conclusion import module_bound, robot_limit
from solvers.execution.workers import Workers
from solvers.explanation.scarce_limits import with_remedy
from solvers.run_context import EVALUATIONS, PATHS, Journal, Reporter, RunContext
from solvers.search.design_values import design_values
from solvers.search.family_search import Proved
from solvers.search.optimality import stated
from solvers.search.path_task import Design
from solvers.search.synthesis import Synthesis, synthesise
from solvers.verifier.claims.certificate import spec_digest
from solvers.verifier.claims.spec_copy import files_of
from solvers.verifier.refutations.solver_process import DisagreementError
from srgc.faults import SolversDisagree
from srgc.interruption import resumable
from srgc.results.design_file import (
    certificate_text,
    design_text,
    evaluations_csv,
    samples_csv,
    trajectory_csv,
)
from srgc.results.evidence_claims import Evidence, bound_evidence, optimality_files
from srgc.results.folder_writer import NEAREST_PICTURE, FolderWriter
from srgc.results.progress_display import progress, tell_kept
from srgc.results.result_folder import Identity, ResultFolder, open_folder
from srgc.search_options import named_smt_solvers, workers_for
from srgc.session import UsageFault
from srgc.text_reports.synthesis_report import change_of
from srgc.time_limit import TimeLimit
from srgc.version import VERSION

PICTURES = ("figures/workspace.svg", "figures/inputs.svg")
NEAREST = "nearest.csv"
DISAGREEMENT = "proofs/disagreement"
KEPT = "the design that an earlier run proved is kept"


@dataclass(frozen=True, slots=True)
class SynthesisOptions:
    """The options of a run."""

    output: Path
    seed: int
    jobs: int
    time_limit: TimeLimit | None
    force: bool
    quiet: bool
    cells: int | None = None
    cluster: str | None = None
    every: bool = False
    solver: str | None = None
    search: str | None = None
    paths: int | None = None
    evaluations: int | None = None
    lemmas: bool = True
    smt: str | None = None
    gap: float | None = None
    """In percent."""
    front: bool = False
    """Whether to keep only the designs that no other dominates."""


def run_synthesis(
    path: Path, program: ir.Program, task: ir.Task, options: SynthesisOptions
) -> Synthesis:
    """Synthesise, and write the result folder.

    Raises:
        UsageFault: the folder or the cluster cannot be used.
        NoAnswer: the workers were lost; another run can resume from the folder.
        SolversDisagree: two SMT solvers contradict each other; the script is in the folder.
    """
    with workers_for(options.jobs, options.cluster) as workers:
        return _run(path, program, task, options, workers)


def _run(
    path: Path, program: ir.Program, task: ir.Task, options: SynthesisOptions, workers: Workers
) -> Synthesis:
    limit, clock = options.time_limit or TimeLimit(), TimeLimit()
    files = files_to_copy(program)
    digest = spec_digest(files)
    identity = Identity(
        digest, task.name, options.seed, VERSION, options.cells, options.every,
        options.solver, options.search, unusual(options.paths, PATHS),
        unusual(options.evaluations, EVALUATIONS), not options.lemmas, options.smt, options.gap,
        options.front,
    )  # fmt: skip
    with (
        open_folder(options.output, identity, force=options.force, spec=path.name) as folder,
        resumable(options.output),
    ):
        tell_kept(folder.kept, quiet=options.quiet)
        for name, content in files.items():
            folder.files.write(f"spec/{name}", content)
        folder.files.keep_only("spec", files)
        program, task = expanded(program, task)

        def keep(better: Synthesis) -> None:
            """Write a design to the folder while the search goes on."""
            write_result(folder.files, better, program, task, path.name, identity, limit)

        try:
            result = _searched(folder, program, task, options, workers, limit, keep)
        except DisagreementError as error:
            answers = {"answers": dict(error.answers)}
            folder.files.write(f"{DISAGREEMENT}.smt2", error.script)
            folder.files.write(f"{DISAGREEMENT}.json", json.dumps(answers, indent=1) + "\n")
            kept = f"{options.output / DISAGREEMENT}.smt2"
            raise SolversDisagree(f"{error}; the script is kept as {kept}") from None
        result = with_remedy(result, program.workspaces[task.workspace], task, options.seed)
        searched = clock.passed
        if result.unfinished and result.design is None and folder.holds_design():
            return replace(result, reason=f"{result.reason}; {KEPT}")
        for name in ("designs", "pareto.csv", "pareto.json", "evaluations.csv", "report.html"):
            folder.files.discard(name)
        drawn = True
        if result.designs and options.every:
            drawn = _write_all(folder, result, program, task, path.name, files, limit)
        drawn &= write_result(folder.files, result, program, task, path.name, identity, limit)
        result = replace(result, unfinished=result.unfinished or not drawn)
        total = round(clock.passed, 3)
        timings = {"search_s": round(searched, 3), "total_s": total, **result.counts}
        folder.files.write("log.json", json.dumps(timings, indent=1) + "\n")
        if not result.unfinished:
            folder.finish()
    return result


def unusual(budget: int | None, usual: int) -> int | None:
    """The budget, or None if it is the default."""
    return None if budget == usual else budget


def _searched(
    folder: ResultFolder,
    program: ir.Program,
    task: ir.Task,
    options: SynthesisOptions,
    workers: Workers,
    limit: TimeLimit,
    told: Callable[[Synthesis], None],
) -> Synthesis:
    """Search and show progress; ``told`` is called with results that have ever better designs."""
    with progress(
        f"synth {task.name}",
        quiet=options.quiet,
        unit="structures",
        count=lambda: structure_total(program, task),
        measure=family_unit(program, task),
    ) as display:
        context = run_context(options, workers, display, folder, limit)
        with limit.holds():
            result = synthesise(
                program,
                task,
                context,
                options.cells,
                every=options.every,
                gap=None if options.gap is None else Fraction(options.gap) / 100,
                told=told,
            )
    return _told(result, limit)


def run_context(
    options: SynthesisOptions,
    workers: Workers,
    reporter: Reporter,
    journal: Journal,
    limit: TimeLimit,
) -> RunContext:
    """The context of a run: its options, with its workers, display and journal."""
    return RunContext(
        seed=options.seed,
        workers=workers,
        solver=options.solver,
        search=options.search,
        reporter=reporter,
        journal=journal,
        out_of_time=limit.reached,
        paths=options.paths or PATHS,
        evaluations=options.evaluations or EVALUATIONS,
        lemmas=options.lemmas,
        smt=named_smt_solvers(options.smt),
    )


def _told(result: Synthesis, limit: TimeLimit) -> Synthesis:
    """The result; its texts mention it if the search has exceeded its time limit by far."""
    overrun = limit.overrun(result.last_step) if result.unfinished else ""
    if not overrun:
        return result
    reason, ended = (text and text + overrun for text in (result.reason, result.ended))
    return replace(result, reason=reason, ended=ended)


def files_to_copy(program: ir.Program) -> dict[str, bytes]:
    """The files of a program, for a copy with the same meaning.

    Raises:
        UsageFault: no copy would have the same meaning.
    """
    for source in program.sources:
        if source.twin is not None:
            raise UsageFault(
                f"`{source.path}` and `{source.twin}` are one file, and two in a copy of the spec: "
                "include it under one name"
            )
        try:
            source.path.encode()
        except UnicodeEncodeError:
            raise UsageFault(f"{source.name}: the name of a spec has to be UTF-8") from None
    return files_of(program.sources)


def _write_all(
    folder: ResultFolder,
    result: Synthesis,
    program: ir.Program,
    task: ir.Task,
    spec: str,
    files: Mapping[str, bytes],
    limit: TimeLimit,
) -> bool:
    """Write each design to keep into its own folder, and the tables about all designs.

    Returns:
        Whether all were drawn.
    """
    from srgc.results.pareto_table import pareto_csv, pareto_json, pareto_table

    drawn, table = True, pareto_table(result, program, task, front_only=folder.identity.front)
    dominated = {row.structure for row in table.dominated} if table.front_only else set()
    for proved in result.designs:
        if proved.number in dominated:
            continue
        own = folder.files.within(f"designs/{proved.number}")
        for name, content in files.items():
            own.write(f"spec/{name}", content)
        one = alone(result, proved, task)
        drawn &= write_result(own, one, program, task, spec, folder.identity, limit)
    folder.files.write("pareto.csv", pareto_csv(table))
    folder.files.write("pareto.json", pareto_json(table))
    return drawn


def alone(result: Synthesis, proved: Proved, task: ir.Task) -> Synthesis:
    """One design of a result, as the result of a search of its structure alone."""
    asked = () if result.optimality is None else result.optimality.objectives
    amounts = tuple(each.amount for each in asked)
    values = design_values(proved.design, amounts, task)
    samples = (each for each in result.samples if each.structure == proved.number)
    known = (each for each in result.counterexamples if each.structure == proved.number)
    return replace(
        result,
        design=proved.design,
        records=(result.records[proved.number],),
        abstraction=proved.design.abstraction,
        counts=proved.counts,
        designs=(replace(proved, number=0),),
        lemmas=(),
        optimality=stated(task, amounts, values) if asked else None,
        samples=tuple(replace(each, structure=0) for each in samples),
        counterexamples=tuple(replace(each, structure=0) for each in known),
    )


def write_result(
    files: FolderWriter,
    result: Synthesis,
    program: ir.Program,
    task: ir.Task,
    spec: str,
    identity: Identity,
    limit: TimeLimit,
) -> bool:
    """Write all files of a result; the certificate and ``design.json`` come last.

    Pictures take a second; if the time is over, they are left to another run.

    Returns:
        Whether they were drawn, or there is nothing to draw.
    """
    design = result.design
    if design is not None:
        # All files are about the motion that was found, with its own number of steps.
        task = task.lasting(len(design.inputs))
    evidence = Evidence(result.records, result.lemmas).files()
    if result.bound is not None:
        evidence |= bound_evidence(result.bound).files()
    if result.optimality is not None:
        evidence |= optimality_files(result.optimality)
    for name, content in evidence.items():
        files.write(name, content)
    if result.samples:
        files.write("evaluations.csv", evaluations_csv(result.samples))
    if design is None:
        _write_nearest(files, result, program, task)
        drawn = True
    else:
        drawn = _write_motion(files, result, design, program, task, limit)
    certificate = certificate_text(
        result, task, spec, identity.spec_sha256, task.modules, result.separation
    )
    # Files that are read together must not be of two designs, so one is missing meanwhile.
    files.discard("design.json")
    if certificate is not None:
        files.write("certificate.json", certificate)
    files.write(
        "design.json",
        design_text(result, task, spec, identity, change_of(program, task, design)),
    )
    return drawn


def _write_nearest(
    files: FolderWriter, result: Synthesis, program: ir.Program, task: ir.Task
) -> None:
    """Write the nearest motion of a result without a design and its picture, if there is one."""
    for name in ("trajectory.csv", "figures", "certificate.json"):
        files.discard(name)
    nearest = result.nearest
    if nearest is None or not np.all(np.isfinite(nearest.trajectory.x)):
        files.discard(NEAREST)
        return
    task = task.lasting(len(nearest.trajectory.u))
    inputs = [[decimal(value) for value in row] for row in nearest.trajectory.u]
    files.write(NEAREST, samples_csv(nearest.model, nearest.trajectory, inputs, task))
    from srgc.render.result_pictures import nearest_figure

    workspace = program.workspaces[task.workspace]
    files.write(NEAREST_PICTURE, nearest_figure(nearest, workspace, task))


def _write_motion(
    files: FolderWriter,
    result: Synthesis,
    design: Design,
    program: ir.Program,
    task: ir.Task,
    limit: TimeLimit,
) -> bool:
    """Write the motion of a design; return whether it was drawn."""
    for name in (NEAREST, NEAREST_PICTURE):
        files.discard(name)
    files.write("trajectory.csv", trajectory_csv(design, task))
    if result.unfinished or limit.reached():
        for name in PICTURES:
            files.discard(name)
        return False
    from srgc.render.result_pictures import input_figure, workspace_figure

    workspace = program.workspaces[task.workspace]
    files.write(PICTURES[0], workspace_figure(result, design, workspace, task))
    files.write(PICTURES[1], input_figure(design, task))
    return True


# --- The number of structures that a search may have to try ---------------------------------------


MOST_COUNTED = 500
"""The most structures to count, which takes a tenth of a second."""


def structure_total(program: ir.Program, task: ir.Task) -> int | None:
    """The number of structures up to the task's bound; None if it is very large or only limited."""
    family = family_of(program, task)
    if robot_limit(family, task) is not None:
        return None
    try:
        found = structures(family.language, module_bound(family, task))
    except InfiniteAmbiguityError:
        return None
    number = sum(1 for _ in islice(found, MOST_COUNTED + 1))
    return None if number > MOST_COUNTED else number
