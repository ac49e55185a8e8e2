"""One writer at a time in a result folder, and none that is gone."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest

import srgc as public
from srgc.faults import UsageFault
from srgc.results.folder_writer import LOCK, only_writer
from tests.conftest import ROOT, srgc_process
from tests.oracles.small_specs import TURNER

HOLDER = """\
import sys
from pathlib import Path
from srgc.results.folder_writer import only_writer
with only_writer(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def holder():
    """A process that writes to a folder, as long as it lives."""
    started = []

    def hold(folder):
        process = subprocess.Popen(
            [sys.executable, "-c", HOLDER, str(folder)],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        started.append(process)
        assert process.stdout.readline() == b"held\n"
        return process

    yield hold
    for process in started:
        process.kill()
        process.communicate()


def test_the_second_is_refused_and_a_kill_leaves_no_lock(srgc, made, result, holder):
    folder = result("turner")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    first = holder(folder)
    for arguments in (
        ("synth", made("turner") / "turner.srg", "-q", "-o", folder),
        ("synth", made("turner") / "turner.srg", "-q", "-o", folder, "--seed", "3", "--force"),
        ("report", folder, "-q", "--no-verify"),
        ("landscape", folder, "-q", "--points", "2"),
    ):
        ran = srgc(*arguments)
        assert (ran.status, ran.out) == (2, "")
        assert f"another srgc is writing to {folder}" in ran.err
    assert {path: path.read_bytes() for path in before} == before
    assert srgc("verify", folder).status == 0  # reading is free
    first.kill()
    first.wait()
    assert (folder / LOCK).exists()
    assert srgc("report", folder, "-q", "--no-verify").status == 0
    assert not (folder / LOCK).exists()


def test_two_runs_at_once(tmp_path):
    """Of two whole processes one does the work, the other says that it does."""
    (tmp_path / "turner.srg").write_text(TURNER, encoding="utf-8")
    arguments = ["synth", "turner.srg", "-o", "out", "-q"]
    both = [srgc_process(arguments, tmp_path) for _ in range(2)]
    ended = [(process.communicate(), process.returncode) for process in both]
    statuses = sorted(status for _, status in ended)
    assert statuses in ([0, 2], [0, 0])  # both, if one began after the other's end
    for (_, err), status in ended:
        assert (b"another srgc is writing to out" in err) == (status == 2)
    assert public.verify(tmp_path / "out").valid


def test_in_one_process_too(tmp_path):
    """As in a notebook with two cells that write to one folder."""
    with only_writer(tmp_path):
        with pytest.raises(UsageFault, match="another srgc is writing"), only_writer(tmp_path):
            pass
        with only_writer(tmp_path.parent):
            pass
    with only_writer(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_save_takes_the_lock(result, holder, tmp_path):
    found = public.open_result(result("turner"))
    target = tmp_path / "target"
    found.save(target)
    held = holder(target)
    with pytest.raises(public.SrgcError, match="another srgc is writing"):
        found.save(target)
    held.kill()
    held.wait()
    found.save(target)


def test_a_folder_that_takes_no_lock_is_said_to_be_so(tmp_path, monkeypatch):
    import filelock

    def refused(*_arguments, **_options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(filelock.FileLock, "acquire", refused)
    with pytest.raises(UsageFault, match=r"\.lock: Permission denied"), only_writer(tmp_path):
        pass


@pytest.mark.parametrize("name", ["design.json", "journal.jsonl"])
@pytest.mark.parametrize("force", [(), ("--force",)])
def test_a_huge_or_deep_file_says_nothing_of_an_owner(srgc, made, result, name, force):
    """Of 5 GiB, on a disk in one block, and nested beyond what Python reads."""
    spec = made("turner") / "turner.srg"
    for content, size in (
        (b"", 5 * 2**30),
        (b"[" * 100_000 + b"\n", None),
        (b'{"seed": 1e999}', None),
    ):
        folder = result("turner")
        (folder / "design.json").unlink()
        with (folder / name).open("wb") as file:
            file.write(content)
            file.truncate(size)
        ran = srgc("synth", spec, "-q", "-o", folder, *force)
        assert (ran.status, ran.out) == (2, "")
        assert ran.err.count("\n") == 1
        shutil.rmtree(folder)
