"""What is said of a result without a robot where one is due."""

from __future__ import annotations

from pathlib import Path

from grammar_lang.diagnostics.diagnostic import Code
from srgc.faults import UsageFault


def no_robot(folder: Path, verdict: object) -> UsageFault:
    """The fault, with its code.

    Args:
        folder: that of the result.
        verdict: what the result says instead of *found*.
    """
    return UsageFault(
        f"{folder} has no robot: its verdict is {verdict}",
        code=Code.NO_ROBOT,
        hint=f"`srgc why {folder}` says why",
    )
