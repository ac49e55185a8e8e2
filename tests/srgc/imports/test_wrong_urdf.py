"""URDF and xacro files that are wrong or hostile: one message, and nothing else is read."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from srgc.cli import run
from srgc.faults import UsageFault
from srgc.imports.urdf.urdf_import import urdf_import
from tests.oracles.urdf_files import LIMIT, joint, link, robot

A, B, C = link("a"), link("b"), link("c")
MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'
XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'

WRONG = {
    "negative mass": (robot(A, link("b", -2), joint("revolute", LIMIT)), r":3: .*mass -2 kg"),
    "negative moment": (
        robot(A, link("b", 2, -1), joint("revolute", LIMIT)),
        r":3: .*principal moment -1 kg",
    ),
    "no limits": (robot(A, B, joint("revolute")), r":4: joint `j` lacks <limit"),
    "floating": (robot(A, B, joint("floating")), r":4: joint `j` is fl(?s:.*)--fix j"),
    "no such type": (robot(A, B, joint("ball")), r":4: joint `j` has the type `ball`(?s:.*) rev"),
    "no axis": (robot(A, B, joint("revolute", LIMIT, axis="0 0 0")), r":4: .* the axis 0"),
    "an axis of two": (robot(A, B, joint("revolute", LIMIT, axis="0 1")), r":4: .*3 numbers are"),
    "nan": (robot(A, B, joint("revolute", LIMIT, axis="nan 0 1")), r":4: .*not finite"),
    "words": (robot(A, B, joint("revolute", LIMIT, axis="up 0 1")), r":4: .*no number"),
    "backwards": (
        robot(A, B, joint("revolute", '<limit lower="1" upper="-1" effort="5" velocity="2"/>')),
        r":4: joint `j` has a range from 1 down to -1",
    ),
    "a closed chain": (
        robot(A, B, C, joint("revolute", LIMIT),
              joint("revolute", LIMIT, name="k", parent="b", child="c"),
              joint("revolute", LIMIT, name="l", parent="c", child="b")),
        r":7: joint `l` carries link `b`, which joint `j` carries already",
    ),
    "a loop apart": (
        robot(A, B, C, joint("revolute", LIMIT, name="k", parent="b", child="c"),
              joint("revolute", LIMIT, name="l", parent="c", child="b")),
        r":3: link `b` is in a loop",
    ),
    "two roots": (robot(A, B, C, joint("revolute", LIMIT)), r":1: one link.*`a`, `c`"),
    "no mass": (robot(A, '<link name="b"/>', joint("revolute", LIMIT)), r":4: .*without any mass"),
    "mimics nothing": (
        robot(A, B, joint("revolute", LIMIT + '<mimic joint="jj"/>')),
        r":4: joint `j` mimics `jj`, which is not a joint(?s:.*)did you mean `j`",
    ),
    "twice": (robot(A, A), r":3: a second link `a`, after that of line 2"),
    "no such link": (
        robot(A, B, joint("revolute", LIMIT, parent="aa")), r":4: there is no link `aa`",
    ),
    "a sphere of 0": (
        robot(link("a", more='<collision><geometry><sphere radius="0"/></geometry></collision>')),
        r":2: `radius` is `0`, and has to be above 0",
    ),
    "a flat mesh": (
        robot(link("a", more=MESH.format('m.stl" scale="1 0 1'))),
        r":2: `scale` is `1 0 1`, which leaves a mesh flat",
    ),
    "no robot": ('<sdf version="1.6"/>', r":1: the root is <sdf>"),
    "cut off": (robot(A, B, joint("revolute", LIMIT))[:-60], r":4:99: .*this is not XML"),
    "empty": ("", r"it is empty"),
    "entities": (
        '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]><robot name="&b;"/>',
        r"document type|not XML",
    ),
    "a file as an entity": (
        '<!DOCTYPE r [<!ENTITY x SYSTEM "secret.txt">]><robot name="r">&x;</robot>',
        r"document type|not XML",
    ),
    "deep": ("<a>" * 5000 + "</a>" * 5000, r"this is not XML"),
    "a mesh outside": (robot(link("a", more=MESH.format("../m.stl"))), r"leads out of the folder"),
    "a mesh at the root": (robot(link("a", more=MESH.format("/m.stl"))), r"leads out of the fold"),
    "a package nowhere": (
        robot(link("a", more=MESH.format("package://nope/m.stl"))),
        r"resolves nowhere(?s:.*)--package nope=DIR",
    ),
    "a mesh of the net": (robot(link("a", more=MESH.format("http://x.y/m.stl"))), r"is not read"),
    "no such mesh": (robot(link("a", more=MESH.format("m.stl"))), r"`m.stl` is no file that"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_one_message(name, tmp_path, capsys, monkeypatch):
    text, says = WRONG[name]
    says = re.sub(r"^:(\d): ", r":\1:\\d+: error\\[SRG0803\\]: ", says)
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "m.stl").write_text("solid\nendsolid\n")
    (inner / "secret.txt").write_text("SECRET")
    (inner / "r.urdf").write_text(text)
    monkeypatch.chdir(inner)
    with pytest.raises(UsageFault, match=says):
        urdf_import(Path("r.urdf"))
    assert run(["import", "urdf", "r.urdf"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert re.match(r"r\.urdf:\d+:\d+: error\[SRG080[123]\]: ", err)
    assert len(err.splitlines()) <= 4
    assert "SECRET" not in err
    assert sorted(path.name for path in inner.iterdir()) == ["r.urdf", "secret.txt"]


def test_a_link_out_of_the_folder(tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "m.stl").write_text("solid\nendsolid\n")
    (inner / "m.stl").symlink_to(tmp_path / "m.stl")
    (inner / "r.urdf").write_text(robot(link("a", more=MESH.format("m.stl"))))
    with pytest.raises(UsageFault, match="leads out of the folder"):
        urdf_import(inner / "r.urdf")


def test_too_many_bytes(tmp_path):
    file = tmp_path / "r.urdf"
    with file.open("wb") as out:
        out.truncate(2**25)
    with pytest.raises(UsageFault, match="it has 33,554,432 bytes"):
        urdf_import(file)


def test_files_that_are_there_are_kept(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("r.urdf").write_text(robot(A, B, joint("revolute", LIMIT)))
    Path("r.srg").write_text("mine")
    assert run(["import", "urdf", "r.urdf"]) == 2
    assert "r.srg is there already; --force replaces it" in capsys.readouterr().err
    assert Path("r.srg").read_text() == "mine"
    assert run(["import", "urdf", "r.urdf", "--force"]) == 0
    assert Path("r.srg").read_text().startswith("// r, imported by srgc")
    # The same once more is no harm.
    assert run(["import", "urdf", "r.urdf"]) == 0


HOSTILE = {
    "outside": ('<xacro:include filename="../x.xacro"/>', "outside the folder"),
    "etc": ('<xacro:include filename="/etc/hostname"/>', "outside the folder"),
    "yaml": ("<link name=\"${xacro.load_yaml('/etc/hostname')}\"/>", "outside the folder"),
    "environment": ('<link name="$(env HOME)"/>', "'HOME' is not set"),
    "package": ('<xacro:include filename="$(find nope)/a.xacro"/>', "--package nope=DIR"),
    "recursion": ('<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>', "recursion"),
    "python": ('<link name="${python.type(1).__class__}"/>', "__class__"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE)
def test_macros_read_nothing_else(name, tmp_path):
    text, says = HOSTILE[name]
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "x.xacro").write_text(XACRO.format('<link name="SECRET"/>'))
    (inner / "r.xacro").write_text(XACRO.format(text))
    with pytest.raises(UsageFault, match=says) as caught:
        urdf_import(inner / "r.xacro")
    assert "SECRET" not in str(caught.value)
    assert "Errno" not in str(caught.value)
    assert "Python" not in str(caught.value)


@pytest.mark.slow
def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "part.xacro")
    (tmp_path / "r.xacro").write_text(XACRO.format('<xacro:include filename="part.xacro"/>'))
    with pytest.raises(UsageFault, match="not a plain file"):
        urdf_import(tmp_path / "r.xacro")


CHANGES = {
    "truncate": "os.truncate({path!r}, 0)",
    "chmod": "os.chmod({path!r}, 0)",
    "flags": "os.open({path!r}, os.O_WRONLY | os.O_TRUNC)",
    "create": "os.open({path!r} + 'x', os.O_RDONLY | os.O_CREAT)",
    "mode": "open({path!r}, 'r+')",
    "list": "os.remove({path!r})",
}


@pytest.mark.parametrize("name", CHANGES)
def test_the_fence_lets_nothing_change(name, tmp_path):
    path = tmp_path / "kept"
    path.write_text("content")
    code = (
        "import os; from srgc.imports.urdf.xacro_process import fence\n"
        f"fence([{str(tmp_path)!r}])\n"
        f"assert open({str(path)!r}).read() == 'content'\n"
        f"assert os.listdir({str(tmp_path)!r}) == ['kept']\n"
    )
    command = [sys.executable, "-c", code + CHANGES[name].format(path=str(path))]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "PermissionError" in done.stderr.splitlines()[-1]
    assert [each.name for each in tmp_path.iterdir()] == ["kept"]
    assert path.read_text() == "content"


@pytest.mark.slow
def test_modules_beside_the_file_are_not_run(tmp_path):
    """A folder of strangers is no place to import Python from."""
    for name in ("json", "xacro", "yaml", "resource", "srgc"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'run')!r}, 'w')\n")
    (tmp_path / "r.xacro").write_text(XACRO.format(link("a")))
    here = Path.cwd()
    os.chdir(tmp_path)
    try:
        found = urdf_import(Path("r.xacro"))
    finally:
        os.chdir(here)
    assert "module R_Base" in found.text
    assert not (tmp_path / "run").exists()
    assert str(tmp_path) not in sys.path


@pytest.mark.slow
def test_xacro_with_arguments_and_includes(tmp_path):
    (tmp_path / "part.xacro").write_text(
        XACRO.format(f'<xacro:macro name="leg" params="m">{link("a").replace("2.0", "${m*1.5}")}'
                     "</xacro:macro>")
    )  # fmt: skip
    (tmp_path / "r.urdf.xacro").write_text(
        XACRO.format('<xacro:arg name="mass" default="1"/><xacro:include filename="part.xacro"/>'
                     '<xacro:leg m="$(arg mass)"/>')
    )  # fmt: skip
    assert "mass: 1.5 kg" in urdf_import(tmp_path / "r.urdf.xacro").text
    with_four = urdf_import(tmp_path / "r.urdf.xacro", arguments=["mass:=4"])
    assert "mass: 6 kg" in with_four.text


def test_a_library_that_is_missing(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("r.urdf").write_text(robot(A))
    monkeypatch.setitem(sys.modules, "yourdfpy", None)
    assert run(["import", "urdf", "r.urdf"]) == 2
    assert capsys.readouterr().err == (
        'error: an import needs the library yourdfpy: pip install "srgc[import]"\n'
    )


def test_an_option_of_another_kind(tmp_path, capsys):
    file = tmp_path / "modules.json"
    file.write_text("[]")
    assert run(["import", "timor", str(file), "--effector", "tip"]) == 2
    assert "--effector does not go with `srgc import timor`" in capsys.readouterr().err


@pytest.mark.parametrize("value", ["-1", "0", "nan", "inf"])
@pytest.mark.parametrize("option", ["--density", "--detail"])
def test_numbers_that_are_none_of_a_body(option, value, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("r.urdf").write_text(robot(A, '<link name="b"/>', joint("fixed")))
    assert run(["import", "urdf", "r.urdf", option, value]) == 2
    assert option in capsys.readouterr().err
    assert not Path("r.srg").exists()
