"""Names of joints, links and effectors in exports: those of the modules, or from their places."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree.ElementTree import Element, fromstring

import mujoco
import pytest
import xacro
import yaml

import srgc as interface
from grammar_lang.diagnostics.diagnostic import Code
from tests.conftest import ROOT
from tests.oracles import result_files
from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import TURNER
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]

TWO_TURNS = "B eps JO eps L eps JO eps L eps EN"


def named(joint: str = "", link: str = "", base: str = "", tool: str = "") -> str:
    """The specification of an arm with names as they are written in the language."""
    text = TURNER
    parts = [("joint; dof q", "", joint), ("link;", link, ""), ("base;", base, "")]
    for role, part, dof in [*parts, ("effector;", tool, "")]:
        if part:
            text = text.replace(f"role {role}", f"role {role} named {part};")
        if dof:
            text = text.replace("in [-180, 180] deg;", f"in [-180, 180] deg named {dof};")
    return text


def folder_of(tmp_path: Path, text: str, word: str = TWO_TURNS) -> Path:
    folder = claim_found(tmp_path / "claimed", text, word, ["1.5", "1.25"][: word.count(" L ")])
    joints = len(re.findall("JO eps L", word))  # two joints in one place are one
    result_files.alter(folder, lambda c: c.update(inputs=[["0.5"] * joints] * 10), sign=True)
    return folder


def parts(document: Element) -> tuple[list[str], list[str]]:
    """The names of the joints that move, and of the links."""
    joints = [each for each in document.findall("joint") if each.get("type") != "fixed"]
    return [str(e.get("name")) for e in joints], [
        str(e.get("name")) for e in document.findall("link")
    ]


def test_modules_without_names_have_places(srgc: Export, tmp_path: Path) -> None:
    ran = srgc("export", folder_of(tmp_path, TURNER), "--to", "urdf")
    assert parts(fromstring(ran.out)) == (["JO_2", "JO_6"], ["B_0", "L_4", "L_8", "EN_10"])


CART = """\
module Cart { role base; dof px: prismatic x in [-3, 3] m; dof py: prismatic y in [-3, 3] m; }
module Hand { role effector; }
grammar G { start N; whole: N -> Cart Hand; }
semantics G {
  whole {
    this.at = move(x, Cart.px) * move(y, Cart.py);
    point(frame: this.at, mass: 2 kg);
    effector(frame: this.at);
  }
}
workspace W { plane xy; bounds box [-3, 3] x [-3, 3] m; region H box [0, 1] x [0, 1] m; }
task T { robot G; workspace W; start in H; reach H; effort <= 5 N; horizon 10 steps of 0.1 s; }
"""


def test_joints_of_one_module_have_the_names_of_its_degrees_of_freedom(
    srgc: Export, tmp_path: Path
) -> None:
    folder = claim_found(tmp_path / "claimed", CART, "Cart Hand", [])
    result_files.alter(folder, lambda c: c.update(inputs=[["0.5", "0.5"]] * 10), sign=True)
    mjcf = fromstring(srgc("export", folder, "--to", "mjcf").out)
    assert [each.get("name") for each in mjcf.iter("joint")] == ["Cart_0_px", "Cart_0_py"]


def test_a_name_that_is_taken_gets_a_number(srgc: Export, tmp_path: Path) -> None:
    text = named('"hinge"', '"tube"', '"foot"', '"tube"')
    ran = srgc("export", folder_of(tmp_path, text), "--to", "urdf")
    joints, links = parts(fromstring(ran.out))
    assert joints == ["hinge", "hinge_no2"]
    assert links == ["foot", "tube", "tube_no2", "tube_no3"]


def test_merged_joints_have_all_names(srgc: Export, tmp_path: Path) -> None:
    text = named('"a"').replace("starts with B eps JO", "contains JO")
    folder = folder_of(tmp_path, text, "B eps JO eps JO eps L eps EN")
    mjcf = fromstring(srgc("export", folder, "--to", "mjcf").out)
    assert [each.get("name") for each in mjcf.iter("joint")] == ["a_a"]


def test_the_link_of_a_joint_with_a_name(srgc: Export, tmp_path: Path) -> None:
    """A module that moves gives its link a name, before the module with the role link."""
    text = TURNER.replace("role joint;", 'role joint; named "forearm";')
    ran = srgc("export", folder_of(tmp_path, text, "B eps JO eps L eps EN"), "--to", "urdf")
    assert parts(fromstring(ran.out)) == (["JO_2"], ["B_0", "forearm", "EN_6"])


def test_a_link_may_be_called_as_a_joint(srgc: Export, tmp_path: Path) -> None:
    text = named('"wrist"', '"wrist"', '"wrist_link"')
    ran = srgc("export", folder_of(tmp_path, text, "B eps JO eps L eps EN"), "--to", "urdf")
    assert parts(fromstring(ran.out)) == (["wrist"], ["wrist_link", "wrist", "EN_6"])


def test_no_link_is_the_world(srgc: Export, tmp_path: Path) -> None:
    """MuJoCo, tf and SRDF have a frame of that name, in which the robot stands."""
    folder = folder_of(tmp_path, named(base='"world"'), "B eps JO eps L eps EN")
    model = mujoco.MjModel.from_xml_string(srgc("export", folder, "--to", "mjcf").out)
    assert [model.body(i).name for i in range(2)] == ["world", "world_no2"]
    package = tmp_path / "package"
    assert srgc("export", folder, "--to", "ros2-package", "-o", package).status == 0
    (written,) = package.rglob("*.srdf")
    (virtual,) = fromstring(written.read_text(encoding="utf-8")).iter("virtual_joint")
    assert (virtual.get("parent_frame"), virtual.get("child_link")) == ("world", "world_no2")


@pytest.mark.parametrize("taken", ["t", "robot", "load"])
def test_no_joint_is_another_column(srgc: Export, tmp_path: Path, taken: str) -> None:
    text = named(f'"{taken}"').replace("reach T;", "reach T; carry 0.5 kg from S to T;")
    folder = claim_found(tmp_path / "claimed", text, "B eps JO eps L eps EN", ["1.5"])
    inputs = [["0.5", "0"]] * 5 + [["0.5", "1"]] * 5
    result_files.alter(folder, lambda c: c.update(inputs=inputs), sign=True)
    target = tmp_path / "all"
    assert srgc("export", folder, "--to", "all", "-o", target).status == 0
    for name in ("trajectory.csv", "torques.csv"):
        head, *_ = csv.reader(io.StringIO((target / name).read_text(encoding="utf-8")))
        assert len({*head}) == len(head), (name, head)
    document = json.loads((target / "trajectory.json").read_text(encoding="utf-8"))
    assert [each["name"] for each in document["inputs"]] == [f"{taken}_no2", "load"]


def test_the_joint_that_holds_an_effector_has_its_own_name(srgc: Export, tmp_path: Path) -> None:
    text = named('"hand_fixed"', tool='"hand"')
    ran = srgc("export", folder_of(tmp_path, text, "B eps JO eps L eps EN"), "--to", "urdf")
    found = [each.get("name") for each in fromstring(ran.out).findall("joint")]
    assert found == ["hand_fixed", "hand_fixed_no2"]


HOSTILE = (
    """'a"b, c\\d <e> & {%s}*/ --> # é'""",
    '"x: [y] ${z} - -- $(find w)"',
    '"*/ } \\\\"',
)


@pytest.mark.parametrize("first", range(3))
def test_names_that_mean_things_elsewhere(srgc: Export, tmp_path: Path, first: int) -> None:
    joint, link, base = (HOSTILE[(first + k) % 3] for k in range(3))
    folder = folder_of(tmp_path, named(joint, link, base), "B eps JO eps L eps EN")
    plain = [each[1:-1] for each in (joint, link, base)]
    target = tmp_path / "all"
    assert srgc("export", folder, "--to", "all", "-o", target).status == 0
    texts = {path.suffix: path for path in target.iterdir()}
    urdf = fromstring(texts[".urdf"].read_text(encoding="utf-8"))
    assert parts(urdf) == ([plain[0]], [plain[2], plain[1], "EN_6"])
    model = mujoco.MjModel.from_xml_string(srgc("export", folder, "--to", "mjcf").out)
    assert model.joint(0).name == plain[0]
    content = yaml.safe_load((target / "trajectory.yaml").read_text(encoding="utf-8"))
    assert content["joint_names"] == plain[:1]
    document = json.loads((target / "trajectory.json").read_text(encoding="utf-8"))
    assert [each["name"] for each in document["joints"]] == plain[:1]
    head, *_ = csv.reader(io.StringIO((target / "trajectory.csv").read_text(encoding="utf-8")))
    assert f"position.{plain[0]}" in head
    controller: dict[str, object] = {}
    exec((target / "controller.py").read_text(encoding="utf-8"), controller)
    assert controller["INPUTS"] == (f"{plain[0]} (N*m)",)
    code = (target / "controller.c").read_text(encoding="utf-8")
    assert code.count("/*") == code.count("*/")


def test_a_ros_package_with_such_names(srgc: Export, tmp_path: Path) -> None:
    joint, link, base = HOSTILE
    folder = folder_of(tmp_path, named(joint, link, base), "B eps JO eps L eps EN")
    package = tmp_path / "package"
    assert srgc("export", folder, "--to", "ros2-package", "-o", package).status == 0
    (written,) = package.rglob("*.urdf.xacro")
    expanded = fromstring(xacro.process_file(str(written)).toxml())
    assert parts(expanded) == ([joint[1:-1]], [base[1:-1], link[1:-1], "EN_6"])
    limits = yaml.safe_load((package / "config" / "joint_limits.yaml").read_text(encoding="utf-8"))
    assert [*limits["joint_limits"]] == [joint[1:-1]]


def test_an_import_keeps_the_names_of_a_urdf(srgc: Export, tmp_path: Path) -> None:
    """From a URDF to a specification, to a result, and to a URDF."""
    source = ROOT / "specs" / "robots" / "scara.urdf"
    assert srgc("import", "urdf", source, "-o", tmp_path / "scara.srg").status == 0
    text = (tmp_path / "scara.srg").read_text(encoding="utf-8")
    text += """
