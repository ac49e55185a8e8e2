"""Format the reports of ``srgc replay``."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import pairwise
from math import log2

import numpy as np

from grammar_lang.diagnostics.wording import counted
from solvers.verifier.report import Outcome, Report
from srgc.replays.disturbed_replay import DisturbedReplay, Reached
from srgc.replays.replay_run import Deviation, Farthest, Replay, TubeComparison

PARTS = ("coordinates", "rates", "effectors")
MOST_SHOWN = 5
"""The most numbers of motions in a report for people."""


def replay_text(replay: Replay) -> str:
    """The report for people, with a table if there are several runs."""
    first = replay.runs[0].motion
    steps = "" if first.timestep is None else f", steps of {float(first.timestep):g} s"
    lines = [
        f"in {first.simulator}, {first.method}{steps}; {len(first.times)} instants compared",
        *_farthest_lines(replay.runs[0]),
        *_tube_lines(replay),
        *_proof_lines(replay.verified),
    ]
    if len(replay.runs) > 1:
        lines += ["", *_table(replay.runs)]
    return "\n".join(lines)


def replay_json(replay: Replay) -> str:
    """The report as a JSON object."""
    content = {
        "simulator": replay.runs[0].motion.simulator,
        "version": replay.runs[0].motion.version,
        "method": replay.runs[0].motion.method,
        "disturbed": replay.disturbed,
        "half_width": replay.half_width,
        "certificate": replay.verified.outcome.value,
        "runs": [
            {
                "timestep": None if (h := run.motion.timestep) is None else float(h),
                "instants": len(run.motion.times),
                "change": change,
                **{part: _described(getattr(run, part)) for part in PARTS},
            }
            for run, change in zip(replay.runs, changes(replay.runs), strict=True)
        ],
    }
    return json.dumps(content, indent=1, ensure_ascii=False)


def _described(deviation: Deviation | None) -> dict[str, object] | None:
    return None if deviation is None else asdict(deviation)


def _farthest_lines(run: TubeComparison) -> Iterator[str]:
    for part in PARTS:
        deviation: Deviation | None = getattr(run, part)
        if deviation is not None:
            yield f"  {part:<12} outside the tube  {_shown(deviation.outside)}"
            yield f"  {'':<12} from its middle   {_shown(deviation.middle)}"


def _shown(farthest: Farthest) -> str:
    if not farthest.value:
        return "never"
    where = f"({farthest.name} at {farthest.time:.3f} s)"
    return f"at most {farthest.value:.2e} {farthest.unit} {where}"


def _tube_lines(replay: Replay) -> Iterator[str]:
    if replay.half_width is None:
        return
    motions = "all rounds of all motions" if replay.repeats else "all disturbed motions"
    of = motions if replay.disturbed else "the motion"
    yield f"the tube holds {of}; its half-width is at most {replay.half_width:.2e} (SI)"


def _proof_lines(verified: Report) -> Iterator[str]:
    """A line if the certificate is not valid: a tube alone does not prove that the task is done."""
    if verified.outcome is not Outcome.VALID:
        yield f"but the certificate is {verified.outcome.value}: {verified.reason}"


def _table(runs: Sequence[TubeComparison]) -> Iterator[str]:
    """Distances from the centre for each step, and changes of coordinates from the run before.

    While the error of the method dominates, the change falls by 2**order from line to line.
    """
    yield "  step (s)     coordinates        rates    effectors       change   order"
    before: float | None = None
    for run, change in zip(runs, changes(runs), strict=True):
        values = [
            None if (item := getattr(run, part)) is None else item.middle.value for part in PARTS
        ]
        shown = "".join(_cell(value) for value in (*values, change))
        order = f"{log2(before / change):8.2f}" if before and change else ""
        before = change
        yield f"  {float(run.motion.timestep or 0):<11.6g}{shown}{order}".rstrip()


def _cell(value: float | None) -> str:
    return f"{'-' if value is None else format(value, '.2e'):>13}"


def changes(runs: Sequence[TubeComparison]) -> list[float | None]:
    """The largest change of a coordinate or rate from the run before, at samples, for each run.

    Changes are in SI units, and None for the first run.
    """
    states = [run.motion.at_steps() for run in runs]
    return [
        None,
        *(float(np.abs(after - first).max(initial=0.0)) for first, after in pairwise(states)),
    ]


# --- Disturbed motions ----------------------------------------------------------------------------


KINDS = ("coordinates", "rates", "inputs")


def disturbed_text(found: DisturbedReplay) -> str:
    """The report on disturbed motions for people."""
    request, count = found.request, len(found.request.numbers)
    head = f"in MuJoCo, {request.integrator}, steps of {float(found.timestep):g} s"
    errors = "errors of the integration by half the step"
    lines = [
        f"{head}; {counted(count, 'disturbed motion')}, seed {request.seed}",
        f"left the tube:  {_numbers(found.left, count)}",
        *_reached_lines(found),
        f"compared at {found.samples} samples; {errors} for {counted(found.again, 'motion')}",
        *_proof_lines(found.verified),
    ]
    return "\n".join(lines)


def _numbers(left: Sequence[int], count: int) -> str:
    """The number of motions, and the first of them."""
    if not left:
        return f"0 of {count}"
    shown = ", ".join(map(str, left[:MOST_SHOWN])) + (" ..." if len(left) > MOST_SHOWN else "")
    return f"{len(left)} of {count} (number {shown})"


def _reached_lines(found: DisturbedReplay) -> Iterator[str]:
    for kind in KINDS:
        item: Reached | None = getattr(found, kind)
        if item is None:
            continue
        share = item.share
        where = f"({share.name} at {share.time:.3f} s, number {item.motion})"
        beyond = f", {item.outside:.2e} outside" if item.outside else ""
        yield (
            f"  {kind:<12} at most {100 * share.value:.4g} % of the way to a face {where}{beyond}; "
            f"error {item.error:.1e}"
        )


def disturbed_json(found: DisturbedReplay) -> str:
    """The report as a JSON object."""
    content = {
        "simulator": "MuJoCo",
        "version": found.version,
        "method": found.request.integrator,
        "timestep": float(found.timestep),
        "motions": len(found.request.numbers),
        "seed": found.request.seed,
        "samples": found.samples,
        "again": found.again,
        "left": list(found.left),
        "certificate": found.verified.outcome.value,
        **{kind: _reached_object(getattr(found, kind)) for kind in KINDS},
    }
    return json.dumps(content, indent=1, ensure_ascii=False)


def _reached_object(item: Reached | None) -> dict[str, object] | None:
    if item is None:
        return None
    share = item.share
    return {
        "share": share.value,
        "name": share.name,
        "time": share.time,
        "motion": item.motion,
        "outside": item.outside,
        "error": item.error,
        "unit": share.unit,
    }
