"""The planned motion as CSV, JSON, ROS 2 message and npz: MuJoCo's own accelerations agree."""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml

from compiler.arrays import Array
from tests.conftest import srgc_process
from tests.oracles import result_files
from tests.oracles.coupled_robots import LINKAGE
from tests.oracles.driven_claims import CASES, Driven
from tests.oracles.found_folders import claim_found
from tests.oracles.mujoco_dynamics import MujocoRobot
from tests.oracles.mujoco_motions import Sampled, sampled
from tests.oracles.small_specs import SLIDER, TURNER, replaced
from tests.oracles.some_cases import some
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]
Result = Callable[[str], Path]
CLOSE = 1e-9
MOTIONS = ("csv", "json", "ros2", "npz")


@pytest.fixture(params=some([*sorted(CASES.keys() - {"branches"}), "branches"], -1))
def driven(request: pytest.FixtureRequest) -> Driven:
    return CASES[request.param]


@pytest.fixture
def folder(driven: Driven, tmp_path: Path) -> Path:
    return driven.folder(tmp_path / "claimed")


@pytest.fixture
def expected(srgc: Export, driven: Driven, folder: Path) -> Sampled:
    text = srgc("export", folder, "--to", "mjcf").out
    return sampled(text, result_files.read(folder), driven.joints, driven.effectors)


def table(text: str) -> dict[str, list[str]]:
    """The columns of a CSV by name, no name twice."""
    head, *rows = csv.reader(io.StringIO(text))
    assert len(set(head)) == len(head)
    return dict(zip(head, map(list, zip(*rows, strict=True)), strict=True))


def numbers(columns: dict[str, list[str]], kind: str, names: tuple[str, ...]) -> Array:
    return np.array([[float(x) for x in columns[f"{kind}.{name}"]] for name in names]).T


# --- they are right ------------------------------------------------------------------------------


def test_csv(srgc: Export, driven: Driven, folder: Path, expected: Sampled) -> None:
    ran = srgc("export", folder, "--to", "csv")
    assert (ran.status, ran.err) == (0, "")
    columns, n = table(ran.out), len(driven.joints)
    assert [float(t) for t in columns["t"]] == pytest.approx(list(expected.times), abs=1e-15)
    for kind, values in (
        ("position", expected.states[:, :n]),
        ("velocity", expected.states[:, n:]),
        ("acceleration", expected.accelerations),
    ):
        np.testing.assert_allclose(numbers(columns, kind, driven.joints), values, atol=CLOSE)
    assert np.abs(np.diff(expected.states[:, :n], axis=0)).max() > 1e-3
    inputs = result_files.read(folder)["inputs"]
    for i, name in enumerate(driven.joints):
        stated = [row[i] for row in inputs]
        assert columns[f"input.{name}"] == [*stated, ""]
        efforts = [float(x) for x in columns[f"effort.{name}"]]
        assert efforts == [float(x) for x in (*stated, stated[-1])]
    for number, name in enumerate(driven.effectors):
        for i, axis in enumerate("xyz"):
            if f"effector.{name}.{axis}" in columns:
                found = [float(x) for x in columns[f"effector.{name}.{axis}"]]
                np.testing.assert_allclose(found, expected.tips[:, number, i], atol=CLOSE)
            else:
                assert np.abs(expected.tips[:, number, i]).max() == 0


def test_a_quotient_in_the_certificate_is_a_decimal_in_the_table(
    srgc: Export, tmp_path: Path
) -> None:
    """Certificates may state quotients; tables are read by programs that know numbers alone."""
    driven = CASES["a slide alone"]
    folder = driven.folder(tmp_path / "claimed")
    result_files.alter(folder, lambda c: c["inputs"].__setitem__(0, ["1/3"]), sign=True)
    columns = table(srgc("export", folder, "--to", "csv").out)
    assert columns["input.P_2"][0] == columns["effort.P_2"][0] == "0.3333333333333333"
    stated = [row[0] for row in result_files.read(folder)["inputs"]]
    assert columns["input.P_2"][1:] == [*stated[1:], ""]


