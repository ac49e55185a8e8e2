"""`srgc synth` as a process, with the processor times at which motions and designs were there.

Its limit of time is one of processor time here.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path


def main() -> int:
    """Arguments: the file for the times, then those of `srgc synth`."""
    from solvers.search.search_queue import StructureUnderWay
    from srgc.cli import run
    from srgc.time_limit import TimeLimit

    # A busy machine takes nothing from the limit.
    TimeLimit.passed = property(lambda _: time.process_time())  # type: ignore[assignment, method-assign]
    at = dict[str, float]()
    see, keep = StructureUnderWay.see, StructureUnderWay.keep

    def seen(self: StructureUnderWay, motion: object) -> None:
        if getattr(motion, "feasible", False):
            at.setdefault("motion", time.process_time())
        see(self, motion)  # type: ignore[arg-type]

    def kept(self: StructureUnderWay, design: object) -> None:
        at.setdefault("design", time.process_time())
        keep(self, design)  # type: ignore[arg-type]

    StructureUnderWay.see, StructureUnderWay.keep = seen, kept  # type: ignore[method-assign]
    at["loaded"] = time.process_time()
    status = run(["synth", *sys.argv[2:]])
    at["end"] = time.process_time()
    Path(sys.argv[1]).write_text(json.dumps({"status": status, **at}), encoding="utf-8")
    return status


if __name__ == "__main__":
    sys.exit(main())
