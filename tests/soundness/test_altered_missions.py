"""Results of missions altered in every way that is thought of: none is accepted but what is true.

Whether an altered claim is true, and its evidence shows it, is said by `judged_missions.py`, which
uses no code of the project; digests are made anew.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

from solvers.verifier.missions.mission_check import verify_mission
from solvers.verifier.report import Outcome
from srgc.cli import run
from tests.oracles.mission_families import MissionFamily
from tests.oracles.result_files import digest, read, write
from tests.solvers.test_missions import arms
from tests.soundness.altered_missions import CLAIM, Altered, alterations, at, changed, deep
from tests.soundness.judged_missions import Content, Judge

pytestmark = pytest.mark.usefixtures("without_pictures")

SEEDS = (25, 91, 11, 31, 35, 49, 55, 65, 85, 89, 20, 9)
"""Both kinds, found and impossible, with boxes and without, with `from`, free lengths, a bound."""
CONTINUOUS = 52
"""A result with boxes of lengths from intervals."""
FEW, MANY = 8, 60
"""So many of one result in the usual suite, and in `make test-slow`."""


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], Path]:
    """Results by the seed of their family, each made once and without lemmas."""
    base = tmp_path_factory.mktemp("missions")

    def get(seed: int) -> Path:
        folder = base / f"out{seed}"
        if not folder.exists():
            spec = base / f"mission{seed}.srg"
            spec.write_text(MissionFamily(seed).text, encoding="utf-8")
            asked = ["synth", str(spec), "--mission", "M", "-o", str(folder), "-q", "--no-lemmas"]
            assert run(asked) in (0, 3)
        return folder

    return get


def check(judge: Judge, folder: Path, target: Path, altered: Altered) -> str:
    """Whether the verifier says of an altered result what is true."""
    shutil.copytree(folder, target)
    altered.change(target)
    due = altered.accepted
    if due == "judged":
        due = judge.accepted(target)
    report = verify_mission(target).report
    shutil.rmtree(target)
    valid = report.outcome is Outcome.VALID
    assert due is None or valid is due, (altered.name, due, report.outcome, report.reason)
    if due is None and valid:
        # Evidence was altered, or written in another way; what is claimed stayed as it was.
        return "either, accepted"
    return f"{due}"


@pytest.mark.parametrize("seed", SEEDS[:2])
def test_some_altered_missions(seed: int, folders: Callable[[int], Path], tmp_path: Path) -> None:
    folder = folders(seed)
    judge = Judge(MissionFamily(seed), read(folder, CLAIM))
    assert verify_mission(folder).report.outcome is Outcome.VALID
    assert judge.accepted(folder) is True
    every = alterations(folder)
    for altered in every[:: len(every) // FEW]:
        check(judge, folder, tmp_path / "altered", altered)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_all_altered_missions(
    seed: int,
    folders: Callable[[int], Path],
    tmp_path: Path,
    record_property: Callable[[str, object], None],
) -> None:
    folder = folders(seed)
    judge = Judge(MissionFamily(seed), read(folder, CLAIM))
    assert verify_mission(folder).report.outcome is Outcome.VALID
    assert judge.accepted(folder) is True
    every = alterations(folder)
    some = every[:: -(-len(every) // MANY)]
    said = [check(judge, folder, tmp_path / "altered", each) for each in some]
    record_property("alterations", {each: said.count(each) for each in set(said)})


@pytest.mark.parametrize("depth", [20, 150, 320, 480])
def test_boxes_that_are_cut_very_often(
    depth: int, folders: Callable[[int], Path], tmp_path: Path
) -> None:
    """A tree that is nested as deeply as JSON allows ends no verifier."""
    target = tmp_path / "deep"
    shutil.copytree(folders(CONTINUOUS), target)
    content = read(target, CLAIM)
    (first, *_) = content["boxes"]
    chosen = [k for k in MissionFamily(CONTINUOUS).kinds.values() if k.is_chosen]
    try:
        first["tree"] = json.loads(deep(chosen[0].lengths[0], chosen[0].lengths[-1], depth))
        content["digest"] = digest(content)
        write(target, content, CLAIM)
    except RecursionError:
        return
    assert verify_mission(target).report.outcome is Outcome.REFUTED


def test_a_claim_is_json(folders: Callable[[int], Path], tmp_path: Path) -> None:
    """Constants that are no JSON, and numbers that Python reads and cannot write."""
    target = tmp_path / "other"
    shutil.copytree(folders(SEEDS[0]), target)
    text = (target / CLAIM).read_text(encoding="utf-8")
    cost = json.dumps(read(target, CLAIM)["cost"])
    for other in ("NaN", "Infinity", "1" * 5000, '"\\ud800"'):
        (target / CLAIM).write_text(text.replace(f'"cost": {cost}', f'"cost": {other}'))
        assert verify_mission(target).report.outcome is not Outcome.VALID


FREE = {"": "2", "free L.length;": "0", "free L.length; ": "0.5"}
"""What may change, and the cost of a length that differs; blanks tell two of them apart."""


@pytest.mark.parametrize("free", FREE)
def test_a_length_that_is_hardly_another_one(free: str, tmp_path: Path) -> None:
    """A kept module whose length differs by a micrometre is changed, or exchanged."""
    prices = "reconfigure" + (", change 0.5" if FREE[free] == "0.5" else "")
    clauses = f"{prices.replace('reconfigure,', 'reconfigure')}; {free} minimize changes;"
    spec, folder = tmp_path / "arms.srg", tmp_path / "out"
    text = arms(clauses, "0.8", "0.8", lengths="[0.5, 1.2]", others="{0.3}")
    spec.write_text(text, encoding="utf-8")
    assert run(["synth", str(spec), "--mission", "M", "-o", str(folder), "-q"]) == 0
    assert read(folder, CLAIM)["cost"] == "0"

    def shift(content: Content) -> None:
        (length,) = content["parameters"]
        inner = 1 if Fraction(length["value"]) < Fraction(4, 5) else -1
        length["value"] = str(float(Fraction(length["value"]) + inner * Fraction(1, 10**6)))

    changed(folder / "tasks" / "B", shift, "certificate.json")
    (folder / "tasks" / "B" / "design.json").unlink()
    for cost in ("0", "0.5", "1", "2"):
        at("cost", to=cost)(folder)
        report = verify_mission(folder).report
        assert (report.outcome is Outcome.VALID) is (cost == FREE[free]), (cost, report.reason)
