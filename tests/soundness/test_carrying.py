"""A hand that takes a load up and puts it down: found, proved, simulated by hand, and spoilt."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.carrying_tasks import carrying_task
from tests.oracles.command_line import quiet, synthesised
from tests.oracles.small_specs import replaced
from tests.soundness.test_poses import LENGTHS, SPEC, dynamics

LOAD = 0.8
TASK = """\
task Turn { robot Arm; workspace Table; start in S at rest; reach S;
  carry 0.8 kg from T to Bin rates <= 0.05 rad/s; avoid O with effector;
  effort <= 20 N*m; control open loop; gravity (0, -1.62) m/s^2; horizon 30 steps of 0.1 s; }
"""
CARRIES = (
    replaced(
        SPEC[: SPEC.index("task Turn")],
        "  target T",
        "  region Bin polytope { x + y >= 0.3; x + y <= 0.6; y - x >= -0.4; y - x <= 0.1; } m;\n"
        "  target T",
    )
    + TASK
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return synthesised(tmp_path_factory.mktemp("carry"), CARRIES)


def samples(certificate: dict) -> tuple[Array, list[float]]:
    """The states at all samples, (k + 1, 6), with the load in the steps that the inputs say."""
    states = [np.array([float(x) for x in certificate["start"]])]
    there = [float(row[-1]) for row in certificate["inputs"]]

    def rates(_: float, x: Array, u: Array, carried: float) -> Array:
        mass, rest = dynamics(x[:3], x[3:], carried)
        return np.concatenate([x[3:], np.linalg.solve(mass, u - rest)])

    for row, load in zip(certificate["inputs"], there, strict=True):
        u = np.array([float(x) for x in row[:-1]])
        assert np.all(np.abs(u) <= 20)
        found = solve_ivp(
            rates, (0, 0.1), states[-1], args=(u, LOAD * load), rtol=1e-10, atol=1e-12
        )
        states.append(found.y[:, -1])
    return np.array(states), there


def tip(state: Array) -> Array:
    angles = np.cumsum(state[:3])
    return np.array([LENGTHS @ np.cos(angles), LENGTHS @ np.sin(angles)])


def in_bin(at: Array) -> bool:
    return bool(0.3 <= at.sum() <= 0.6 and -0.4 <= at[1] - at[0] <= 0.1)


@pytest.mark.slow
def test_the_simulated_hand_carries(folder: Path) -> None:
    report = verify_directory(folder)
    assert report.outcome is Outcome.VALID
    states, there = samples(result_files.read(folder))
    first = there.index(1.0)
    last = first + sum(map(int, there))
    assert there == [0.0] * first + [1.0] * (last - first) + [0.0] * (30 - last)
    assert 0 <= first < last <= 30
    taken, put = tip(states[first]), tip(states[last])
    assert -0.3 <= taken[0] <= 0.2
    assert 0.6 <= taken[1] <= 0.9
    assert in_bin(put)
    assert np.all(np.abs(states[[first, last], 3:]) < 0.05)
    # The start region is reached again, which it would not be with another load.
    end = tip(states[-1])
    assert 0.7 <= end[0] <= 0.9
    assert 0.1 <= end[1] <= 0.4
    margins = {each.name: each for each in report.conditions}
    worst = 0.05 - np.max(np.abs(states[first, 3:]))
    assert margins["rates, load taken up"].margin == pytest.approx(worst, abs=1e-6)


Column = list[str]


def altered(folder: Path, change: Callable[[Column], Column]) -> Outcome:
    """The verdict on a certificate whose column of the load is another one."""
    before = (folder / "certificate.json").read_bytes()

    def put(content: dict[str, Any]) -> None:
        column = change([row[-1] for row in content["inputs"]])
        for row, value in zip(content["inputs"], column, strict=True):
            row[-1] = value

    result_files.alter(folder, put, sign=True)
    outcome = verify_directory(folder).outcome
    (folder / "certificate.json").write_bytes(before)
    return outcome


def swapped(place: int, value: str) -> Callable[[Column], Column]:
    def change(column: Column) -> Column:
        first, last = column.index("1"), len(column) - column[::-1].index("1")
        at = (first - 1, first, last - 1, last, (first + last) // 2)[place]
        return [value if i == at else x for i, x in enumerate(column)]

    return change


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        swapped(0, "1"),  # a step too early
        swapped(1, "0"),
        swapped(2, "0"),
        swapped(3, "1"),
        swapped(4, "0"),  # laid down on the way
        swapped(4, "0.5"),
        swapped(1, "0.999999999"),
        lambda column: ["0"] * len(column),
        lambda column: ["1"] * len(column),
    ],
)
def test_another_time_of_the_load_is_refuted(
    folder: Path, change: Callable[[Column], Column]
) -> None:
    assert altered(folder, change) is Outcome.REFUTED
    assert altered(folder, lambda column: column) is Outcome.VALID


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("0.8 kg", "0.9 kg"),
        ("from T to Bin", "from Bin to T"),
        ("rates <= 0.05", "rates <= 0.002"),
        ("from T", "from S"),
    ],
)
def test_a_motion_of_another_load_is_refuted(folder: Path, old: str, new: str) -> None:
    result_files.alter_spec(folder, old, new, sign=True)
    report = verify_directory(folder)
    result_files.alter_spec(folder, new, old, sign=True)
    assert report.outcome is Outcome.REFUTED


def test_a_load_that_cannot_be_reached_is_impossible(tmp_path: Path) -> None:
    far = replaced(CARRIES, "x + y >= 0.3; x + y <= 0.6", "x + y >= 2.2; x + y <= 2.6")
    (tmp_path / "spec.srg").write_text(far, encoding="utf-8")
    made = tmp_path / "out"
    assert quiet("synth", tmp_path / "spec.srg", "-o", made, "-q") == 3
    report = verify_directory(made)
    assert report.outcome is Outcome.VALID
    assert result_files.read(made)["kind"] == "impossible"


CRANE = (
    replaced(
        replaced(
            SPEC[: SPEC.index("workspace")],
            "matches B J Upper J Fore J Palm E",
            "matches B J Upper E",
        ),
        "[-170, 170] deg",
        "[-170, 170] deg; drive q: gear 20 rotor 1e-4 kg*m^2 viscous 0.2 N*m*s",
    )
    + """\