workspace Cell { space xyz; bounds box [-1, 1] x [-1, 1] x [0, 1] m;
  region S box [45, 55] x [-5, 5] x [20, 30] cm; target T box [-5, 5] x [40, 50] x [20, 30] cm; }
task Load { robot Scara; workspace Cell; start in S at rest; reach T; horizon 20 steps of 0.05 s; }
"""
    (word,) = interface.words(interface.load(tmp_path / "scara.srg"), limit=2)
    folder = claim_found(tmp_path / "claimed", text, word, [])
    found = parts(fromstring(srgc("export", folder, "--to", "urdf").out))
    expected = parts(fromstring(source.read_text(encoding="utf-8")))
    assert found[0] == expected[0]
    assert {*found[1]} <= {*expected[1]} | {"Scara_Tip_5"}
    assert {*expected[1]} - {*found[1]} <= {"tool_frame", "world", "base"}


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (named(link='""'), Code.BAD_VALUE),
        (named(link='" tube"'), Code.BAD_VALUE),
        (named(joint=f'"{"a" * 201}"'), Code.BAD_VALUE),
        (named(joint='"a\tb"'), Code.BAD_VALUE),
        (named(link='"a"; named "b"'), Code.REPEATED_CLAUSE),
    ],
)
def test_what_is_no_name(text: str, code: Code) -> None:
    (found,) = [each for each in interface.check(text=text) if each.severity.value == "error"]
    assert found.code is code
    assert re.search("exports|printable", found.hint)