def test_the_others_have_the_same_numbers(
    srgc: Export, driven: Driven, folder: Path, tmp_path: Path
) -> None:
    columns = table(srgc("export", folder, "--to", "csv").out)
    document = json.loads(srgc("export", folder, "--to", "json").out)
    message = yaml.safe_load(srgc("export", folder, "--to", "ros2").out)
    assert srgc("export", folder, "--to", "npz", "-o", tmp_path / "m.npz") == Ran(0, "", "")
    with np.load(tmp_path / "m.npz", allow_pickle=False) as file:
        arrays = dict(file)
    assert document["t"] == arrays["t"].tolist() == [float(t) for t in columns["t"]]
    keys = (
        ("position", "q", "positions"),
        ("velocity", "qd", "velocities"),
        ("acceleration", "qdd", None),
        ("effort", "effort", "effort"),
    )
    for name, short, plural in keys:
        values = numbers(columns, name, driven.joints).tolist()
        assert document[name] == arrays[short].tolist() == values
        if plural is not None:
            assert [point[plural] for point in message["points"]] == values
    inputs = [[float(u) for u in row] for row in result_files.read(folder)["inputs"]]
    assert document["input"] == arrays["u"].tolist() == inputs
    tips = document["effector"]
    assert tips == arrays["effectors"].tolist()
    for e, name in enumerate(driven.effectors):
        for i, axis in enumerate("xyz"[: document["dimension"]]):
            found = [str(row[e][i]) for row in tips]
            assert [float(x) for x in found] == [
                float(x) for x in columns[f"effector.{name}.{axis}"]
            ]
    joints = list(driven.joints)
    assert [joint["name"] for joint in document["joints"]] == joints
    assert message["joint_names"] == arrays["joint_names"].tolist() == joints
    assert document["effectors"] == arrays["effector_names"].tolist() == list(driven.effectors)
    assert document["word"] == arrays["word"].tolist() == driven.word.split()


def test_what_was_found_is_exported_as_it_was_stored(srgc: Export, made: Result) -> None:
    """The motor has a state of its own; another program has written the table beside it."""
    for spec, names in (("motor", ("M_2",)), ("slider", ("P_2",))):
        found = made(spec) / "out"
        stored = table((found / "trajectory.csv").read_text(encoding="utf-8"))
        columns = table(srgc("export", found, "--to", "csv").out)
        pairs = {"t": "t", "q1": f"position.{names[0]}", "qd1": f"velocity.{names[0]}"}
        pairs |= {"e1_x": "effector.EN_6.x", "e1_y": "effector.EN_6.y"}
        if spec == "motor":
            pairs |= {"s1": "state.M_2.current", "u1": "input.M_2.voltage"}
        else:
            pairs |= {"u1": "input.P_2"}
        for old, new in pairs.items():
            assert columns[new] == stored[old]
        assert set(columns) == {*pairs.values(), f"acceleration.{names[0]}", f"effort.{names[0]}"}


def test_the_effort_of_a_motor_is_what_its_joint_gets(srgc: Export, made: Result) -> None:
    """By hand: 0.8 N m per ampere; in MuJoCo it causes the acceleration."""
    found = made("motor") / "out"
    columns = table(srgc("export", found, "--to", "csv").out)
    q, v, a, effort = (
        numbers(columns, kind, ("M_2",))
        for kind in ("position", "velocity", "acceleration", "effort")
    )
    current = np.array([float(x) for x in columns["state.M_2.current"]])
    np.testing.assert_allclose(effort[:, 0], 0.8 * current, rtol=0, atol=1e-12)
    assert np.abs(current).max() > 1e-3
    robot = MujocoRobot(srgc("export", found, "--to", "mjcf").out, ["M_2"])
    for k in range(len(q)):
        robot.put(q[k], v[k], effort[k])
        np.testing.assert_allclose(robot.acceleration(), a[k], rtol=0, atol=1e-12)
    document = json.loads(srgc("export", found, "--to", "json").out)
    assert document["states"] == [{"name": "M_2.current", "unit": "A"}]
    assert document["inputs"] == [{"name": "M_2.voltage", "unit": "V"}]


