"""A spec that was edited runs again, and the results before are kept beside their folder."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

import srgc as public
from srgc.faults import UsageFault
from srgc.results.folder_writer import LOCK, only_writer
from srgc.results.result_folder import Identity, open_folder
from srgc.version import VERSION
from tests.conftest import ROOT
from tests.oracles.small_specs import SLIDER

Run = Callable[..., SimpleNamespace]
Made = Callable[[str], Path]

FIRST = Identity("aa", "Slide", 0, VERSION)
KILLED = """\
import os, sys
from pathlib import Path
from srgc.results.result_folder import Identity, open_folder
from srgc.version import VERSION
old = Path.rename
def rename(self, target):
    if sys.argv[2] == "after":
        old(self, target)
    os._exit(9)
Path.rename = rename
with open_folder(Path(sys.argv[1]), Identity("bb", "Slide", 0, VERSION), force=False, spec="a.srg"):
    pass
"""


def content(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def left(folder: Path, identity: Identity, text: str) -> dict[str, bytes]:
    """What a run of ``a.srg`` leaves that was interrupted."""
    with open_folder(folder, identity, force=False, spec="a.srg") as opened:
        opened.files.write("spec/a.srg", text)
        opened.record("a step", 1.0)
    return content(folder)


@pytest.fixture
def result(tmp_path: Path) -> tuple[Path, dict[str, bytes]]:
    """A folder with results of ``a.srg``."""
    return tmp_path / "out", left(tmp_path / "out", FIRST, "first")


def test_an_edited_spec_needs_no_force(srgc: Run, made: Made, tmp_path: Path) -> None:
    spec, out = tmp_path / "slider.srg", tmp_path / "out"
    shutil.copytree(made("slider") / "out", out)
    shutil.copy(made("slider") / "slider.srg", spec)
    before = content(out)
    spec.write_text(SLIDER + "// edited\n", encoding="utf-8", newline="")
    ran = srgc("synth", spec, "-o", out)
    assert ran.status == 0
    assert ran.err.startswith(
        f"note: the spec was edited; the results so far are kept in {tmp_path / 'out.1'}\n"
    )
    assert content(tmp_path / "out.1") == before
    assert public.verify(tmp_path / "out.1").valid
    assert srgc("verify", out, "--spec", spec).status == 0
    assert not (out / LOCK).exists()
    # The same again finds its own results, and nothing is moved.
    assert srgc("synth", spec, "-o", out, "-q").status == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "out.1", "slider.srg"]


def test_numbers_go_on_and_are_never_given_twice(result: tuple[Path, dict[str, bytes]]) -> None:
    folder, first = result
    (folder.parent / "out.7").mkdir()
    (folder.parent / "out.x").mkdir()
    second = left(folder, replace(FIRST, spec_sha256="bb"), "second")
    assert content(folder.parent / "out.8") == first
    left(folder, FIRST, "third")
    assert content(folder.parent / "out.8") == first
    assert content(folder.parent / "out.9") == second


def test_an_interrupted_run_of_the_same_text_goes_on(result: tuple[Path, dict[str, bytes]]) -> None:
    folder, _ = result
    with open_folder(folder, FIRST, force=False, spec="a.srg") as opened:
        assert opened.recall("a step") == 1.0
        assert opened.kept is None
    # What was kept goes on where it is now.
    left(folder, replace(FIRST, spec_sha256="bb"), "second")
    with open_folder(folder.with_name("out.1"), FIRST, force=False, spec="a.srg") as opened:
        assert opened.recall("a step") == 1.0


@pytest.mark.parametrize(
    ("identity", "spec"),
    [
        (replace(FIRST, seed=1), "a.srg"),
        (replace(FIRST, version="0.0"), "a.srg"),
        (replace(FIRST, spec_sha256="bb", seed=1), "a.srg"),
        (replace(FIRST, spec_sha256="bb", task="Turn"), "a.srg"),
        (replace(FIRST, spec_sha256="bb", origin="cc"), "a.srg"),
        (replace(FIRST, spec_sha256="bb"), "b.srg"),
        (replace(FIRST, spec_sha256="bb"), None),
    ],
    ids=["seed", "version", "options", "task", "kind", "file", "save"],
)
def test_another_command_is_refused(
    result: tuple[Path, dict[str, bytes]], identity: Identity, spec: str | None
) -> None:
    folder, before = result
    refused = pytest.raises(UsageFault, match="--force")
    with refused, open_folder(folder, identity, force=False, spec=spec):
        pass
    assert content(folder) == before
    assert [path.name for path in folder.parent.iterdir()] == ["out"]


def test_what_is_not_ours_is_not_moved(result: tuple[Path, dict[str, bytes]]) -> None:
    folder, _ = result
    (folder / "thesis.txt").write_text("mine", encoding="utf-8")
    before = content(folder)
    edited = replace(FIRST, spec_sha256="bb")
    with pytest.raises(UsageFault, match=r"`thesis\.txt`, which srgc did not write"):
        left(folder, edited, "second")
    assert content(folder) == before
    with open_folder(folder, edited, force=True, spec="a.srg") as opened:
        assert opened.kept is None
    assert (folder / "thesis.txt").read_text(encoding="utf-8") == "mine"


def test_a_process_in_the_folder(
    result: tuple[Path, dict[str, bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it writes from then on would be written to the folder that was moved."""
    folder, before = result
    monkeypatch.chdir(folder / "spec")
    for path in (folder, Path("..")):
        with pytest.raises(UsageFault, match="the folder that one is in"):
            left(path, replace(FIRST, spec_sha256="bb"), "second")
    assert content(folder) == before


