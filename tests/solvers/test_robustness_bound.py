"""Bounds on what any design may keep of its inputs, against least forces by hand."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from shutil import copytree
from typing import Any

import pytest

from compiler.time_limits.time_limit import OutOfTimeError
from grammar_lang.load import load_text
from solvers.run_context import RunContext
from solvers.search import family_search
from solvers.search.path_task import robustness_share
from solvers.search.synthesis import OUT_OF_TIME, Synthesis, synthesise
from solvers.verifier.claims.certificate import CertificateError, from_text
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.altered_claims import claimed, judged
from tests.oracles.result_files import alter, digest, read, spec_digest
from tests.oracles.slides import least_force, slides
from tests.solvers.test_weights_lemmas import SPEC as WEAK
from tests.solvers.test_weights_lemmas import replaced

ANY = Fraction(1000)
"""A gap that the first design with a bound closes."""
LOOSE = 3e-3
"""So far above the least force are the bounds of one slide at most, as parts of the effort."""


def searched(text: str, gap: Fraction = Fraction(1, 100), **context: Any) -> Synthesis:
    program = load_text(text, "spec.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    return synthesise(program, task, RunContext(**context), gap=gap)


def share_of(result: Synthesis, text: str) -> float:
    program = load_text(text, "spec.srg").program
    assert program is not None
    assert result.design is not None
    share = robustness_share(result.design, program.tasks["Go"])
    assert share is not None
    return share


@pytest.mark.parametrize(
    ("masses", "lightest", "goal", "way", "steps", "end"),
    [
        ("const mass = 2 kg", 2.0, "1.1, 1.4", 0.8, 20, "at rest"),
        ("param mass in [2, 3] kg", 2.0, "1.1, 1.4", 0.8, 20, "at rest"),
        ("param mass in [0.5, 3] kg", 0.5, "0.7, 0.9", 0.4, 12, "at rest"),
        ("const mass = 2 kg", 2.0, "1.1, 1.4", 0.8, 20, ""),
        ("const mass = 10 kg", 10.0, "1.1, 1.4", 0.8, 20, "at rest"),
    ],
)
def test_one_slide(
    masses: str, lightest: float, goal: str, way: float, steps: int, end: str
) -> None:
    """The bound is never below what the least force leaves, and hardly above it."""
    text = slides(masses, goal=goal, steps=steps, end=end)
    result = searched(text, Fraction(1, 20))
    best = 1 - least_force(lightest, way, steps / 10, stops=bool(end)) / 20
    assert result.bound is not None
    assert best <= float(result.bound.share) <= best + LOOSE
    assert share_of(result, text) <= best
    assert result.bound.evidence.modules == 3


def test_bounds_of_modules_and_joints() -> None:
    """An effort of its own that a joint has, a finite language, and an infinite one."""
    own = slides("const mass = 2 kg", travel="[0, 2] m effort <= 10 N", effort="", modules="")
    result = searched(own)
    assert result.bound is not None
    assert result.bound.evidence.modules is None
    assert result.bound.share >= 1 - Fraction("0.1601")
    assert result.bound.share <= 1 - Fraction("0.157")
    endless = replaced(own, "e (Slide) e", "(e Base)* e Slide e")
    endless = replaced(endless, "base: P -> Base;", "base: P -> Base; more: P -> P e Base;")
    endless = replaced(endless, "base { this", "more { this.at = P.at; } base { this")
    result = searched(endless, ANY)
    assert result.bound is not None
    assert result.bound.evidence.modules == 12
    assert len(result.bound.evidence.records) == 10


def test_the_first_one_is_less_robust() -> None:
    text = slides("const mass = 4 kg; const mass = 2 kg", kinds="Slow Fast", modules="")
    best = {kind: 1 - least_force(mass, 0.8, 2, stops=True) / 20 for kind, mass in MASSES.items()}
    wide, narrow = searched(text, Fraction(1, 10)), searched(text)
    for result, kind in ((wide, "Slow"), (narrow, "Fast")):
        assert result.design is not None
        assert result.design.derivation.word == ("Base", "e", kind, "e", "Hand")
        assert result.bound is not None
        assert best["Fast"] <= float(result.bound.share) <= best["Fast"] + LOOSE
        assert share_of(result, text) <= best[kind]
    assert (len(wide.records), len(narrow.records)) == (1, 2)
    assert len(narrow.designs) == 1


MASSES = {"Slow": 4, "Fast": 2}


def test_nothing_is_said_where_nothing_is_proved() -> None:
    """Coverings need a range; so there is no bound, and all structures are tried."""
    result = searched(slides("const mass = 2 kg", travel=""))
    assert result.verdict == "found"
    assert result.bound is None
    assert (
        result.unbounded == "no share is shown to be too much for the drives of Base e Slide e Hand"
    )


def test_out_of_time(monkeypatch: pytest.MonkeyPatch) -> None:
    def late(*_: object) -> None:
        raise OutOfTimeError

    monkeypatch.setattr(family_search, "robustness_bound", late)
    result = searched(slides("const mass = 2 kg"))
    assert (result.verdict, result.unfinished) == ("found", True)
    assert (result.bound, result.unbounded) == (None, OUT_OF_TIME)


def test_one_lemma_is_about_all_with_weights(tmp_path: Path) -> None:
    (tmp_path / "weak.srg").write_text(replaced(WEAK, "<= 0.5 N", "<= 12 N"), encoding="utf-8")
    out = tmp_path / "out"
    assert run(["synth", str(tmp_path / "weak.srg"), "-o", str(out), "-q", "--gap", "5%"]) == 0
    bound = claimed(read(out), "bound")
    assert [lemma["argument"] for lemma in bound["lemmas"]] == ["weights"]
    assert verify_directory(out).outcome is Outcome.VALID


@pytest.fixture(scope="module")
def bounded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("slides")
    text = slides("const mass = 4 kg; const mass = 2 kg", kinds="Slow Fast")
    (folder / "slides.srg").write_text(text, encoding="utf-8")
    command = ["synth", str(folder / "slides.srg"), "-o", str(folder / "out"), "-q", "--gap", "20"]
    assert run(command) == 0
    return folder / "out"


def copied(folder: Path, scratch: Path) -> Path:
    return copytree(folder, scratch / "copy")


def test_it_is_verified(bounded: Path) -> None:
    report = verify_directory(bounded)
    assert report.outcome is Outcome.VALID
    share = read(bounded, "design.json")["bound"]["share"]
    assert [c.name for c in report.conditions][-1] == (
        f"no robot of at most 3 modules has more than {100 * share:g} %"
    )


def set_to(**fields: object) -> Callable[[dict[str, Any]], None]:
    return lambda content: claimed(content, "bound").update(fields)


def no_second(content: dict[str, Any]) -> None:
    claimed(content, "bound")["structures"].pop()


def other_evidence(content: dict[str, Any]) -> None:
    first, second = claimed(content, "bound")["structures"]
    second["boxes"] = "spec/slides.srg"
    assert first["boxes"] != second["boxes"]


def no_evidence(content: dict[str, Any]) -> None:
    claimed(content, "bound")["structures"][1]["boxes"] = None


def all_the_same(content: dict[str, Any]) -> None:
    first, second = claimed(content, "bound")["structures"]
    second.update(same_robot_as=0, boxes=first["boxes"])


FALSE = [
    (set_to(share="0.91"), "does not refute structure 1"),
    (set_to(share="0.85"), "does not refute structure"),
    (set_to(share="1"), "malformed"),
    (set_to(share="-0.5"), "malformed"),
    (set_to(share="0.9x"), "malformed"),
    (set_to(modules=2), "the bound on modules is not the task's"),
    (set_to(modules=4), "the bound on modules is not the task's"),
    (set_to(modules=None), "the bound on modules is not the task's"),
    (set_to(structures=[]), "structure 0 is missing"),
    (set_to(lemmas=[{}]), "malformed"),
    (no_second, "structure 1 is missing"),
    (other_evidence, "no covering|not ASCII|does not refute"),
    (no_evidence, "structure 1 has no evidence"),
    (all_the_same, "not the same robot"),
]


@pytest.mark.parametrize(("change", "said"), FALSE)
def test_a_false_bound_is_refused(
    bounded: Path, tmp_path: Path, change: Callable[[dict[str, Any]], None], said: str
) -> None:
    outcome, reason = judged(copied(bounded, tmp_path), change)
    assert outcome is Outcome.REFUTED
    assert re.search(said, reason), reason


def test_two_bounds_are_malformed(bounded: Path) -> None:
    content = read(bounded)
    content["claims"] = content["claims"] * 2
    content["digest"] = digest(content)
    with pytest.raises(CertificateError, match="more than one bound"):
        from_text(json.dumps(content))


def test_design_json_says_the_same(bounded: Path, tmp_path: Path) -> None:
    folder = copied(bounded, tmp_path)
    for bound in (None, {"share": 0.9, "modules": 3, "gap": 0.01}):
        design = read(bounded, "design.json") | {"bound": bound}
        (folder / "design.json").write_text(json.dumps(design), encoding="utf-8")
        report = verify_directory(folder)
        assert report.outcome is Outcome.REFUTED
        assert report.reason == "design.json and certificate.json differ in `bound`"


def test_a_larger_family(bounded: Path, tmp_path: Path) -> None:
    """A lighter slide in the spec is one more structure, or another robot."""
    folder = copied(bounded, tmp_path)
    (spec,) = (folder / "spec").iterdir()
    text = replaced(spec.read_text(encoding="utf-8"), "mass = 2 kg", "mass = 1 kg")
    spec.write_text(text, encoding="utf-8")
    value = spec_digest({spec.name: spec.read_bytes()})
    alter(folder, lambda content: content.update(spec_sha256=value), sign=True)
    (folder / "design.json").unlink()
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "does not refute structure 1" in (report.reason or "")


def test_without_the_coverings(bounded: Path, tmp_path: Path) -> None:
    folder = copied(bounded, tmp_path)
    (folder / "proofs" / "bound" / "0001.boxes").unlink()
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "is missing" in (report.reason or "")
