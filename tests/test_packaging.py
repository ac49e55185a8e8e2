"""What srgc needs and offers as a package, and that its main job gets by without any extra."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version
from PIL import Image

import srgc
import srgc.cli
from srgc.version import VERSION
from tests.oracles import pages

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS: Mapping[str, list[str]] = PROJECT["optional-dependencies"]
FOR_DEVELOPERS = {"bench", "docs", "oracles", "test"}
IMPORTED = {"pillow": "PIL", "pycollada": "collada"}
"""Libraries that are imported under another name."""


def names(requirements: list[str]) -> set[str]:
    return {canonicalize_name(Requirement(one).name) for one in requirements}


NEEDED = names(PROJECT["dependencies"])
OFFERED = {name: names(libraries) for name, libraries in EXTRAS.items()}
OPTIONAL = set().union(*(OFFERED[name] for name in OFFERED.keys() - FOR_DEVELOPERS))

WITHOUT = """\
import contextlib, io, json, sys
for name in json.loads(sys.argv[1]):
    sys.modules[name] = None
from srgc.cli import run
for command in json.loads(sys.argv[2]):
    with contextlib.redirect_stdout(io.StringIO()):
        assert run(command) == 0, command
"""


def test_the_main_job_needs_no_extra(made: Callable[[str], Path], tmp_path: Path) -> None:
    """Everything is the same, byte for byte, as where all libraries are installed."""
    shutil.copyfile(made("slider") / "slider.srg", tmp_path / "slider.srg")
    absent = sorted(IMPORTED.get(name, name.replace("-", "_")) for name in OPTIONAL)
    commands = [
        ["check", "slider.srg"],
        ["synth", "slider.srg", "-o", "bare", "--quiet"],
        ["verify", "bare"],
        ["why", "bare"],
        ["report", "bare"],
        ["export", "bare", "--to", "urdf", "-o", "urdf"],
    ]
    program = (sys.executable, "-c", WITHOUT, json.dumps(absent), json.dumps(commands))
    here = {**os.environ, "PYTHONPATH": str(ROOT)}
    ran = subprocess.run(
        program, cwd=tmp_path, env=here, capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr
    for file in ("design.json", "certificate.json", "trajectory.csv"):
        kept = made("slider") / "out" / file
        assert (tmp_path / "bare" / file).read_bytes() == kept.read_bytes()


YARD = """\
workspace Yard { plane xy; bounds box [0, 4] x [0, 4] m; obstacles from "yard.yaml"; }
"""
HEADER = "resolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.6\nfree_thresh: 0.2\n"


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    def forget(library: str) -> None:
        for name in [library, *sys.modules]:
            if name.partition(".")[0] == library:
                monkeypatch.setitem(sys.modules, name, None)

    return forget


def test_a_map_in_png_without_pillow(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    without: Callable[[str], None],
) -> None:
    """The same map as PGM needs no library, and has the same obstacles."""
    monkeypatch.chdir(tmp_path)
    picture = Image.fromarray(np.array([[255, 0], [255, 255]], dtype=np.uint8))
    for kind, form in (("png", "PNG"), ("pgm", "PPM")):
        file = BytesIO()
        picture.save(file, form)
        Path(f"yard.{kind}").write_bytes(file.getvalue())
    Path("yard.srg").write_text(YARD, encoding="utf-8")
    without("PIL")
    Path("yard.yaml").write_text(f"image: yard.pgm\n{HEADER}", encoding="utf-8")
    assert srgc.cli.run(["check", "yard.srg"]) == 0
    capsys.readouterr()
    Path("yard.yaml").write_text(f"image: yard.png\n{HEADER}", encoding="utf-8")
    assert srgc.cli.run(["check", "yard.srg"]) == 1
    said = capsys.readouterr().out
    assert "yard.yaml:1:8: error[SRG0109]: a map in PNG needs the library Pillow\n" in said
    assert 'hint: install it with `pip install "srgc[png]"`, or save the image as PGM\n' in said
    assert said.count("error[") == 1


def test_a_graph_without_networkx(without: Callable[[str], None]) -> None:
    program = srgc.load(ROOT / "specs" / "planar_arm.srg")
    graph = srgc.graph(program, "words", depth=3)
    assert len(graph.networkx()) == len(graph.picture.nodes)
    without("networkx")
    with pytest.raises(srgc.SrgcError) as raised:
        graph.networkx()
    assert str(raised.value) == 'this needs the library networkx: pip install "srgc[networkx]"'


def test_what_is_needed_is_offered_by_no_extra() -> None:
    assert not NEEDED & OPTIONAL
    assert OFFERED["test"] >= OPTIONAL


def pinned(lock: str) -> dict[str, str]:
    """The versions in a lock file, by name; each with a digest."""
    text = (ROOT / "requirements" / f"{lock}.lock").read_text(encoding="utf-8")
    found = re.findall(r"^([\w.-]+)==(\S+)[^\n]*\\\n +--hash=sha256:", text, re.MULTILINE)
    assert len(found) == len(re.findall(r"^\w", text, re.MULTILINE))
    return {canonicalize_name(name): version for name, version in found}


def test_the_lock_for_running_is_part_of_that_for_developing() -> None:
    run, dev = pinned("run"), pinned("dev")
    assert run.items() <= dev.items()
    assert run.keys() >= NEEDED
    assert not run.keys() & OPTIONAL
    for each in map(Requirement, PROJECT["dependencies"]):
        assert each.specifier.contains(run[canonicalize_name(each.name)], prereleases=True)


def rows(heading: str) -> list[list[str]]:
    """The cells of the table under a heading of the install page, without its head."""
    text = (ROOT / "docs" / "how-to" / "install.md").read_text(encoding="utf-8")
    section = text.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    lines = [line for line in pages.prose(section).splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def test_the_page_lists_the_libraries_that_are_needed() -> None:
    named = [
        name for row in rows("Size and dependencies") for name in re.findall(r"`([^`]+)`", row[0])
    ]
    assert sorted(map(canonicalize_name, named)) == sorted(NEEDED)


def test_the_page_lists_the_extras() -> None:
    listed = {row[0].strip("`"): set(re.findall(r"`([^`]+)`", row[1])) for row in rows("Extras")}
    assert {name: set(map(canonicalize_name, found)) for name, found in listed.items()} == {
        name: OFFERED[name] for name in OFFERED.keys() - FOR_DEVELOPERS
    }


def test_messages_name_extras_that_there_are() -> None:
    files = [*ROOT.glob("docs/**/*.md"), ROOT / "README.md"]
    files += [
        file for room in ("compiler", "solvers", "srgc") for file in ROOT.glob(f"{room}/**/*.py")
    ]
    named = {
        extra
        for file in files
        for some in re.findall(r"srgc\[([\w,]+)\]", file.read_text(encoding="utf-8"))
        for extra in some.split(",")
    }
    assert named <= OFFERED.keys()
    assert named >= OFFERED.keys() - FOR_DEVELOPERS


def test_the_python_that_is_declared() -> None:
    """The least version that is allowed is tested; its own classifier says so."""
    assert PROJECT["requires-python"] == ">=3.11"
    versions = [one for one in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", one)]
    assert versions == ["Programming Language :: Python :: 3.11"]
    assert not [one for one in PROJECT["classifiers"] if one.startswith("License")]
    assert Version(VERSION).public == PROJECT["version"]
