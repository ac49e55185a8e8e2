"""Random small families judged with lemmas, structure by structure, and by random poses."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.small_families import SmallFamily, is_beyond, is_reached
from tests.oracles.some_cases import campaign

pytestmark = pytest.mark.usefixtures("without_pictures")

VERDICTS = {0: "found", 3: "impossible", 4: "unknown"}
QUICK = ("--paths", "1", "--evaluations", "2")
"""A search with little patience: what it does not find is unknown, and contradicts nothing."""
POSES = 3000
BLOCK = 10
FEW = (1, 6, 7, 9, 12, 15, 19, 22, 23, 28, 33, 38)


def verdict(spec: Path, folder: Path, *options: str) -> str:
    """Of a synthesis, whose claim has to be valid."""
    status = run(["synth", str(spec), "-o", str(folder), "-q", *QUICK, *options])
    if status != 4:
        assert verify_directory(folder).outcome is Outcome.VALID, spec.name
    return VERDICTS[status]


def check(seed: int, scratch: Path) -> Counter[str]:
    """All ways of judging a family agree; what each says, to be counted."""
    family = SmallFamily(seed)
    spec = scratch / f"family{seed}.srg"
    spec.write_text(family.text, encoding="utf-8")
    learnt = verdict(spec, scratch / f"learnt{seed}")
    alone = verdict(spec, scratch / f"alone{seed}", "--no-lemmas")
    reached = is_reached(family, POSES, seed)
    beyond = is_beyond(family)
    said = {learnt, alone} - {"unknown"}
    assert len(said) < 2, (seed, learnt, alone)
    if reached:
        assert "impossible" not in said, (seed, "poses reach the target")
    if beyond:
        assert "found" not in said, (seed, "the lengths do not reach the target")
    return Counter({
        f"{learnt}, one by one {alone}": 1,
        f"{learnt} with lemmas": int(learns(scratch / f"learnt{seed}")),
        "reached by random poses": int(reached),
        "beyond by lengths": int(beyond),
    })  # fmt: skip


def learns(folder: Path) -> bool:
    """Whether a synthesis has passed over robots by lemmas."""
    return bool(json.loads((folder / "design.json").read_text(encoding="utf-8")).get("lemmas"))


def test_the_few_are_of_all_kinds() -> None:
    families = [SmallFamily(seed) for seed in FEW]
    judged = {(is_reached(f, POSES, f.seed), is_beyond(f)) for f in families}
    assert judged == {(True, False), (False, True), (False, False)}
    assert {f.style for f in families} == {"above", "below", "branches"}
    assert any(f.twin for f in families)
    assert any(f.plane for f in families)
    assert not all(f.plane for f in families)


@pytest.mark.parametrize("seed", FEW)
def test_a_small_family(seed: int, tmp_path: Path) -> None:
    check(seed, tmp_path)


@pytest.mark.parametrize("block", campaign(range(30), 8))
def test_three_hundred_small_families(
    block: int, tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    seen: Counter[str] = Counter()
    for seed in range(BLOCK * block, BLOCK * block + BLOCK):
        seen += check(seed, tmp_path)
    record_property("verdicts", dict(seen))
