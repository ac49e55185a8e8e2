"""The command ``replay``."""

from __future__ import annotations

from fractions import Fraction
from math import isfinite
from pathlib import Path

import click

from srgc.cli.arguments import FOLDER, DocumentedCommand
from srgc.faults import REFUSED, UNKNOWN, UsageFault


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc replay out/demo --in mujoco",
        "srgc replay out/demo --in mujoco --timestep 0.125 --halvings 4",
        "srgc replay out/demo --in python --json",
    ],
    statuses={
        0: "simulated, at any distance from the tube; no disturbed motion left it",
        REFUSED: "a disturbed motion left the tube",
        UNKNOWN: "there is no tube to compare with",
    },
    reads_spec=False,
    read_on="docs/how-to/export.md",
)
@FOLDER
@click.option(
    "--in",
    "simulator",
    default="python",
    type=click.Choice(["mujoco", "python"]),
    help="python: our own equations with a method of order eight; the default. mujoco: the "
    'exported MJCF, with pip install "srgc[mujoco]".',
)
@click.option(
    "--timestep",
    type=float,
    metavar="S",
    help="mujoco: the longest step of the simulation; default 0.001, or 0.0001 with --disturbed.",
)
@click.option(
    "--integrator",
    type=click.Choice(["rk4", "euler", "implicit", "implicitfast"], case_sensitive=False),
    help="mujoco: default rk4.",
)
@click.option(
    "--halvings",
    type=click.IntRange(0, 16),
    default=0,
    help="mujoco: repeat this many times, with half the step each time.",
)
@click.option(
    "--disturbed",
    type=click.IntRange(1, 1_000_000),
    metavar="N",
    help="mujoco: N motions under the disturbances of the task, at random and at corners.",
)
@click.option("--seed", type=click.IntRange(0), help="The seed of the disturbances; default 0.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
def replay(
    folder: Path,
    simulator: str,
    timestep: float | None,
    integrator: str | None,
    halvings: int,
    disturbed: int | None,
    seed: int | None,
    as_json: bool,  # noqa: FBT001
) -> int:
    """Simulate the planned inputs and compare the motion with the certified tube.

    The output says how far the motion leaves the tube at most, and how far it is from the middle.
    This is the error of the simulator's own integration, which decreases with its step.  With
    --disturbed, it says how many motions left the tube.  None may, beyond that error.
    """
    from srgc.replays.replay_report import replay_json, replay_text
    from srgc.replays.replay_run import ReplayRequest
    from srgc.replays.replay_run import replay as replayed

    if simulator != "mujoco" and (timestep is not None or integrator is not None or halvings):
        raise UsageFault("--timestep, --integrator and --halvings go with --in mujoco alone")
    if disturbed is not None and (simulator != "mujoco" or halvings):
        raise UsageFault("--disturbed goes with --in mujoco, and without --halvings")
    if disturbed is None and seed is not None:
        raise UsageFault("--seed goes with --disturbed")
    if timestep is not None and not (isfinite(timestep) and timestep > 0):
        raise UsageFault("--timestep is a positive number of seconds")
    # The number as it was typed, so that 0.1 divides a step of 0.1 s.
    longest = None if timestep is None else Fraction(repr(timestep))
    if disturbed is not None:
        return _disturbed(folder, disturbed, seed or 0, longest, integrator, as_json=as_json)
    found = replayed(folder, ReplayRequest(simulator, longest, integrator or "rk4", halvings))
    click.echo(replay_json(found) if as_json else replay_text(found))
    return 0


def _disturbed(
    folder: Path,
    count: int,
    seed: int,
    timestep: Fraction | None,
    integrator: str | None,
    *,
    as_json: bool,
) -> int:
    """Replay ``count`` disturbed motions."""
    from srgc.replays.disturbed_replay import DisturbedRequest, disturbed_replay
    from srgc.replays.replay_report import disturbed_json, disturbed_text
    from srgc.results.progress_display import progress

    request = DisturbedRequest(range(count), seed, timestep, integrator or "rk4")
    with progress(f"replay {folder}", quiet=False, unit="parts", plain=False) as display:
        found = disturbed_replay(folder, request, display.part)
    click.echo(disturbed_json(found) if as_json else disturbed_text(found))
    return REFUSED if found.left else 0
