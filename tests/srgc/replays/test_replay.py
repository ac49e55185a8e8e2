"""``srgc replay``: the distance from the tube is that of another integration of MuJoCo's model."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from fractions import Fraction
from math import log2
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import scipy

from solvers.verifier.certified_tube import CertifiedTube, certified_tube
from solvers.verifier.proofs.enclosure import EnclosureFailure
from srgc.faults import UsageFault
from srgc.replays import mujoco_replay, replay_run
from srgc.replays import replay_run as python_replay
from srgc.replays.mujoco_replay import ReplayedMotion
from srgc.replays.replay_report import replay_json, replay_text
from srgc.results import found_design
from tests.oracles import result_files
from tests.oracles.driven_claims import CASES, FRICTION, Driven
from tests.oracles.found_folders import claim_found
from tests.oracles.mujoco_motions import sampled
from tests.oracles.small_specs import TURNER, replaced
from tests.oracles.some_cases import some
from tests.srgc.conftest import Ran

Command = Callable[..., Ran]
Result = Callable[[str], Path]
pytestmark = pytest.mark.usefixtures("tubes_once")

PARTS = ("coordinates", "rates", "effectors")
SIMULATORS = ("mujoco", "python")


@pytest.fixture(params=CASES.values(), ids=CASES)
def driven(request: pytest.FixtureRequest) -> Driven:
    case = request.param
    assert isinstance(case, Driven)
    return case


def numbers(srgc: Command, folder: Path, *arguments: object) -> dict[str, Any]:
    ran = srgc("replay", folder, *arguments, "--json")
    assert (ran.status, ran.err) == (0, "")
    content = json.loads(ran.out)
    assert isinstance(content, dict)
    return content


# --- the planned inputs stay in the tube ---------------------------------------------------------


@pytest.mark.parametrize("simulator", SIMULATORS)
def test_simulators_stay_in_the_tube(
    srgc: Command, driven: Driven, tmp_path: Path, simulator: str
) -> None:
    folder = driven.folder(tmp_path / "claimed")
    found = numbers(srgc, folder, "--in", simulator)
    assert found["disturbed"] is False
    library = mujoco if simulator == "mujoco" else scipy
    assert found["version"] == library.__version__
    (run,) = found["runs"]
    for part in PARTS:
        # The tube of the slide is narrower than what doubles round off.
        assert run[part]["outside"]["value"] < 1e-14
        assert run[part]["middle"]["value"] < 1e-7
    assert 0 < found["half_width"] < 1e-6


@pytest.mark.parametrize("simulator", SIMULATORS)
def test_a_found_robot(srgc: Command, made: Result, simulator: str) -> None:
    ran = srgc("replay", made("spatial") / "out", "--in", simulator)
    assert (ran.status, ran.err) == (0, "")
    assert ran.out.count("outside the tube  never") == 3
    assert ran.out.startswith("in MuJoCo" if simulator == "mujoco" else "in SciPy")
    if simulator == "python":
        assert srgc("replay", made("spatial") / "out").out == ran.out


def test_disturbances_are_in_the_tube(made: Result) -> None:
    replayed = replay_run.replay(
        made("closed") / "out", replay_run.ReplayRequest("mujoco", None, "rk4", 0)
    )
    assert "the tube holds all disturbed motions" in replay_text(replayed)
    found = json.loads(replay_json(replayed))
    assert found["disturbed"] is True
    assert found["half_width"] > 1e-3
    assert found["runs"][0]["coordinates"]["outside"]["value"] == 0


def test_the_tube_of_a_loop_holds_all_rounds(made: Result) -> None:
    replayed = replay_run.replay(
        made("looped") / "out", replay_run.ReplayRequest("mujoco", None, "rk4", 0)
    )
    assert "the tube holds all rounds of all motions; its" in replay_text(replayed)


# --- others do not, and it is seen by how much ---------------------------------------------------


def spoilt(
    folder: Path, monkeypatch: pytest.MonkeyPatch, column: int, more: float
) -> CertifiedTube:
    """Keep the tube of a folder, and then change its second row of inputs."""
    tube = certified_tube(folder)
    monkeypatch.setattr(replay_run, "found_tube", lambda _folder: tube)

    def change(content: dict[str, Any]) -> None:
        row = content["inputs"][1]
        row[column] = str(float(row[column]) + more)

    result_files.alter(folder, change, sign=True)
    return tube


@pytest.mark.parametrize(
    ("case", "simulator"),
    some(
        [("space, turning and sliding", "mujoco"), ("friction", "python"), ("branches", "mujoco")],
        2,
    ),
)
def test_a_spoilt_input_is_seen(
    srgc: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, case: str, simulator: str
) -> None:
    """What is printed is what another integration has, to which the tube is a line."""
    driven = CASES[case]
    folder = driven.folder(tmp_path / "claimed")
    text = srgc("export", folder, "--to", "mjcf").out
    planned = sampled(text, result_files.read(folder), driven.joints, driven.effectors)
    spoilt(folder, monkeypatch, len(driven.joints) - 1, 1.0)
    other = sampled(text, result_files.read(folder), driven.joints, driven.effectors)
    gaps, n = np.abs(other.states - planned.states), len(driven.joints)
    lengths = np.linalg.norm(other.tips - planned.tips, axis=2)
    (run,) = numbers(srgc, folder, "--in", simulator)["runs"]
    tables = {"coordinates": gaps[:, :n], "rates": gaps[:, n:], "effectors": lengths}
    for part, table in tables.items():
        for kind in ("outside", "middle"):
            shown = run[part][kind]
            # Between the samples it may be a little farther.
            assert shown["value"] >= table.max() - 1e-6
            assert shown["value"] <= 1.2 * table.max()
            names = driven.effectors if part == "effectors" else driven.joints
            column = names.index(shown["name"])
            assert table[:, column].max() == pytest.approx(table.max(), rel=0.2)
            row = round(shown["time"] / planned.times[1])
            assert abs(table[row, column] - shown["value"]) < 0.2 * shown["value"] + 1e-6
    assert run["rates"]["outside"]["value"] > 1e-4
    shown = srgc("replay", folder, "--in", simulator).out
    assert "never" not in shown
    name, value = run["rates"]["outside"]["name"], run["rates"]["outside"]["value"]
    assert f"outside the tube  at most {value:.2e} " in shown
    assert f"({name} at " in shown


def test_units_are_those_of_the_joint(
    srgc: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = CASES["a slide alone"].folder(tmp_path / "claimed")
    spoilt(folder, monkeypatch, 0, 1.0)
    (run,) = numbers(srgc, folder, "--in", "mujoco")["runs"]
    assert [run[part]["outside"]["unit"] for part in PARTS] == ["m", "m/s", "m"]
    assert run["rates"]["outside"] == pytest.approx(
        # By hand: 1 N for 0.2 s on 1 kg.
        {"value": 0.2, "unit": "m/s", "name": "P_2", "time": 0.4}, abs=1e-6,
    )  # fmt: skip
    assert run["coordinates"]["outside"]["value"] == pytest.approx(0.2 * (0.1 + 1.6), abs=1e-6)


# --- steps and methods ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("integrator", "order"),
    [
        ("rk4", 4),
        ("euler", 1),
        *(pytest.param(name, 1, marks=pytest.mark.slow) for name in ("implicit", "implicitfast")),
    ],
)
def test_halved_steps_converge_at_the_order_of_the_method(
    srgc: Command, tmp_path: Path, integrator: str, order: int
) -> None:
    folder = CASES["branches"].folder(tmp_path / "arms")
    options = ("--in", "mujoco", "--integrator", integrator)
    found = numbers(srgc, folder, *options, "--timestep", "0.03125", "--halvings", "3")
    runs = found["runs"]
    assert [run["timestep"] for run in runs] == [0.03125, 0.015625, 0.0078125, 0.00390625]
    assert runs[0]["change"] is None
    changes = [run["change"] for run in runs[1:]]
    assert log2(changes[1] / changes[2]) == pytest.approx(order, abs=0.2)
    if integrator == "rk4":
        assert changes[0] < 1e-3
    assert runs[0]["coordinates"]["middle"]["value"] > runs[-1]["coordinates"]["middle"]["value"]
    ran = srgc("replay", folder, *options, "--timestep", "0.03125", "--halvings", "1")
    table = ran.out.splitlines()[-3:]
    assert table[0].split() == ["step", "(s)", *PARTS, "change", "order"]
    assert [line.split()[0] for line in table[1:]] == ["0.03125", "0.015625"]


def test_steps_divide_those_of_the_task(
    srgc: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = CASES["friction"].folder(tmp_path / "arm")  # steps of 0.2 s
    for asked, used, instants in (("0.15", 0.1, 21), ("0.2", 0.2, 11), ("7", 0.2, 11)):
        (run,) = numbers(srgc, folder, "--in", "mujoco", "--timestep", asked)["runs"]
        assert (run["timestep"], run["instants"]) == (used, instants)
    (fine,) = numbers(srgc, folder, "--in", "mujoco", "--timestep", "0.005")["runs"]
    assert (fine["timestep"], fine["instants"]) == (0.005, 401)
    monkeypatch.setattr(mujoco_replay, "MOST_INSTANTS", 70)
    (some,) = numbers(srgc, folder, "--in", "mujoco", "--timestep", "0.005")["runs"]
    assert (some["timestep"], some["instants"]) == (0.005, 71)
    assert some["coordinates"]["middle"]["value"] == pytest.approx(
        fine["coordinates"]["middle"]["value"], rel=0.05
    )


def test_a_robot_that_cannot_move(srgc: Command, tmp_path: Path) -> None:
    text = replaced(TURNER, " and starts with B eps JO", "")
    folder = claim_found(tmp_path / "pole", text, "B eps L eps EN", ["1.5"])
    for simulator in SIMULATORS:
        found = numbers(srgc, folder, "--in", simulator)
        assert found["half_width"] is None
        (run,) = found["runs"]
        assert (run["coordinates"], run["rates"]) == (None, None)
        assert run["effectors"]["outside"]["value"] == 0
        assert srgc("replay", folder, "--in", simulator).status == 0


def test_dynamics_of_modules(srgc: Command, made: Result) -> None:
    """MJCF does not hold a motor; our own equations do."""
    folder = made("motor") / "out"
    ran = srgc("replay", folder, "--in", "mujoco")
    assert (ran.status, ran.out) == (2, "")
    assert "MJCF does not hold the dynamics of their own of M (symbol 2)" in ran.err
    (run,) = numbers(srgc, folder, "--in", "python")["runs"]
    for part in PARTS:
        assert run[part]["outside"]["value"] == 0


# --- what is refused -----------------------------------------------------------------------------


def refused(ran: Ran, reason: str) -> None:
    assert (ran.status, ran.out) == (2, "")
    assert reason in ran.err
    assert ran.err.count("\n") == 1


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    return CASES["friction"].folder(tmp_path / "arm")


def test_without_mujoco(srgc: Command, arm: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    refused(srgc("replay", arm, "--in", "mujoco"), 'pip install "srgc[mujoco]"')
    assert srgc("replay", arm, "--in", "python").status == 0
    assert srgc("export", arm, "--to", "mjcf").status == 0


def test_a_mujoco_that_does_not_load(
    srgc: Command, arm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As with a library missing, or with a ``MUJOCO_GL`` that it does not know."""
    (tmp_path / "mujoco").mkdir()
    (tmp_path / "mujoco" / "__init__.py").write_text("raise OSError('no libGL')", "utf-8")
    monkeypatch.delitem(sys.modules, "mujoco")
    monkeypatch.syspath_prepend(tmp_path)
    refused(srgc("replay", arm, "--in", "mujoco"), "MuJoCo cannot be loaded: no libGL")