def test_json_says_what_the_joints_are(srgc: Export, tmp_path: Path) -> None:
    case = CASES["space, turning and sliding"]
    document = json.loads(srgc("export", case.folder(tmp_path / "crane"), "--to", "json").out)
    assert document["format"] == "srgc trajectory 1"
    assert (document["dimension"], document["step"], document["steps"]) == (3, 0.0125, 5)
    turn, hinge, slide = document["joints"]
    assert turn == {
        "name": "V_2", "symbols": [2], "kind": "revolute", "axis": "z", "unit": "rad",
        "effort_unit": "N*m", "range": None, "rate": None, "acceleration": None,
        "effort": 7.0,
    }  # fmt: skip
    assert hinge["range"] == [-np.pi / 2, np.pi / 4]
    assert hinge["rate"] == [-1.0, 2.0]
    assert (slide["kind"], slide["unit"], slide["effort_unit"]) == ("prismatic", "m", "N")
    assert slide["effort"] == 20.0
    assert [item["value"] for item in document["parameters"]] == [1.5, 1.25]


# --- the ROS 2 message ---------------------------------------------------------------------------


def message(srgc: Export, folder: Path, *more: str) -> dict:
    content = yaml.safe_load(srgc("export", folder, "--to", "ros2", *more).out)
    assert isinstance(content, dict)
    return content


