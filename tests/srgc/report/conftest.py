from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from srgc.cli import run
from srgc.report.evidence import Evidence, read_evidence
from tests.oracles import result_files
from tests.oracles.html_page import Page
from tests.oracles.small_specs import TURNER, replaced

HOSTILE = "</script><script>alert(1)</script><!-- ]]> &lt; \u202e"
WEAK = replaced(TURNER, "effort <= 10 N*m", "modules <= 4; effort <= 0.32 N*m")
"""Drives that are far too weak: motions are searched, without success."""


def page_of(folder: Path, *options: str) -> Page:
    """The report of a folder, read strictly."""
    assert run(["report", str(folder), *options]) == 0
    return Page((folder / "report.html").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def pages(
    made: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], tuple[Path, Page]]:
    """A copy of the folder of a spec with its report, read only."""
    known: dict[str, tuple[Path, Page]] = {}

    def get(spec: str) -> tuple[Path, Page]:
        if spec not in known:
            folder = tmp_path_factory.mktemp("reported") / spec
            shutil.copytree(made(spec) / "out", folder)
            known[spec] = folder, page_of(folder)
        return known[spec]

    return get


@pytest.fixture(scope="session")
def weak(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Page]:
    """A folder with counterexamples, and its report."""
    place = tmp_path_factory.mktemp("weak")
    (place / "weak.srg").write_text(WEAK, encoding="utf-8")
    few = ["--paths", "1", "--evaluations", "4"]
    assert run(["synth", str(place / "weak.srg"), "-o", str(place / "out"), "-q", *few]) == 3
    return place / "out", page_of(place / "out")


@pytest.fixture(scope="session")
def unknown(weak: tuple[Path, Page], tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Page]:
    """The same after a search that left one robot open, for a reason that is no HTML."""
    folder = tmp_path_factory.mktemp("unknown") / "out"
    shutil.copytree(weak[0], folder)
    (folder / "certificate.json").unlink()
    design = result_files.read(folder, "design.json")
    last = next(s for s in reversed(design["structures_tried"]) if s["same_robot_as"] is None)
    last.update(verdict="unresolved", evidence=HOSTILE, reason=HOSTILE, boxes=None)
    number = design["structures_tried"].index(last)
    for one in design["structures_tried"]:
        if one["same_robot_as"] == number:
            one.update(verdict="unresolved", evidence=HOSTILE, reason=HOSTILE, boxes=None)
    result_files.write(folder, design | {"verdict": "unknown", "reason": HOSTILE}, "design.json")
    return folder, page_of(folder)


@pytest.fixture(scope="session")
def evidence_on(made: Callable[[str], Path]) -> Callable[[str], Evidence]:
    """The evidence on the result of a spec, with the tube."""
    known: dict[str, Evidence] = {}

    def get(spec: str) -> Evidence:
        if spec not in known:
            known[spec] = read_evidence(made(spec) / "out", verify=True)
        return known[spec]

    return get
