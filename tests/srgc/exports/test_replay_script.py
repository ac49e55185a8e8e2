"""``srgc export --to mujoco``: the script in the folder does what it says, without srgc."""

from __future__ import annotations

import csv
import re
import runpy
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.oracles import result_files
from tests.oracles.driven_claims import CASES, FRICTION, Driven
from tests.oracles.mujoco_motions import sampled
from tests.oracles.small_specs import replaced
from tests.oracles.some_cases import some
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]
WORDS = ("position", "velocity")


QUICK = ("space, turning and sliding", "merged joints", "friction")


@pytest.fixture(params=some([*QUICK, *sorted(CASES.keys() - set(QUICK))], 3))
def driven(request: pytest.FixtureRequest) -> Driven:
    return CASES[request.param]


@pytest.fixture
def bundle(srgc: Export, driven: Driven, tmp_path: Path) -> Path:
    folder = driven.folder(tmp_path / "claimed")
    target = tmp_path / "an arm" / "for MuJoCo"
    ran = srgc("export", folder, "--to", "mujoco", "-o", target)
    names = ("replay.py", "robot.xml", "torques.csv", "trajectory.csv")
    assert ran == Ran(0, "".join(f"{target / name}\n" for name in names), "")
    assert sorted(path.name for path in target.iterdir()) == list(names)
    assert (target / "robot.xml").read_text("utf-8") == srgc("export", folder, "--to", "mjcf").out
    table = (target / "trajectory.csv").read_text("utf-8")
    assert table == srgc("export", folder, "--to", "csv").out
    return target