def test_usage(srgc: Command, arm: Path, tmp_path: Path) -> None:
    for options in (("--timestep", "0.1"), ("--integrator", "rk4"), ("--halvings", "1")):
        refused(srgc("replay", arm, *options), "--in mujoco alone")
        refused(srgc("replay", arm, "--in", "python", *options), "--in mujoco alone")
    for value in ("0", "-1", "nan", "inf"):
        ran = srgc("replay", arm, "--in", "mujoco", "--timestep", value)
        refused(ran, "a positive number of seconds")
    refused(srgc("replay", arm, "--in", "mujoco", "--timestep", "1e-9"), "more than 100000000")
    many = ("--timestep", "1e-5", "--halvings", "16")
    refused(srgc("replay", arm, "--in", "mujoco", *many), "more than 100000000")
    refused(srgc("replay", tmp_path / "none", "--in", "python"), "is not a folder")
    wrong = (("--in",), ("--in", "gazebo"), ("--in", "mujoco", "--halvings", "99"))
    for arguments in ((arm, *options) for options in wrong):
        assert srgc("replay", *arguments).status == 2


def test_another_verdict(srgc: Command, made: Result) -> None:
    folder = made("beyond_reach") / "out"
    ran = srgc("replay", folder, "--in", "python")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == (
        f"error[SRG0735]: {folder} has no robot: its verdict is impossible\n"
        f"  hint: `srgc why {folder}` says why\n"
    )


