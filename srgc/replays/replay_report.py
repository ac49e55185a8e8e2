"""What ``srgc replay`` prints."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import pairwise
from math import log2

import numpy as np

from solvers.verifier.report import Outcome, Report
from srgc.replays.replay_run import Deviation, Farthest, Replay, TubeComparison

PARTS = ("coordinates", "rates", "effectors")


def replay_text(replay: Replay) -> str:
    """The report for people; a table where there are several runs."""
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
    """The same as an object."""
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
    of = "all disturbed motions" if replay.disturbed else "the motion"
    yield f"the tube holds {of}; its half-width is at most {replay.half_width:.2e} (SI)"


def _proof_lines(verified: Report) -> Iterator[str]:
    """What a tube alone does not say: that the motion in it does the task."""
    if verified.outcome is not Outcome.VALID:
        yield f"but the certificate is {verified.outcome.value}: {verified.reason}"


def _table(runs: Sequence[TubeComparison]) -> Iterator[str]:
    """Distances from the middle by step, and how far coordinates are from the run before.

    That falls by 2**order from line to line as long as it is the error of the method.
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
    """Of each run the largest difference of a coordinate or rate from the run before, at samples.

    In SI units; None of the first.
    """
    states = [run.motion.at_steps() for run in runs]
    return [
        None,
        *(float(np.abs(after - first).max(initial=0.0)) for first, after in pairwise(states)),
    ]
