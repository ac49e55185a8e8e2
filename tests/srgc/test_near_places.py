"""Paths and names that lead nowhere: what may be meant, and what to do."""

from __future__ import annotations

import errno
import os

import pytest

from srgc.paths import unwritable
from tests.oracles.small_specs import TURNER


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "specs").mkdir()
    (tmp_path / "specs" / "turner.srg").write_text(TURNER, encoding="utf-8")
    (tmp_path / "turner.txt").write_text("")
    for name in ("out/demo", "other/demo2"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "out" / "demo" / "design.json").write_text("{}")
    return tmp_path


@pytest.mark.parametrize(
    "typed", ["turner.srg", "turnr.srg", "specs/tuner.srg", "specs/Turner.srg"]
)
def test_a_spec_that_is_meant(srgc, place, typed):
    ran = srgc("check", typed)
    assert ran.status == 1
    assert "hint: is it `specs/turner.srg`?" in ran.out
    assert srgc("words", typed).err.count("is it `specs/turner.srg`?") == 1


@pytest.mark.parametrize("typed", ["crane.srg", "none/crane.srg"])
def test_nothing_like_it(srgc, place, typed):
    ran = srgc("check", typed)
    assert ran.status == 1
    assert "is it" not in ran.out
    assert "hint: give the path of an `.srg` file" in ran.out


def test_another_mistake_keeps_its_hint(srgc, place):
    (place / "turner.srg").write_text('include "turner2.srg";\nedge eps', encoding="utf-8")
    assert "is it" not in srgc("check", "turner.srg").out


@pytest.mark.parametrize(
    "command", [["verify"], ["why"], ["landscape"], ["export", "--to", "urdf"]]
)
def test_a_result_that_is_meant(srgc, place, command):
    for typed in ("demo", "out/deno"):
        ran = srgc(*command, typed)
        assert (ran.status, ran.out) == (2, "")
        assert ran.err == f"error: {typed} is not a folder; is it out/demo?\n"
    assert srgc(*command, "demo3x").err == "error: demo3x is not a folder; is it out/demo?\n"
    assert srgc(*command, "zzz").err == "error: zzz is not a folder\n"


def test_a_name_that_is_meant(srgc, place):
    two = TURNER + "\ngrammar Turning { start N; base: N -> B; }\n"
    (place / "two.srg").write_text(two, encoding="utf-8")
    err = srgc("words", "two.srg", "--grammar", "Turnin").err
    assert "there is no grammar `Turnin`; did you mean `Turning`? the file has: " in err
    assert "did you mean" not in srgc("words", "two.srg", "--grammar", "Zzz").err


def test_outputs_that_cannot_be_written(srgc, place):
    model = ["graph", "specs/turner.srg", "--of", "sra", "-o"]
    err = srgc(*model, "none/a.dot").err
    assert err.startswith("error: none/a.dot: No such file or directory")
    assert "is there a folder none?" in err
    assert srgc("synth", "specs/turner.srg", "-o", "turner.txt").err == (
        "error: turner.txt: File exists; it is a file, and a folder is expected\n"
    )


def test_a_folder_that_is_there_is_not_asked_for(tmp_path):
    """As of files in /proc, which nobody can make."""
    refused = FileNotFoundError(errno.ENOENT, "No such file or directory")
    told = str(unwritable(tmp_path / "arm.csv", refused))
    assert told == f"{tmp_path / 'arm.csv'}: No such file or directory"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_permissions(srgc, place):
    (place / "other").chmod(0o500)
    for command in (
        ["graph", "specs/turner.srg", "--of", "sra", "-o", "other/a.dot"],
        ["synth", "specs/turner.srg", "-o", "other/new"],
        ["synth", "specs/turner.srg", "-o", "other"],
    ):
        ran = srgc(*command)
        assert (ran.status, ran.out) == (2, "")
        assert "choose another" in ran.err
    (place / "other").chmod(0o700)


def test_what_root_cannot_write_either(srgc, place, monkeypatch):
    def refused(*_arguments, **_options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pathlib.Path.write_bytes", refused)
    ran = srgc("graph", "specs/turner.srg", "--of", "sra", "-o", "a.dot")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == "error: a.dot: Permission denied; choose another place with -o\n"