def test_a_link_to_the_folder_leads_to_the_new_results(
    result: tuple[Path, dict[str, bytes]], tmp_path: Path
) -> None:
    folder, before = result
    link = tmp_path / "here"
    link.symlink_to(folder)
    second = left(link, replace(FIRST, spec_sha256="bb"), "second")
    assert link.is_symlink()
    assert content(folder) == second
    assert content(folder.with_name("out.1")) == before


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may do anything")
def test_a_parent_that_cannot_be_written(result: tuple[Path, dict[str, bytes]]) -> None:
    folder, before = result
    folder.parent.chmod(0o555)
    try:
        with pytest.raises(UsageFault, match=r"kept aside: to .*Permission denied"):
            left(folder, replace(FIRST, spec_sha256="bb"), "second")
    finally:
        folder.parent.chmod(0o755)
    assert content(folder) == before


@pytest.mark.parametrize("when", ["before", "after"])
def test_a_kill_leaves_the_results_whole(result: tuple[Path, dict[str, bytes]], when: str) -> None:
    folder, before = result
    killed = subprocess.run(
        [sys.executable, "-c", KILLED, str(folder), when], cwd=ROOT, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert killed.returncode == 9
    kept = folder.with_name("out.1") if when == "after" else folder
    assert {name: data for name, data in content(kept).items() if name != LOCK} == before
    # The next run does what the killed one did not.
    left(folder, replace(FIRST, spec_sha256="bb"), "second")
    kept = folder.with_name("out.1")
    assert {name: data for name, data in content(kept).items() if name != LOCK} == before


def test_the_lock_is_held_throughout(result: tuple[Path, dict[str, bytes]]) -> None:
    folder, _ = result
    edited = replace(FIRST, spec_sha256="bb")
    with open_folder(folder, edited, force=False, spec="a.srg"):
        assert not (folder.with_name("out.1") / LOCK).exists()
        refused = pytest.raises(UsageFault, match="another srgc is writing")
        with refused, only_writer(folder):
            pass
    assert not (folder / LOCK).exists()
    with only_writer(folder):
        refused = pytest.raises(UsageFault, match="another srgc is writing")
        with refused, open_folder(folder, FIRST, force=False, spec="a.srg"):
            pass


def test_a_lock_that_is_not_ours_stays(tmp_path: Path) -> None:
    """The folder was moved away in the block, and another run has made a new one."""
    folder = tmp_path / "out"
    folder.mkdir()
    with only_writer(folder):
        folder.rename(tmp_path / "moved")
        folder.mkdir()
        (folder / LOCK).write_text("", encoding="utf-8")
    assert (folder / LOCK).exists()