workspace Yard {
  plane xy;
  bounds box [-1, 1] x [-1, 1] m;
  region Hall hull (0.5, -0.1), (0.65, -0.1), (0.65, 0.1), (0.5, 0.1) m;
  region Truck ball (0, 0.58) m radius 8 cm;
  region Ship hull (0.2, -0.65), (0.45, -0.4), (0.35, -0.35), (0.1, -0.5) m;
}
task Turn { robot Arm; workspace Yard; start in Hall at rest; reach Hall;
  carry 2 kg from Truck to Ship rates <= 4 deg/s; payload 0.4 kg; gravity (0, -2) m/s^2;
  effort <= 30 N*m; control feedback; horizon 40 steps of 0.1 s;
  robust start 0.2 deg, 0.2 deg/s; robust effort 1 %; robust payload 4 %;
  robust measure 0.05 deg, 0.05 deg/s; }
"""
)


@pytest.fixture(scope="module")
def crane(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return synthesised(tmp_path_factory.mktemp("crane"), CRANE)


@pytest.mark.slow
def test_disturbed_motions_with_a_load_stay_in_their_tube(crane: Path) -> None:
    """MuJoCo's robot, of which the load is a part of a link in some steps."""
    report = verify_directory(crane)
    assert report.outcome is Outcome.VALID
    asked = {each.name for each in report.conditions if each.name.startswith(("load", "rates"))}
    assert asked == {
        "load taken up in Truck", "load put down in Ship", "rates, load taken up",
        "rates, load put down",
    }  # fmt: skip
    pytest.importorskip("mujoco")
    assert quiet("replay", crane, "--in", "mujoco", "--disturbed", "60") == 0


