"""`srgc synth` with some of its parts switched off, and a limit of processor time.

- *cores*: a path without a motion is deferred by itself, and no core of its cells is looked for.
- *lemmas*: every structure is refuted on its own, as with `--no-lemmas`.
- *feedback*: controllers are open loops, unless the task asks for feedback.
- *dovetailing*: each structure is searched to its end before the next.
- *polishing*: the best evaluations of parameters are taken as they are.

    python benchmarks/synth_without.py cores,lemmas specs/planar_arm.srg -o out/arm
    python benchmarks/synth_without.py nothing specs/planar_arm.srg -o out/arm
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

from timing import ROOT

sys.path.insert(0, str(ROOT))


def without_cores() -> None:
    """The whole path is its own explanation."""
    from solvers.search.path_cores import PathCore, PathCores

    def explained(_: PathCores, path_problem: Any, *__: object) -> PathCore | None:
        bound = path_problem.formula is not None or path_problem.loop is not None
        return None if bound else PathCore(tuple(range(len(path_problem.cells))))

    PathCores.explained = explained  # type: ignore[assignment, method-assign]


def without_feedback() -> None:
    """Tasks that leave the kind of control open get open loops."""
    from solvers.search import motion_proof
    from solvers.search.closed_loop import needs_feedback

    def choices(path_problem: Any, _: object) -> tuple[bool, ...]:
        return (needs_feedback(path_problem),)

    motion_proof.feedback_choices = choices
    motion_proof.MotionProof.wants_feedback = lambda *_: False  # type: ignore[method-assign]


def without_dovetailing() -> None:
    """Another structure has a turn when those before it have none."""
    from solvers.search.search_queue import SearchQueue

    SearchQueue.wants_another = lambda self: not self.under_way  # type: ignore[method-assign]


def without_polishing() -> None:
    """What was evaluated is not refined with its parameters as unknowns."""
    from solvers.search.configuration_search import _Survey

    def polished(self: _Survey, _: object) -> list[Any]:
        return self.attempts if self.space.is_point else self.basins()

    _Survey.polished = polished  # type: ignore[method-assign]


PARTS: dict[str, Callable[[], None] | None] = {
    "cores": without_cores,
    "lemmas": None,
    "feedback": without_feedback,
    "dovetailing": without_dovetailing,
    "polishing": without_polishing,
}
"""By name; None where an option of `srgc synth` does it."""


def synth(parts: Sequence[str], arguments: Sequence[str]) -> int:
    """The exit status of `srgc synth` without these parts."""
    from srgc.cli import run
    from srgc.time_limit import TimeLimit

    # A busy machine takes nothing from the limit.
    TimeLimit.passed = property(lambda _: time.process_time())  # type: ignore[assignment, method-assign]
    for part in parts:
        switch_off = PARTS[part]
        if switch_off is not None:
            switch_off()
    options = ["--no-lemmas"] if "lemmas" in parts else []
    return run(["synth", *arguments, *options])


def main() -> None:
    parts = [part for part in sys.argv[1].split(",") if part != "nothing"]
    if unknown := [part for part in parts if part not in PARTS]:
        sys.exit(f"no part: {', '.join(unknown)}; there are {', '.join(PARTS)} and nothing")
    sys.exit(synth(parts, sys.argv[2:]))


if __name__ == "__main__":
    main()