def replayed(bundle: Path, place: Path, *arguments: str) -> dict[str, float]:
    """The numbers that the script prints, run alone: srgc is not there to be imported."""
    ran = subprocess.run(
        [sys.executable, "-I", "-W", "error", bundle / "replay.py", *arguments],
        cwd=place, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (ran.returncode, ran.stderr) == (0, "")
    head, *lines = ran.stdout.splitlines()
    found = {"step": float(head.removeprefix("steps of ").removesuffix(" s"))}
    for word, line in zip(WORDS, lines, strict=True):
        found[word] = float(line.removeprefix(f"largest difference of a {word}: ").split()[0])
    return found


def test_the_script_runs_the_closed_loop(
    srgc: Export, made: Callable[[str], Path], tmp_path: Path
) -> None:
    """From a start that is off, too: it is what the law makes of it, to first order."""
    folder, bundle = made("closed") / "out", tmp_path / "arm"
    assert srgc("export", folder, "--to", "mujoco", "-o", bundle).status == 0
    assert max(replayed(bundle, tmp_path)[word] for word in WORDS) < 1e-7
    claim = result_files.read(folder)
    with (bundle / "gains.csv").open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    assert head == ["t", "position.JO_2 to JO_2", "velocity.JO_2 to JO_2"]
    stated = [[float(x) for row in step for x in row] for step in claim["claims"][0]["gains"]]
    np.testing.assert_array_equal([[float(x) for x in row[1:]] for row in rows], stated)
    script = runpy.run_path(str(bundle / "replay.py"))
    model, data, steps = script["start"](None)
    data.qpos[0] += 0.1
    apart = [
        data.qpos[0] - float(claim["claims"][0]["reference"][number // steps][0])
        for number, _ in enumerate(script["moved"](model, data, steps))
        if number % steps == 0
    ]
    assert apart[0] == pytest.approx(0.1, abs=0.01)
    assert abs(apart[-1]) < 0.01


def test_the_script_replays_the_plan(bundle: Path, tmp_path: Path, driven: Driven) -> None:
    fine = replayed(bundle, tmp_path)
    assert fine["step"] <= 1e-3
    assert max(fine[word] for word in WORDS) < 1e-7
    coarse = replayed(bundle, tmp_path, "--timestep", "0.03")
    assert fine["step"] < coarse["step"] <= 0.03
    assert not list(tmp_path.glob("MUJOCO_LOG*"))
    with (bundle / "torques.csv").open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    assert head == ["t", *driven.joints]
    claim = result_files.read(tmp_path / "claimed")
    stated = [[float(u) for u in row] for row in claim["inputs"]]
    assert [[float(u) for u in row[1:]] for row in rows] == stated


def test_a_spoilt_torque_is_seen(bundle: Path, tmp_path: Path, driven: Driven) -> None:
    """The difference is that of another motion, which an integration of its own has, too."""
    path = bundle / "torques.csv"
    lines = path.read_text(encoding="utf-8").splitlines()
    cells = lines[2].split(",")
    cells[1] = str(float(cells[1]) + 3.0)
    path.write_text("\n".join([*lines[:2], ",".join(cells), *lines[3:]]), encoding="utf-8")
    claim = result_files.read(tmp_path / "claimed")
    text = (bundle / "robot.xml").read_text(encoding="utf-8")
    planned = sampled(text, claim, driven.joints, driven.effectors).states
    claim["inputs"][1][0] = cells[1]
    gaps = np.abs(sampled(text, claim, driven.joints, driven.effectors).states - planned)
    found, n = replayed(bundle, tmp_path), len(driven.joints)
    assert found["position"] == pytest.approx(gaps[:, :n].max(), rel=5e-3)
    assert found["velocity"] == pytest.approx(gaps[:, n:].max(), rel=5e-3)
    assert found["velocity"] > 1e-3


def test_view_shows_the_motion_from_its_start(
    srgc: Export, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a window that is closed after some frames of the second round."""
    folder = CASES["a slide alone"].folder(tmp_path / "claimed")
    assert srgc("export", folder, "--to", "mujoco", "-o", tmp_path / "m").status == 0
    seen: list[tuple[float, float]] = []

    class Window:
        def __init__(self, data: mujoco.MjData) -> None:
            self.data, self.rounds, self.before = data, 0, np.inf

        def __enter__(self) -> Window:
            return self

        def __exit__(self, *_: object) -> None:
            return

        def is_running(self) -> bool:
            if self.data.time < self.before:
                self.rounds += 1
            self.before = self.data.time
            seen.append((self.data.time, float(self.data.qpos[0])))
            return self.rounds < 4

        def sync(self) -> None:
            return

    viewer = types.ModuleType("mujoco.viewer")
    viewer.launch_passive = lambda _model, data: Window(data)  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "mujoco.viewer", viewer)
    monkeypatch.setattr(mujoco, "viewer", viewer, raising=False)
    monkeypatch.setattr("time.sleep", lambda _seconds: None)
    monkeypatch.setattr(sys, "argv", ["replay.py", "--view"])
    runpy.run_path(str(tmp_path / "m" / "replay.py"), run_name="__main__")
    start = float(result_files.read(folder)["start"][0])
    assert seen[0] == (0.0, start)
    assert max(time for time, _ in seen) == pytest.approx(2, abs=2e-3)
    assert seen[-1][0] < 0.01


@pytest.mark.parametrize("value", some(["-1", "x", "0", "nan"], 2))
def test_steps_that_are_none(srgc: Export, tmp_path: Path, value: str) -> None:
    folder = CASES["a slide alone"].folder(tmp_path / "claimed")
    assert srgc("export", folder, "--to", "mujoco", "-o", tmp_path / "m").status == 0
    ran = subprocess.run(
        [sys.executable, tmp_path / "m" / "replay.py", f"--timestep={value}"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ran.returncode == 2
    assert "Traceback" not in ran.stderr


@pytest.mark.parametrize(
    ("name", "line", "text", "reason"),
    [
        ("torques.csv", 2, "0.1,nan", "line 3: there is no number for P_2"),
        ("torques.csv", 2, "0.1,", "line 3: there is no number for P_2"),
        ("torques.csv", 2, "0.1,x", "torques.csv cannot be read"),
        ("torques.csv", 2, "0.1,1,2", "torques.csv cannot be read"),
        ("torques.csv", 0, "t,P_3", "line 2: there is no number for P_2"),
        ("torques.csv", 2, None, "a row for every step"),
        ("trajectory.csv", 2, None, "a row for every step"),
        ("robot.xml", 6, None, "robot.xml cannot be loaded"),
    ],
)
def test_files_that_were_spoilt(
    srgc: Export,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    name: str,
    line: int,
    text: str | None,
    reason: str,
) -> None:
    """Nothing is left out unseen: a smaller difference would be that of another comparison."""
    folder = CASES["a slide alone"].folder(tmp_path / "claimed")
    assert srgc("export", folder, "--to", "mujoco", "-o", tmp_path / "m").status == 0
    path = tmp_path / "m" / name
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[line : line + 1] = [] if text is None else [text]
    path.write_text("\n".join(lines), encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["replay.py"])
    with pytest.raises(SystemExit, match=re.escape(reason)):  # a text: on standard error, status 1
        runpy.run_path(str(tmp_path / "m" / "replay.py"), run_name="__main__")


def test_the_script_without_mujoco(srgc: Export, tmp_path: Path) -> None:
    folder = CASES["a slide alone"].folder(tmp_path / "claimed")
    assert srgc("export", folder, "--to", "mujoco", "-o", tmp_path / "m").status == 0
    (tmp_path / "mujoco.py").write_text("raise ModuleNotFoundError('mujoco')", encoding="utf-8")
    ran = subprocess.run(
        [sys.executable, tmp_path / "m" / "replay.py"], env={"PYTHONPATH": str(tmp_path)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ran.returncode == 1
    assert ran.stderr == "MuJoCo is not installed; it comes with: pip install mujoco\n"


def test_a_replay_that_diverges(srgc: Export, tmp_path: Path) -> None:
    text = replaced(FRICTION, "0.7 N*m*s", "700 N*m*s")
    case = Driven(text, CASES["friction"].word, ("1.5",), ("JO_2",), ("EN_6",))
    assert srgc("export", case.folder(tmp_path / "c"), "--to", "mujoco", "-o", tmp_path / "m")
    command = [sys.executable, tmp_path / "m" / "replay.py", "--timestep", "0.05"]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout) == (1, "")
    assert "the simulation diverges with steps of 0.05 s" in ran.stderr
