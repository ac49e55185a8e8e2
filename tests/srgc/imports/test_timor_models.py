"""Imported module sets against Timor itself: what fits, kinematics, inverse dynamics, limits."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

import pytest

from tests.oracles.random_module_sets import joints_of, module_set
from tests.oracles.timor_sets import (
    Assembly,
    Imported,
    agree,
    ask,
    blocks,
    limits_of,
    names_by_id,
    needs_timor,
    ports_of,
    states,
)

pytestmark = [pytest.mark.slow, needs_timor]
TOLERANCE, OF_RANDOM_SETS = 1e-9, 1e-8
"""Lengths and angles are written with twelve decimals; of random sets all have that many."""
ASSEMBLIES, OF_RANDOM_SET = 30, 10
COMPLEMENT = {"male": "female", "female": "male", None: None}


def connectors(module: dict[str, Any]) -> list[dict[str, Any]]:
    return [each for body in module["bodies"] for each in body["connectors"]]


def has(module: dict[str, Any], kind: str) -> bool:
    return any(each["type"] == kind for each in connectors(module))


def rows(
    modules: list[dict[str, Any]], names: dict[str, str], seed: int, count: int
) -> list[Assembly]:
    """Random rows of modules with 2 to 6 joints, from a base to an effector."""
    rng = random.Random(seed)
    by_id = {each["header"]["ID"]: each for each in modules}
    bases = [name for name, each in by_id.items() if has(each, "base")]
    tools = [name for name, each in by_id.items() if has(each, "eef")]
    others = [name for name in by_id if name not in (*bases, *tools)]
    found = list[Assembly]()
    while len(found) < count:
        ids = [rng.choice(bases), *(rng.choice(others) for _ in range(rng.randrange(2, 9)))]
        ids.append(rng.choice(tools))
        dofs = sum(joints_of(by_id[name]) for name in ids)
        if 2 <= dofs <= 6:
            word = tuple(names[name] for name in ids)
            found.append(Assembly(tuple(ids), word, states(rng, 3, dofs)))
    return found


def same_models(
    imported: Imported, file: Path, given: list[Assembly], tolerance: float = TOLERANCE
) -> Any:
    """All rows agree; what Timor said."""
    answer = ask({"set": str(file), "assemblies": [each.question() for each in given]})
    for assembly, robot in zip(given, answer["robots"], strict=True):
        agree(imported.graph(assembly.word), robot, assembly, tolerance)
    return answer


@pytest.mark.parametrize("name", ["IMPROV", "geometric_primitive_modules"])
def test_shipped_sets(name: str, tmp_path: Path) -> None:
    file = Path(ask({})[name])
    modules = json.loads(file.read_text(encoding="utf-8"))["modules"]
    imported = Imported(file, tmp_path)
    assert list(imported.checked) == []
    assert set(names_by_id(imported.text)) == {each["header"]["ID"] for each in modules}
    given = rows(modules, names_by_id(imported.text), 20, ASSEMBLIES)
    answer = same_models(imported, file, given)
    same_pairs(imported, modules, answer["pairs"])
    same_limits(imported, answer["limits"])


def same_pairs(imported: Imported, modules: list[dict[str, Any]], pairs: list[list[str]]) -> None:
    """Outputs and inputs that fit are the connectors that fit.

    In the sets that come with Timor each module has one female end, and male ones elsewhere.
    """
    names = names_by_id(imported.text)
    genders = {
        (each["header"]["ID"], end["ID"]): end["gender"]
        for each in modules
        for end in connectors(each)
    }
    theirs = sorted(
        (names[one], names[other]) for one, mine, other, _ in pairs if genders[one, mine] == "m"
    )
    ports = {name: ports_of(block) for name, block in blocks(imported.text).items()}
    ours = sorted(
        (one, other)
        for one, mine in ports.items()
        for other, theirs_ in ports.items()
        for port, (kind, gender) in mine.items()
        if port != "in" and theirs_["in"] == (kind, COMPLEMENT[gender])
    )
    assert ours == theirs
    assert len(pairs) == 2 * len(theirs)


def same_limits(imported: Imported, limits: list[list[Any]]) -> None:
    """Each joint has the limits, the rotor and the friction that Timor has."""
    names = names_by_id(imported.text)
    theirs = dict[str, list[list[float]]]()
    for module, _, _, *values in limits:
        theirs.setdefault(names[module], []).append(values)
    ours = {name: limits_of(block) for name, block in blocks(imported.text).items()}
    assert {name for name, found in ours.items() if found} == set(theirs)
    for name, found in theirs.items():
        assert len(found) == len(ours[name])
        for one, other in zip(sorted(found), sorted(ours[name]), strict=True):
            assert one == pytest.approx(other, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("seed", range(6))
def test_random_sets(seed: int, tmp_path: Path) -> None:
    described = module_set(seed)
    file = tmp_path / "modules.json"
    file.write_text(json.dumps(described), encoding="utf-8")
    imported = Imported(file, tmp_path)
    assert list(imported.checked) == []
    given = rows(described["modules"], names_by_id(imported.text), seed, OF_RANDOM_SET)
    same_models(imported, file, given, OF_RANDOM_SETS)


@pytest.mark.parametrize("seed", range(4))
def test_modules_mounted_either_way(seed: int, tmp_path: Path) -> None:
    """A module for each end; from the child's side Timor's angle has the other sign."""
    described = module_set(seed, "h", "h")
    file = tmp_path / "modules.json"
    file.write_text(json.dumps(described), encoding="utf-8")
    imported = Imported(file, tmp_path)
    by_id = {each["header"]["ID"]: each for each in described["modules"]}
    others = [name for name in by_id if name not in ("base", "tool")]
    rng, given = random.Random(seed), list[Assembly]()
    while len(given) < OF_RANDOM_SET:
        middle = [(rng.choice(others), rng.random() < 0.5) for _ in range(rng.randrange(2, 6))]
        counts = [joints_of(by_id[name]) for name, _ in middle]
        if not 2 <= sum(counts) <= 6:
            continue
        ends = [
            ("ground", "far"),
            *(("far", "near") if turned else ("near", "far") for _, turned in middle),
        ]
        ends.append(("near", "tip"))
        ids = ["base", *(name for name, _ in middle), "tool"]
        word = [
            "Base",
            *(f"{name.capitalize()}_{'far' if turned else 'near'}" for name, turned in middle),
            "Tool",
        ]
        signs = [
            -1 if turned else 1
            for (_, turned), n in zip(middle, counts, strict=True)
            for _ in range(n)
        ]
        given.append(
            Assembly(
                tuple(ids), tuple(word), states(rng, 3, sum(counts)), tuple(ends), tuple(signs)
            )
        )
    same_models(imported, file, given, OF_RANDOM_SETS)
