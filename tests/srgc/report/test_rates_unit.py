"""The unit of what is said of all joints of a robot at once."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from compiler.robots.state_and_input import rates_unit
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status
from srgc.report.proof import _row


@pytest.mark.parametrize(
    ("kinds", "unit", "shown"),
    [
        (("revolute", "revolute"), "rad/s", "0.05 rad/s"),
        (("prismatic",), "m/s", "0.05 m/s"),
        (("revolute", "prismatic"), "SI", "0.05 (SI)"),
    ],
)
def test_only_joints_of_both_kinds_have_no_unit(
    kinds: tuple[str, ...], unit: str, shown: str
) -> None:
    """The report spells it as the verifier does."""
    model: Any = SimpleNamespace(dofs=[SimpleNamespace(kind=kind) for kind in kinds])
    assert rates_unit(model) == unit
    held = CheckedCondition("rates at the end", Status.HOLDS, 0.05, unit, 1.0)
    assert f">{shown}<" in _row(held, [held])
