"""``srgc evolve``: from the robot of a result to a task, and what is not to be believed of that."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from solvers.verifier.claims.certificate import digest_of
from tests.srgc.conftest import Ran

Run = Callable[..., Ran]

LIMBS = """\
module Base { role base; port out: Socket; frame out = in; }
module Limb { role link; dof q: revolute z in [-150, 150] deg; param length in [0.5, 1.5] m;
              port in: Socket; frame joint = in * rot(z, q);
              port out: Socket; frame out = joint * move(x, length);
              rod(frame: joint, axis: x, length: length, density: 1 kg/m); }
module Hand { role effector; port in: Socket; effector(frame: in); }

grammar Arm from ports { start Base; with Limb, Hand; }

workspace Bench {
  plane xy;  bounds box [-2, 2] x [-2, 2] m;
  region Tray box [0.8, 1] x [-0.2, 0.1] m;
  target Box box [-0.1, 0.2] x [0.8, 1] m;
}

task Pack {
  robot Arm;  workspace Bench;
  start in Tray;  reach Box;
  effort <= 10 N*m;  horizon 10 steps of 0.2 s;  modules <= 3;
}
"""


@pytest.fixture(scope="module")
def packed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """``out`` of the task, by an arm of one limb of 0.78 to 1.02 m; beside it the spec."""
    from srgc.cli import run

    place = tmp_path_factory.mktemp("limbs")
    (place / "limbs.srg").write_text(LIMBS, encoding="utf-8")
    assert run(["synth", str(place / "limbs.srg"), "-o", str(place / "out"), "-q"]) == 0
    return place


def evolved(srgc: Run, packed: Path, place: Path, text: str, *options: object) -> Ran:
    """One step to the task as a text says it."""
    spec = place / "next.srg"
    spec.write_text(text, encoding="utf-8")
    return srgc("evolve", packed / "out", spec, "-o", place / "next", "-q", *options)


def read(place: Path, name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((place / name).read_text(encoding="utf-8"))
    return found


def test_a_limb_that_may_not_stay_is_exchanged(packed: Path, srgc: Run, tmp_path: Path) -> None:
    """Limbs have 1.1 m at least, the old one less; the far tray asks for such a one."""
    text = LIMBS.replace("[0.5, 1.5] m", "[1.1, 1.5] m").replace("[0.8, 1] x", "[1.1, 1.3] x")
    text = text.replace("[-0.1, 0.2] x [0.8, 1] m", "[-0.1, 0.2] x [1.1, 1.3] m")
    assert evolved(srgc, packed, tmp_path, text, "--add", "2", "--remove", "1/2").status == 0
    design = read(tmp_path / "next", "design.json")
    assert design["cost"] == design["least"] == 2.5
    ran = srgc("verify", tmp_path / "next")
    assert ran.status == 0
    assert "from Base Limb Hand of history/1: add 2, remove 0.5" in ran.out


def test_a_parameter_that_may_change_does(packed: Path, srgc: Run, tmp_path: Path) -> None:
    text = LIMBS.replace("[0.5, 1.5] m", "[1.1, 1.5] m").replace("[0.8, 1] x", "[1.1, 1.3] x")
    text = text.replace("[-0.1, 0.2] x [0.8, 1] m", "[-0.1, 0.2] x [1.1, 1.3] m")
    ran = evolved(srgc, packed, tmp_path, text, "--free", "Limb.length", "--change", "0.25")
    assert ran.status == 0
    design = read(tmp_path / "next", "design.json")
    assert design["cost"] == design["least"] == 0.25
    assert srgc("verify", tmp_path / "next").status == 0


def test_another_module_of_the_name_is_refused(packed: Path, srgc: Run, tmp_path: Path) -> None:
    text = LIMBS.replace("param length in [0.5, 1.5] m", "const length = 0.9 m")
    ran = evolved(srgc, packed, tmp_path, text)
    assert ran.status == 2
    assert "module `Limb`" in ran.err
    assert "another module" in ran.err
    assert not (tmp_path / "next").exists()


def test_modules_that_are_built_otherwise_are_told(packed: Path, srgc: Run, tmp_path: Path) -> None:
    text = LIMBS.replace("density: 1 kg/m", "density: 2 kg/m").replace("1.5] m", "1.4] m")
    ran = evolved(srgc, packed, tmp_path, text)
    assert ran.status == 0
    assert (
        f"note: module Limb differs from that of {packed / 'out'} (parameter length, bodies): it "
        f"is now as {tmp_path / 'next.srg'} says\nwritten to "
    ) in ran.out
    assert ran.out.count("note: ") == 1
    differs = [{"module": "Limb", "what": ["parameter length", "bodies"]}]
    assert read(tmp_path / "next", "design.json")["differs"] == differs
    assert srgc("verify", tmp_path / "next").status == 0


def test_comments_are_no_difference(packed: Path, srgc: Run, tmp_path: Path) -> None:
    text = LIMBS.replace("module Limb {", "/* the same */ module Limb\n{").replace("1 kg", "1000 g")
    ran = evolved(srgc, packed, tmp_path, text)
    assert ran.status == 0
    assert "note: " not in ran.out
    assert read(tmp_path / "next", "design.json")["differs"] == []


@pytest.mark.parametrize("mission", [{}, {"mission": "Day"}])
def test_a_result_without_a_robot_has_a_code(
    mission: dict[str, str], srgc: Run, tmp_path: Path
) -> None:
    folder, spec = tmp_path / "none", tmp_path / "next.srg"
    folder.mkdir()
    (folder / "design.json").write_text(json.dumps({"verdict": "unknown"} | mission), "utf-8")
    spec.write_text(LIMBS, encoding="utf-8")
    ran = srgc("evolve", folder, spec, "-o", tmp_path / "next")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == (
        f"error[SRG0735]: {folder} has no robot: its verdict is unknown\n"
        f"  hint: `srgc why {folder}` says why\n"
    )
    assert not (tmp_path / "next").exists()


@pytest.mark.parametrize("place", ["out", "out/inside", "."])
def test_a_step_is_not_written_over_its_robot(place: str, packed: Path, srgc: Run) -> None:
    before = sorted(packed.rglob("*"))
    folder, spec = packed / "out", packed / "limbs.srg"
    ran = srgc("evolve", folder, spec, "-o", packed / place, "--force", "-q")
    assert ran.status == 2
    assert "name another place" in ran.err
    assert sorted(packed.rglob("*")) == before


@pytest.mark.parametrize("price", ["1e5000", "-1", "nan", "1/0", "", "9" * 13, "0x1"])
def test_prices_are_plain_numbers(price: str, packed: Path, srgc: Run, tmp_path: Path) -> None:
    ran = evolved(srgc, packed, tmp_path, LIMBS, f"--add={price}")
    assert ran.status == 2
    assert "takes a number of at least 0" in ran.err


def test_a_price_of_changes_needs_what_may_change(packed: Path, srgc: Run, tmp_path: Path) -> None:
    assert evolved(srgc, packed, tmp_path, LIMBS, "--change", "3").status == 2


@pytest.fixture(scope="module")
def step(packed: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    from srgc.cli import run

    folder = tmp_path_factory.mktemp("step") / "next"
    arguments = ["evolve", packed / "out", packed / "limbs.srg", "-o", folder, "-q"]
    assert run([*map(str, arguments)]) == 0
    return folder


def altered(step: Path, place: Path, name: str, change: Callable[[dict[str, Any]], None]) -> Path:
    """A copy of the step with one file changed, with a digest that fits."""
    folder = place / "altered"
    shutil.copytree(step, folder)
    content = read(folder, name)
    change(content)
    content["digest"] = digest_of(content)
    (folder / name).write_text(json.dumps(content), encoding="utf-8")
    return folder


def test_the_step_as_it_is(step: Path, srgc: Run) -> None:
    assert read(step, "design.json")["cost"] == 0
    assert srgc("verify", step).status == 0


def test_the_robot_before_has_to_do_its_task(step: Path, srgc: Run, tmp_path: Path) -> None:
    def other(content: dict[str, Any]) -> None:
        content["inputs"] = [["9"] * len(row) for row in content["inputs"]]

    folder = altered(step, tmp_path, "history/1/certificate.json", other)
    ran = srgc("verify", folder)
    assert ran.status == 1
    assert "history/1, where the robot comes from" in ran.out


@pytest.mark.parametrize("free", [[["Limb", "nope"]], [["Nope", "length"]]])
def test_what_is_free_is_there(
    free: list[list[str]], step: Path, srgc: Run, tmp_path: Path
) -> None:
    folder = altered(step, tmp_path, "mission.json", lambda c: c["posed"].update(free=free))
    assert srgc("verify", folder).status == 1


def test_the_history_is_needed(step: Path, srgc: Run, tmp_path: Path) -> None:
    folder = tmp_path / "altered"
    shutil.copytree(step, folder)
    shutil.rmtree(folder / "history" / "1")
    assert srgc("verify", folder).status in (1, 4)


def test_results_that_say_nothing_of_differences_are_read(
    step: Path, srgc: Run, tmp_path: Path
) -> None:
    """Those that were written before they did."""
    folder = altered(step, tmp_path, "design.json", lambda content: content.pop("differs"))
    ran = srgc("why", folder, "-q")
    assert ran.status == 0
    assert ran.out.startswith("mission Pack: found")
