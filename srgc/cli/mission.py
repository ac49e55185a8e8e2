"""Run a mission search for ``synth --mission`` and ``evolve``, and print the result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from srgc.faults import VERDICT_STATUS, UsageFault

if TYPE_CHECKING:
    from grammar_lang import ir
    from srgc.results.mission_run import Step
    from srgc.results.synthesis_run import SynthesisOptions


def synth_mission(
    file: Path,
    program: ir.Program,
    name: str,
    output: Path | None,
    refused: Mapping[str, object],
    *,
    as_json: bool,
    verbose: bool,
    **options: Any,
) -> int:
    """Search for the robots of a mission, and write them.

    Args:
        file: the spec.
        program: the program of the spec.
        name: the name of the mission.
        output: the result folder; None for the default.
        refused: options that apply to a single task only, with their values.
        as_json: whether to print ``design.json``.
        verbose: whether to print the solvers' own answers.
        options: the options of the search, as for ``SynthesisOptions``.

    Raises:
        UsageFault: there is no such mission, or an option does not go with one.
    """
    from srgc.results.synthesis_run import SynthesisOptions
    from srgc.search_options import named_search, named_smt_solvers, named_solver
    from srgc.session import chosen, refuse_cycles

    for option, value in refused.items():
        if value is not None:
            raise UsageFault(f"{option} is about one task, and --mission about all of a mission")
    mission = chosen(program.missions, name, "mission")
    refuse_cycles(program, program.grammars[program.tasks[mission.tasks[0]].grammar])
    named_smt_solvers(options["smt"])
    options["solver"] = named_solver(options["solver"])
    options["search"] = named_search(options["search"])
    folder = output or Path("out") / mission.name
    asked = SynthesisOptions(folder, **options)
    return told(file, program, mission, asked, as_json=as_json, verbose=verbose)


def told(
    file: Path,
    program: ir.Program,
    mission: ir.Mission,
    options: SynthesisOptions,
    step: Step | None = None,
    *,
    as_json: bool,
    verbose: bool,
    notes: Sequence[str] = (),
) -> int:
    """Search for the robots of a mission, write them, and print the result and ``notes``."""
    from srgc.results.mission_run import run_mission
    from srgc.terminal import with_verdict
    from srgc.text_reports.mission_report import mission_text
    from srgc.text_reports.solver_words import without_solver_words

    result = run_mission(file, program, mission, options, step)
    if as_json:
        click.echo((options.output / "design.json").read_text(encoding="utf-8"), nl=False)
    else:
        text = mission_text(result, str(options.output), program, notes)
        shown = text if verbose else without_solver_words(text)
        click.echo(with_verdict(shown, result.verdict))
    return VERDICT_STATUS[result.verdict]
