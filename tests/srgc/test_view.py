"""``srgc view`` without a browser: what it shows, what it refuses, and how it ends."""

from __future__ import annotations

import builtins
import os
import re
import signal
import socket
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from srgc.view.shown_designs import shown_designs
from tests.conftest import srgc_process
from tests.oracles import shaped_arm as arm
from tests.oracles.driven_claims import CASES
from tests.oracles.found_folders import claim_found
from tests.oracles.mujoco_dynamics import MujocoRobot
from tests.oracles.small_specs import SLIDER, TURNER
from tests.srgc.conftest import Ran

View = Callable[..., Ran]
Result = Callable[[str], Path]


def refused(ran: Ran, reason: str) -> None:
    assert (ran.status, ran.out) == (2, "")
    assert reason in ran.err
    assert ran.err.count("\n") == 1


@pytest.fixture
def turner(tmp_path: Path) -> Path:
    return claim_found(tmp_path / "turner", TURNER, "B eps JO eps L eps EN", ["1.5"])


# --- what it shows -------------------------------------------------------------------------------


def test_designs_stand_beside_one_another(tmp_path: Path, turner: Path) -> None:
    """Their regions and motions do not overlap along y; the first is where its spec says."""
    slider = claim_found(tmp_path / "slider", SLIDER, "B eps P eps M eps EN", [])
    shown = shown_designs([turner, slider, turner], tubes=False)
    assert [each.label for each in shown.designs] == [str(turner), "slider", str(turner)]
    assert not shown.designs[0].offset.any()
    # A rod of 1.5 m and a fiftieth of that as its radius, within regions of 2.5 m.
    assert shown.designs[0].bounds.tolist() == [[-0.3, -0.3, -0.03], [2.5, 2.5, 0.03]]
    for before, after in zip(shown.designs, shown.designs[1:], strict=False):
        assert after.bounds[0, 1] > before.bounds[1, 1]
        assert after.offset[[0, 2]].tolist() == [0, 0]


def test_of_a_mission_all_designs_are_shown(made: Result) -> None:
    folder = made("mission_retune") / "out"
    labels = [each.label for each in shown_designs([folder], tubes=False).designs]
    tasks = sorted(path.name for path in (folder / "tasks").iterdir())
    assert sorted(labels) == [f"out: {task}" for task in tasks]
    assert len(tasks) > 1


@pytest.mark.parametrize("name", ["space, turning and sliding", "branches"])
def test_at_any_time_links_are_where_mujoco_puts_them(
    srgc: View, tmp_path: Path, name: str
) -> None:
    """At one coordinate each: what is between instants is tested by its smoothness below."""
    from srgc.exports.scenes.link_motion import link_motion

    driven = CASES[name]
    folder = driven.folder(tmp_path / "out")
    scene = shown_designs([folder], tubes=False).designs[0].scene
    robot = MujocoRobot(srgc("export", folder, "--to", "mjcf").out, driven.joints)
    rng, n = np.random.default_rng(4), len(driven.joints)
    for q in rng.uniform(-2, 2, (10, n)):
        robot.put(q, np.zeros(n), np.zeros(n))
        motion = link_motion(scene.robot.tree, q[None])
        for number, link in enumerate(scene.robot.names.links):
            try:
                body = robot.data.body(link)
            except KeyError:  # one of several joints of one body
                continue
            np.testing.assert_allclose(motion.links.origins[0, number], body.xpos, atol=1e-12)
            turn = motion.links.quaternions()[0, number]
            assert abs(turn @ body.xquat) == pytest.approx(1, abs=1e-12)
        for number, tool in enumerate(driven.effectors):
            place = robot.data.site(tool).xpos
            np.testing.assert_allclose(motion.effectors.origins[0, number], place, atol=1e-12)


def test_between_instants_the_motion_is_cubic(tmp_path: Path) -> None:
    """Twice as many instants miss a motion that is integrated finely by a sixteenth."""
    from srgc.exports.scenes.fine_instants import fine_instants
    from srgc.results.found_design import found_design

    design = found_design(arm.shaped_arm(tmp_path / "out"))
    fine = fine_instants(design, 8 * 48)
    errors = []
    for frequency in (48, 96):
        coarse = fine_instants(design, frequency)
        assert coarse.times[-1] == fine.times[-1] == 0.75
        there = np.array([coarse.at(float(time))[0] for time in fine.times])
        errors.append(np.abs(there - fine.q).max())
        assert coarse.at(9.0)[0].tolist() == coarse.q[-1].tolist()
    assert errors[1] < 1e-6
    assert 12 < errors[0] / errors[1] < 20


# --- what it refuses -----------------------------------------------------------------------------


def test_without_the_library_one_message(
    srgc: View, turner: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.partition(".")[0] == "viser":
            raise ModuleNotFoundError(name)
        return there(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    ran = srgc("view", turner, "--no-browser")
    assert ran == Ran(2, "", 'error: the page needs the library viser: pip install "srgc[view]"\n')


def test_folders_without_a_design(srgc: View, made: Result, tmp_path: Path, turner: Path) -> None:
    pytest.importorskip("viser", reason="the extra view is not installed")
    refused(srgc("view", tmp_path / "none"), "is not a folder")
    for folder in (made("beyond_reach") / "out", made("mission_nobody") / "out"):
        ran = srgc("view", turner, folder)
        assert (ran.status, ran.out) == (2, "")
        assert ran.err.startswith("error[SRG0735]: ")
        assert "its verdict is impossible" in ran.err
    ran = srgc("view")
    assert (ran.status, ran.out) == (2, "")


def test_a_port_that_is_taken(srgc: View, turner: Path) -> None:
    pytest.importorskip("viser", reason="the extra view is not installed")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        refused(srgc("view", turner, "--port", port), f"port {port} cannot be used")


# --- how it serves and ends ----------------------------------------------------------------------


@pytest.mark.skipif(os.name == "nt", reason="interrupts are others on Windows")
def test_it_serves_this_computer_until_it_is_interrupted(turner: Path, tmp_path: Path) -> None:
    pytest.importorskip("viser", reason="the extra view is not installed")
    (tmp_path / "work").mkdir()
    process = srgc_process(["view", turner, "--no-browser", "--no-tube"], tmp_path / "work")
    assert process.stdout is not None
    line = process.stdout.readline().decode()
    found = re.fullmatch(r"(http://127\.0\.0\.1:(\d+))  \(Ctrl-C ends it\)\n", line)
    assert found is not None, line
    with urllib.request.urlopen(found[1], timeout=60) as page:
        assert b"<html" in page.read()
    table = Path("/proc/net/tcp")
    if table.is_file():
        # 127.0.0.1 as the table of the kernel has it, and no other address.
        port = f"{int(found[2]):04X}"
        rows = [row.split() for row in table.read_text(encoding="ascii").splitlines()[1:]]
        bound = {row[1] for row in rows if row[1].endswith(f":{port}") and row[3] == "0A"}
        assert bound == {f"0100007F:{port}"}
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (130, b"", b"interrupted\n")
    assert list((tmp_path / "work").iterdir()) == []
