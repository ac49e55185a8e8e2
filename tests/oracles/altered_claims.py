"""Claims of a certificate, altered and judged."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.result_files import alter

Content = dict[str, Any]
Change = Callable[[Content], None]


def claimed(content: Content, kind: str) -> Content:
    """The only claim of a kind in a certificate."""
    (found,) = [item for item in content["claims"] if item["kind"] == kind]
    assert isinstance(found, dict)
    return found


def judged(folder: Path, change: Change) -> tuple[Outcome, str]:
    """What the verifier says of a folder whose certificate is changed, and why."""
    alter(folder, change, sign=True)
    report = verify_directory(folder)
    return report.outcome, report.reason or ""
