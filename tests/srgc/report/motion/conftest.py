from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from srgc.report.evidence import Evidence
from srgc.report.evidence_reader import read_evidence


@pytest.fixture(scope="session")
def evidence_on(made: Callable[[str], Path]) -> Callable[[str], Evidence]:
    """The evidence on the result of a spec, with the tube."""
    known: dict[str, Evidence] = {}

    def get(spec: str) -> Evidence:
        if spec not in known:
            known[spec] = read_evidence(made(spec) / "out", verify=True)
        return known[spec]

    return get