@pytest.mark.slow
def test_a_controller_that_steers_the_load_is_refuted(crane: Path) -> None:
    before = (crane / "certificate.json").read_bytes()
    for field, place in (("gains", (3, 1, 0)), ("rounding", (1,))):

        def put(
            content: dict[str, Any], field: str = field, place: tuple[int, ...] = place
        ) -> None:
            (controller,) = (one for one in content["claims"] if one["kind"] == "controller")
            *path, last = place
            row = controller[field]
            for index in path:
                row = row[index]
            assert float(row[last]) == 0
            row[last] = "0.000001"

        result_files.alter(crane, put, sign=True)
        found = verify_directory(crane)
        (crane / "certificate.json").write_bytes(before)
        assert found.outcome is Outcome.REFUTED
        assert "load carried" in str(found.reason)


@pytest.mark.slow
def test_exported_code_and_replay_know_the_load(crane: Path, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    assert quiet("export", crane, "--to", "all", "-o", tmp_path / "files") == 0
    files = {path.name for path in (tmp_path / "files").iterdir()}
    assert {"controller.py", "controller.c", "robot.xml", "robot_loaded_1.xml"} <= files
    ran = subprocess.run(
        [sys.executable, tmp_path / "files" / "replay.py"],
        capture_output=True,
        text=True,
        check=True,
    )
    differences = [float(line.split()[-3]) for line in ran.stdout.splitlines()[1:]]
    assert max(differences) < 1e-4
    spaces: dict[str, Any] = {}
    exec((tmp_path / "files" / "controller.py").read_text(), spaces)
    claimed = [float(row[-1]) for row in result_files.read(crane)["inputs"]]
    held = spaces["controller"]
    assert [held(k, [0.01, 0.0])[-1] for k in range(40)] == claimed
    assert "load" in spaces["INPUTS"][-1]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 3, 4, 6])
def test_random_arms_carry_what_a_simulation_carries(tmp_path: Path, seed: int) -> None:
    """A task with a witness is never impossible, and what is found does it in a simulation."""
    task = carrying_task(seed)
    (tmp_path / "spec.srg").write_text(task.text, encoding="utf-8")
    made = tmp_path / "out"
    status = quiet("synth", tmp_path / "spec.srg", "-o", made, "-q")
    assert status == 0
    assert verify_directory(made).outcome is Outcome.VALID
    assert task.faults(result_files.read(made)) == []


STANDING = """\
module B { role base; }
module L { role link; param length in [0.5, 1] m; }
module E { role effector; }
grammar G { start N; base: N -> B; link: N -> N L; tool: N -> N E; accept matches B L E; }
semantics G {
  base { this.frame = world; }
  link { this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: 1 kg/m); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
workspace W {
  plane xy;
  bounds box [-2, 2] x [-2, 2] m;
  region S box [0.4, 1.2] x [-0.1, 0.1] m;
  region A box [0.6, 0.9] x [-0.1, 0.1] m;
  region C box [0.87, 1.1] x [-0.2, 0.2] m;
}
task T { robot G; workspace W; start in S at rest; reach S; carry 1 kg from A to C;
  horizon 3 steps of 0.1 s; }
"""


def test_a_robot_without_joints_carries_where_it_stands(tmp_path: Path) -> None:
    """With a length of 0.87 m to 0.9 m it is in both regions all the time."""
    made = synthesised(tmp_path, STANDING)
    assert verify_directory(made).outcome is Outcome.VALID
    certificate = result_files.read(made)
    assert 0.87 <= float(certificate["parameters"][0]["value"]) <= 0.9
    assert "1" in {row[0] for row in certificate["inputs"]}