def test_the_message_has_the_fields_of_its_type(srgc: Export, driven: Driven, folder: Path) -> None:
    """As trajectory_msgs/msg/JointTrajectory, JointTrajectoryPoint and Duration define them."""
    content, n = message(srgc, folder), len(driven.joints)
    assert list(content) == ["header", "joint_names", "points"]
    assert content["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    before = -1
    for point in content["points"]:
        assert list(point) == [
            "positions", "velocities", "accelerations", "effort", "time_from_start",
        ]  # fmt: skip
        for key in ("positions", "velocities", "effort"):
            assert len(point[key]) == n
            assert all(type(value) is float for value in point[key])
        assert point["accelerations"] == []
        time = point["time_from_start"]
        assert list(time) == ["sec", "nanosec"]
        assert all(type(value) is int for value in time.values())
        assert 0 <= time["nanosec"] < 10**9
        total = time["sec"] * 10**9 + time["nanosec"]
        assert total > before
        before = total
    assert message(srgc, folder, "--no-effort")["points"] == [
        {**point, "effort": []} for point in content["points"]
    ]


def test_times_are_rounded_once_each(srgc: Export, tmp_path: Path) -> None:
    text = replaced(SLIDER, "10 steps of 0.2 s", "10 steps of (1/3) s")
    content = message(srgc, claim_found(tmp_path / "a", text, "B eps P eps M eps EN", []))
    times = [point["time_from_start"] for point in content["points"]]
    assert times[2] == {"sec": 0, "nanosec": 666666667}
    assert times[10] == {"sec": 3, "nanosec": 333333333}


@pytest.mark.parametrize(
    ("step", "reason"), [("3e-10 s", "less than a nanosecond"), ("3e8 s", "2147483648 s or more")]
)
def test_times_that_are_none_of_a_message(
    srgc: Export, tmp_path: Path, step: str, reason: str
) -> None:
    text = replaced(SLIDER, "10 steps of 0.2 s", f"10 steps of {step}")
    ran = srgc(
        "export", claim_found(tmp_path / "a", text, "B eps P eps M eps EN", []), "--to", "ros2"
    )
    assert (ran.status, ran.out) == (2, "")
    assert reason in ran.err


# --- npz -----------------------------------------------------------------------------------------


def test_an_npz_is_the_same_whenever_it_is_written(
    srgc: Export, tmp_path: Path, driven: Driven, folder: Path
) -> None:
    paths = [tmp_path / name for name in ("a.npz", "b.npz")]
    assert srgc("export", folder, "--to", "npz", "-o", paths[0]) == Ran(0, "", "")
    with zipfile.ZipFile(paths[0]) as archive:
        assert {item.date_time for item in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert archive.testzip() is None
    with np.load(paths[0], allow_pickle=False) as arrays:
        n, k = len(driven.joints), result_files.read(folder)["steps"]
        assert arrays["q"].shape == arrays["qd"].shape == (k + 1, n)
        assert arrays["u"].shape == (k, n)
        assert arrays["s"].shape == (k + 1, 0)
        assert arrays["effectors"].shape[:2] == (k + 1, len(driven.effectors))
        assert arrays["spec_sha256"][0] == result_files.read(folder)["spec_sha256"]


def test_same_folder_same_bytes(srgc: Export, tmp_path: Path) -> None:
    """A single file is that of the folder of all, which another process writes elsewhere."""
    folder = CASES["branches"].folder(tmp_path / "arms")
    files = {
        "urdf": "robot.urdf", "mjcf": "robot.xml", "csv": "trajectory.csv",
        "json": "trajectory.json", "ros2": "trajectory.yaml", "npz": "trajectory.npz",
    }  # fmt: skip
    arguments = ["export", folder, "--to", "all", "-o", tmp_path / "all"]
    process = srgc_process(arguments, tmp_path, PYTHONHASHSEED="7", TZ="Asia/Tokyo")
    for form in files:
        assert srgc("export", folder, "--to", form, "-o", tmp_path / form) == Ran(0, "", "")
    out, err = process.communicate()
    assert (process.returncode, err) == (0, b"")
    controller = {"controller.c", "controller.py", "controller.npz"}
    expected = {*files.values(), *controller, "torques.csv", "replay.py"}
    assert {Path(line).name for line in out.decode().splitlines()} == expected
    assert {path.name for path in (tmp_path / "all").iterdir()} == expected
    for form, name in files.items():
        assert (tmp_path / form).read_bytes() == (tmp_path / "all" / name).read_bytes(), form


# --- robots of other kinds -----------------------------------------------------------------------


@pytest.mark.parametrize("form", MOTIONS)
def test_a_robot_without_degrees_of_freedom(srgc: Export, tmp_path: Path, form: str) -> None:
    text = replaced(TURNER, " and starts with B eps JO", "")
    folder = claim_found(tmp_path / "pole", text, "B eps L eps EN", ["1.5"])
    assert srgc("export", folder, "--to", form, "-o", tmp_path / "x") == Ran(0, "", "")
    content = (tmp_path / "x").read_bytes()
    if form == "csv":
        assert content.decode().splitlines()[1] == "0,1.5,0"
    elif form == "json":
        assert json.loads(content)["effector"] == [[[1.5, 0.0]]] * 11
    elif form == "ros2":
        assert yaml.safe_load(content)["joint_names"] == []
    else:
        with np.load(tmp_path / "x") as arrays:
            assert arrays["q"].shape == (11, 0)


def test_motions_need_no_joint_per_coordinate(srgc: Export, tmp_path: Path) -> None:
    folder = claim_found(tmp_path / "linkage", LINKAGE, "B eps JO eps L eps EN", ["1.5"])
    columns = table(srgc("export", folder, "--to", "csv").out)
    assert columns["position.JO_2"] == ["0"] * 11
    assert columns["effector.EN_6.x"] == ["2.5"] * 11
    made = srgc("export", folder, "--to", "all", "-o", tmp_path / "all")
    assert made.status == 0
    assert sorted(path.name for path in (tmp_path / "all").iterdir()) == [
        "controller.c", "controller.npz", "controller.py",
        "trajectory.csv", "trajectory.json", "trajectory.npz", "trajectory.yaml",
    ]  # fmt: skip
    for name in ("robot.urdf", "robot.xml", "replay.py"):
        assert f"note: no {name}: the robot cannot be exported: degree of freedom 1" in made.err


HOSTILE = (
    TURNER.replace("JO", "t")
    .replace("EN", "on")
    .replace("module L ", "module position ")
    .replace("L.length", "position.length")
    .replace("L.density", "position.density")
    .replace("N eps L;", "N eps position;")
    .replace("edge eps;", 'edge "---#:{\'";')
    .replace(" eps ", ' "---#:{\'" ')
)


def test_hostile_names(srgc: Export, tmp_path: Path) -> None:
    """Modules called like columns and truth values, a symbol that means things in YAML."""
    edge = "---#:{'"
    word = ["B", edge, "t", edge, "position", edge, "on"]
    folder = claim_found(tmp_path / "claimed", HOSTILE, word, ["1.5"])
    result_files.alter(folder, lambda c: c.update(inputs=[["0.5"]] * 10), sign=True)
    target = tmp_path / "it's all"
    assert srgc("export", folder, "--to", "all", "-o", target).status == 0
    content = yaml.safe_load((target / "trajectory.yaml").read_text(encoding="utf-8"))
    assert content["joint_names"] == ["t_2"]
    columns = table((target / "trajectory.csv").read_text(encoding="utf-8"))
    assert {"t", "position.t_2", "effector.on_6.x"} < set(columns)
    document = json.loads((target / "trajectory.json").read_text(encoding="utf-8"))
    assert document["word"] == word
    ran = subprocess.run(
        [sys.executable, target / "replay.py"], capture_output=True, text=True, check=False
    )
    assert (ran.returncode, ran.stderr) == (0, "")


# --- what is refused -----------------------------------------------------------------------------


def refused(ran: Ran, reason: str) -> None:
    assert (ran.status, ran.out) == (2, "")
    assert reason in ran.err
    assert ran.err.count("\n") == 1


def test_usage(srgc: Export, tmp_path: Path) -> None:
    folder = CASES["friction"].folder(tmp_path / "arm")
    refused(srgc("export", folder, "--to", "csv", "--no-effort"), "--to ros2 alone")
    for form in ("all", "controller", "mujoco"):
        refused(srgc("export", folder, "--to", form), "name a folder with -o")
        refused(srgc("export", folder, "--to", form, "-o", "-"), "name a folder with -o")
        (tmp_path / "file").write_bytes(b"")
        refused(srgc("export", folder, "--to", form, "-o", tmp_path / "file"), "File exists")
    assert (tmp_path / "file").read_bytes() == b""


@pytest.mark.parametrize("form", ["all", "controller", "mujoco"])
def test_folders_do_not_overwrite_results(srgc: Export, tmp_path: Path, form: str) -> None:
    folder = CASES["friction"].folder(tmp_path / "arm")
    (folder / "trajectory.csv").write_bytes(b"kept")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    (tmp_path / "link").symlink_to(folder)
    # No result has the name of a controller's file, so that it may be beside them.
    beside = [] if form == "controller" else [folder, tmp_path / "link"]
    for output in (*beside, folder / "spec", folder / "designs" / "new"):
        refused(srgc("export", folder, "--to", form, "-o", output), "is one of the results")
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    assert srgc("export", folder, "--to", form, "-o", folder / "away").status == 0
    if form == "controller":
        assert srgc("export", folder, "--to", form, "-o", folder).status == 0
        assert {path: path.read_bytes() for path in before} == before
    assert (
        folder / "away" / ("controller.c" if form == "controller" else "trajectory.csv")
    ).is_file()


def test_inputs_that_are_not_those_of_the_task(srgc: Export, tmp_path: Path) -> None:
    folder = CASES["friction"].folder(tmp_path / "arm")
    result_files.alter(folder, lambda c: c.update(inputs=c["inputs"][1:]), sign=True)
    for form in MOTIONS:
        refused(srgc("export", folder, "--to", form), "are not those of the task")


def test_motions_that_are_no_doubles(srgc: Export, tmp_path: Path) -> None:
    folder, torque = CASES["merged joints"].folder(tmp_path / "arm"), f"1{200 * '0'}"
    result_files.alter(folder, lambda c: c["inputs"][3].__setitem__(0, torque), sign=True)
    refused(srgc("export", folder, "--to", "csv"), "cannot be simulated in doubles")


def test_dynamics_that_torques_do_not_hold(srgc: Export, made: Result, tmp_path: Path) -> None:
    found = made("motor") / "out"
    ran = srgc("export", found, "--to", "mujoco", "-o", tmp_path / "m")
    refused(ran, "MJCF does not hold the dynamics of their own of M (symbol 2)")
    assert not (tmp_path / "m").exists()
    ran = srgc("export", found, "--to", "all", "-o", tmp_path / "all")
    assert ran.status == 0
    assert "note: no replay.py: MJCF does not hold" in ran.err
    assert "every joint has a plain motor" in ran.err
    assert (tmp_path / "all" / "robot.xml").is_file()
    assert not (tmp_path / "all" / "replay.py").exists()
    text = srgc("export", found, "--to", "ros2")
    assert "# the dynamics of their own of M (symbol 2) are left out" in text.out