def test_an_altered_or_false_certificate(srgc: Command, arm: Path) -> None:
    result_files.alter(arm, lambda c: c.update(effector=3), sign=False)
    refused(srgc("replay", arm, "--in", "python"), "altered")
    result_files.alter(arm, lambda c: None, sign=True)
    refused(srgc("replay", arm, "--in", "python"), "the robot has no effector 4")


def test_a_false_certificate_with_a_tube(srgc: Command, result: Result) -> None:
    """The tube is that of its motion all the same; `verify` refutes what is said of that."""
    arm = result("turner")
    assert numbers(srgc, arm, "--in", "python")["certificate"] == "valid"
    assert "certificate" not in srgc("replay", arm, "--in", "python").out

    def more_steps_in_the_target(content: dict[str, Any]) -> None:
        path = content["path"][content["effector"]]
        path[1] = path[-1]

    result_files.alter(arm, more_steps_in_the_target, sign=True)
    assert srgc("verify", arm).status == 1
    ran = srgc("replay", arm, "--in", "python")
    assert ran.status == 0
    assert "the tube holds the motion" in ran.out
    assert ran.out.splitlines()[-1].startswith("but the certificate is refuted: ")
    assert numbers(srgc, arm, "--in", "python")["certificate"] == "refuted"


def test_a_simulation_that_diverges(
    srgc: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Friction that makes an explicit method unstable; MuJoCo leaves no log behind."""
    monkeypatch.chdir(tmp_path)
    text = replaced(FRICTION, "0.7 N*m*s", "700 N*m*s")
    case = Driven(text, CASES["friction"].word, ("1.5",), ("JO_2",), ("EN_6",))
    folder = case.folder(tmp_path / "stiff")
    ran = srgc("replay", folder, "--in", "mujoco", "--timestep", "0.05")
    refused(ran, "diverges with steps of 0.05 s (rk4)")
    assert not list(tmp_path.glob("MUJOCO_LOG*"))
    assert srgc("replay", folder, "--in", "mujoco", "--integrator", "implicit").status == 0


def test_without_a_tube(srgc: Command, arm: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is simulated then: a spoilt motion may take hours."""

    def fails(_folder: Path) -> CertifiedTube:
        raise EnclosureFailure(0.75)

    def simulated(*_: object) -> ReplayedMotion:
        raise AssertionError

    monkeypatch.setattr(found_design, "certified_tube", fails)
    monkeypatch.setattr(replay_run, "replay_in_mujoco", simulated)
    monkeypatch.setattr(python_replay, "replay_in_python", simulated)
    for simulator in SIMULATORS:
        ran = srgc("replay", arm, "--in", simulator)
        assert (ran.status, ran.out) == (4, "")
        assert "no enclosure of the motion beyond 0.75 s" in ran.err


def test_a_robot_that_mujoco_does_not_accept_is_named() -> None:
    text = '<mujoco><worldbody><body><joint type="hinge"/></body></worldbody></mujoco>'
    with pytest.raises(UsageFault, match=r"^MuJoCo does not accept the robot: .*mass"):
        mujoco_replay.loaded_model(mujoco, text, Fraction(1, 100), "rk4")
