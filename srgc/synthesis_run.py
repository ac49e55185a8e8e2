"""``srgc synth``: one synthesis from a file to a result folder."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from compiler.maps.obstacle_pieces import expanded
from grammar_lang import ir
from solvers.claims.certificate import spec_digest
from solvers.claims.spec_copy import files_of
from solvers.progress import Conduct
from solvers.synthesis import Synthesis, synthesise
from srgc.design_file import certificate_text, design_text, proof_name, trajectory_csv
from srgc.progress_display import progress
from srgc.result_folder import Identity, ResultFolder, open_folder
from srgc.session import UsageFault


@dataclass(frozen=True, slots=True)
class SynthesisOptions:
    """The options of a run."""

    output: Path
    seed: int
    jobs: int
    time_limit: float | None
    force: bool
    quiet: bool
    cells: int | None = None


def run_synthesis(
    path: Path, program: ir.Program, task: ir.Task, options: SynthesisOptions
) -> Synthesis:
    """Synthesise and write the result folder.

    Raises:
        UsageFault: the folder cannot be used.
    """
    started = time.monotonic()
    files = _spec_files(program)
    digest = spec_digest(files)
    identity = Identity(digest, task.name, options.seed, version("srgc"), options.cells)
    folder = open_folder(options.output, identity, force=options.force)
    for name, content in files.items():
        folder.write(f"spec/{name}", content)
    folder.keep_only("spec", files)

    def out_of_time() -> bool:
        limit = options.time_limit
        return limit is not None and time.monotonic() - started > limit

    program, task = expanded(program, task)
    with progress(quiet=options.quiet) as display:
        conduct = Conduct(options.seed, options.jobs, display, folder, out_of_time)
        result = synthesise(program, task, conduct, options.cells)
    searched = time.monotonic() - started
    _write(folder, result, program, task, path.name, identity)
    total = time.monotonic() - started
    timings = {"search_s": round(searched, 3), "total_s": round(total, 3), **result.counts}
    folder.write("log.json", json.dumps(timings, indent=1) + "\n")
    if not (result.verdict == "unknown" and out_of_time()):
        folder.finish()
    return result


def _spec_files(program: ir.Program) -> dict[str, bytes]:
    """The files of a program, for a copy that means the same.

    Raises:
        UsageFault: no copy does.
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


def _write(
    folder: ResultFolder,
    result: Synthesis,
    program: ir.Program,
    task: ir.Task,
    spec: str,
    identity: Identity,
) -> None:
    """All files of a result; the certificate and ``design.json`` last."""
    for index, record in enumerate(result.records):
        if record.script is not None:
            folder.write(proof_name(index), record.script)
    design = result.design
    if design is None:
        for name in ("trajectory.csv", "figures", "certificate.json"):
            folder.discard(name)
    else:
        from srgc.figures import input_figure, workspace_figure

        folder.write("trajectory.csv", trajectory_csv(design, task))
        workspace = program.workspaces[task.workspace]
        folder.write("figures/workspace.svg", workspace_figure(result, design, workspace, task))
        folder.write("figures/inputs.svg", input_figure(design, task))
    certificate = certificate_text(
        result, task, spec, identity.spec_sha256, task.modules, result.separation
    )
    if certificate is not None:
        folder.write("certificate.json", certificate)
    folder.write(
        "design.json",
        design_text(result, task, spec, identity),
    )
