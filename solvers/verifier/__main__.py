"""``python -m solvers.verifier DIR``: the verifier without the rest of the command line."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from grammar_lang.files.file_tree import visible
from solvers.verifier.verification import Outcome, verify_directory


def main(arguments: Sequence[str]) -> int:
    """Verify the given folder; return 0 if valid, 1 if refuted, 4 otherwise, 2 on wrong usage."""
    if len(arguments) != 1 or arguments[0].startswith("-"):
        sys.stderr.write("usage: python -m solvers.verifier DIR\n")
        return 2
    report = verify_directory(Path(arguments[0]))
    claimed = "" if report.task is None else f": {report.verdict}, task {report.task}"
    digest = "" if report.spec_sha256 is None else f", spec {report.spec_sha256}"
    reason = "" if report.reason is None else f": {report.reason}"
    sys.stdout.write(visible(f"{report.outcome.value}{claimed}{digest}{reason}") + "\n")
    return {Outcome.VALID: 0, Outcome.REFUTED: 1}.get(report.outcome, 4)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
