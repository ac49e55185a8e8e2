"""The error about a result without a robot."""

from __future__ import annotations

from pathlib import Path

from grammar_lang.diagnostics.diagnostic import Code
from srgc.faults import UsageFault


def no_robot(folder: Path, verdict: object) -> UsageFault:
    """The error about a result that has no robot, with its code.

    Args:
        folder: the folder of the result.
        verdict: the verdict of the result, which is not *found*.
    """
    return UsageFault(
        f"{folder} has no robot: its verdict is {verdict}",
        code=Code.NO_ROBOT,
        hint=f"`srgc why {folder}` says why",
    )
