"""``python -m solvers.verifier DIR``: the verifier without the rest of the command line."""

from __future__ import annotations

import sys
from pathlib import Path

from solvers.verifier.verification import Outcome, verify_directory


def main() -> int:
    """Verify the folder that the only argument names; 0 valid, 1 refuted, 4 undecided."""
    report = verify_directory(Path(sys.argv[1]))
    sys.stdout.write(f"{report.outcome.value}{': ' + report.reason if report.reason else ''}\n")
    return {Outcome.VALID: 0, Outcome.REFUTED: 1}.get(report.outcome, 4)


if __name__ == "__main__":
    sys.exit(main())
