"""``srgc synth --mission`` and ``srgc evolve``: one mission, from a file to a result folder."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from compiler.missions.module_differences import ModuleDifference
from compiler.missions.parameter_ranges import Ranges, single
from compiler.missions.robot_changes import built
from compiler.robots.state_and_input import family_unit
from compiler.tasks.obstacle_pieces import expanded
from grammar_lang import ir
from solvers.conclusion import StructureRecord
from solvers.execution.workers import Workers
from solvers.missions.mission_result import Existing, MissionResult
from solvers.missions.mission_search import solve
from solvers.run_context import EVALUATIONS, PATHS
from solvers.search.family_search import Proved
from solvers.search.path_task import Design
from solvers.search.synthesis import Synthesis
from solvers.verdict import MISSION
from solvers.verifier.claims.certificate import exact, spec_digest
from solvers.verifier.claims.mission_claim import ExistingClaim, PosedClaim
from srgc.interruption import resumable
from srgc.results.folder_writer import FolderWriter
from srgc.results.mission_files import (
    claim_text,
    evidence_files,
    existing_claim,
    mission_design_text,
)
from srgc.results.progress_display import progress, tell_kept
from srgc.results.result_folder import Identity, ResultFolder, open_folder
from srgc.results.synthesis_run import (
    SynthesisOptions,
    files_to_copy,
    run_context,
    unusual,
    write_result,
)
from srgc.search_options import workers_for
from srgc.time_limit import TimeLimit
from srgc.version import VERSION


@dataclass(frozen=True, slots=True)
class Step:
    """One step from an existing robot: the claim, the robot, and the results that led to it.

    ``history`` maps new names to the files of all earlier results; ``differs`` are the modules of
    the robot that the spec of the task builds differently.
    """

    posed: PosedClaim
    existing: ExistingClaim
    history: Mapping[str, bytes]
    before: int
    differs: tuple[ModuleDifference, ...] = ()

    @property
    def digest(self) -> str:
        """A digest of the step: the robot, the prices and the free parameters."""
        text = json.dumps([asdict(self.posed), asdict(self.existing)], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def run_mission(
    path: Path,
    program: ir.Program,
    mission: ir.Mission,
    options: SynthesisOptions,
    step: Step | None = None,
) -> MissionResult:
    """Search, and write the result folder.

    Args:
        path: the file.
        program: the program of the file.
        mission: one of its missions; with a ``step``, the mission of one task.
        options: how to search, and where to write.
        step: the step from an existing robot, if any.

    Raises:
        UsageFault: the folder or the cluster cannot be used.
        NoAnswer: the workers were lost; another run can resume from the folder.
    """
    with workers_for(options.jobs, options.cluster) as workers:
        return _run(path, program, mission, options, step, workers)


def _run(
    path: Path,
    program: ir.Program,
    mission: ir.Mission,
    options: SynthesisOptions,
    step: Step | None,
    workers: Workers,
) -> MissionResult:
    limit, clock = options.time_limit or TimeLimit(), TimeLimit()
    files = files_to_copy(program)
    identity = Identity(
        spec_digest(files), ", ".join(mission.tasks), options.seed, VERSION, None,
        solver=options.solver, search=options.search, paths=unusual(options.paths, PATHS),
        evaluations=unusual(options.evaluations, EVALUATIONS), one_by_one=not options.lemmas,
        smt=options.smt, mission=mission.name, origin=None if step is None else step.digest,
    )  # fmt: skip
    with (
        open_folder(options.output, identity, force=options.force, spec=path.name) as folder,
        resumable(options.output),
    ):
        tell_kept(folder.kept, quiet=options.quiet)
        _copy(folder.files, files)
        result = _searched(folder, program, mission, options, step, workers, limit)
        searched = clock.passed
        drawn = _write(folder, result, program, path.name, identity, limit, files, step)
        result = replace(result, unfinished=result.unfinished or not drawn)
        timings = {"search_s": round(searched, 3), "total_s": round(clock.passed, 3)}
        text = json.dumps({**timings, **result.counts}, indent=1)
        folder.files.write("log.json", f"{text}\n")
        if not result.unfinished:
            folder.finish()
    return result


def _copy(files: FolderWriter, spec: Mapping[str, bytes]) -> None:
    for name, content in spec.items():
        files.write(f"spec/{name}", content)
    files.keep_only("spec", spec)


def _searched(
    folder: ResultFolder,
    program: ir.Program,
    mission: ir.Mission,
    options: SynthesisOptions,
    step: Step | None,
    workers: Workers,
    limit: TimeLimit,
) -> MissionResult:
    measures = {family_unit(program, program.tasks[name]) for name in mission.tasks}
    measure = measures.pop() if len(measures) == 1 else ""
    with progress(
        f"mission {mission.name}", quiet=options.quiet, unit="robots", measure=measure
    ) as display:
        context = run_context(options, workers, display, folder, limit)
        with limit.holds():
            return solve(
                program, mission, context, None if step is None else _existing(program, step)
            )


def _existing(program: ir.Program, step: Step) -> Existing:
    """The existing robot, in the form that the search needs."""
    values: dict[tuple[int, str], Ranges] = {
        (each.symbol, each.name): single(exact(each.value)) for each in step.existing.parameters
    }
    word = step.existing.word
    return Existing(word, built(word, program.modules, values))


def _write(
    folder: ResultFolder,
    result: MissionResult,
    program: ir.Program,
    spec: str,
    identity: Identity,
    limit: TimeLimit,
    files: Mapping[str, bytes],
    step: Step | None,
) -> bool:
    """Write the result's files, the claim and ``design.json`` last; return whether all is drawn."""
    writer, drawn = folder.files, True
    for name in ("tasks", "proofs", "history", "design.json", MISSION, "report.html"):
        writer.discard(name)
    for name, content in ({} if step is None else step.history).items():
        writer.write(name, content)
    for name, text in evidence_files(result).items():
        writer.write(name, text)
    for name, design in zip(result.mission.tasks, result.designs, strict=False):
        own = writer.within(f"tasks/{name}")
        for path, data in files.items():
            own.write(f"spec/{path}", data)
        plain, task = expanded(program, program.tasks[name])
        told = replace(identity, task=name, mission=None)
        drawn &= write_result(own, design_alone(design), plain, task, spec, told, limit)
    stated = existing_claim(
        result.existing, program.tasks[result.mission.tasks[0]].origin,
        None if step is None else step.existing,
    )  # fmt: skip
    posed = None if step is None else step.posed
    claim = claim_text(result, identity, spec, posed, stated)
    if claim is not None:
        writer.write(MISSION, claim)
    before, differs = (0, ()) if step is None else (step.before, step.differs)
    said = mission_design_text(result, identity, spec, stated, before, differs)
    writer.write("design.json", said)
    return drawn


def design_alone(design: Design) -> Synthesis:
    """A design of a mission, as the result of a search of its structure in its task."""
    word, labels = design.derivation.word, design.derivation.labels
    record = StructureRecord(word, labels, "found", "proved")
    counts = {"structures": 1, "paths": 0, "evaluations": 0, "smt": 0}
    proved = Proved(0, design, counts)
    return Synthesis(
        "found", None, design, (record,), design.abstraction, counts, designs=(proved,)
    )
