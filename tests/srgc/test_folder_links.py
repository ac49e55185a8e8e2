"""What a link in a result folder leads to is neither written nor removed, whatever runs."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import srgc as public
from srgc.faults import UsageFault
from srgc.results.folder_writer import FolderWriter, refuse_links

FOLDERS = ("spec", "proofs", "figures", "designs")
FILES = (
    "design.json", "certificate.json", "trajectory.csv", "evaluations.csv", "landscape.csv",
    "pareto.csv", "pareto.json", "log.json", "report.html", "journal.jsonl", ".lock",
    ".certificate.json.part", ".journal.jsonl.part", ".report.html.part",
)  # fmt: skip
INNER = ("spec/more", "spec/slider.srg", "proofs/0000.smt2", "figures/workspace.svg", "designs/0/a")
COMMANDS = {
    "synth": ("synth", "SPEC", "-q", "-o", "DIR"),
    "synth --force": ("synth", "SPEC", "-q", "-o", "DIR", "--force"),
    "synth another": ("synth", "SPEC", "-q", "-o", "DIR", "--seed", "7", "--force"),
    "report": ("report", "DIR", "-q", "--no-verify"),
    "landscape": ("landscape", "DIR", "-q", "--points", "2"),
    "why": ("why", "DIR", "-q"),
    "compare": ("compare", "DIR", "DIR"),
    "export": ("export", "DIR", "--to", "csv", "-o", "ELSEWHERE"),
    "replay": ("replay", "DIR", "--in", "python"),
}


def tree(folder: Path) -> dict[str, bytes | str]:
    """Every file with its content and every link with where it leads."""
    return {
        path.relative_to(folder).as_posix(): str(path.readlink()) if path.is_symlink()
        else path.read_bytes() if path.is_file() else "folder"
        for path in sorted(folder.rglob("*"))
    }  # fmt: skip


@pytest.fixture
def outside(tmp_path):
    """A folder of somebody's, and a file in it."""
    folder = tmp_path / "somebody's"
    (folder / "work").mkdir(parents=True)
    (folder / "work" / "thesis.tex").write_text("three years", encoding="utf-8")
    (folder / "notes.txt").write_text("notes", encoding="utf-8")
    return folder


def linked(folder: Path, name: str, target: Path) -> None:
    """The result of that name gives way to a link."""
    place = folder / name
    if place.is_dir():
        for each in sorted(place.rglob("*"), reverse=True):
            each.rmdir() if each.is_dir() else each.unlink()
        place.rmdir()
    place.unlink(missing_ok=True)
    place.parent.mkdir(parents=True, exist_ok=True)
    place.symlink_to(target)


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("name", [*FOLDERS, "report.html", ".certificate.json.part", *INNER[:2]])
def test_every_command_refuses_a_link(srgc, made, result, outside, tmp_path, command, name):
    folder = result("slider")
    linked(folder, name, outside / ("work" if name in FOLDERS else "notes.txt"))
    before, theirs = tree(folder), tree(outside)
    words = {"SPEC": made("slider") / "slider.srg", "DIR": folder, "ELSEWHERE": tmp_path / "a.csv"}
    ran = srgc(*(words.get(word, word) for word in COMMANDS[command]))
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.count("\n") == 1
    assert f"{folder / name} is a link" in ran.err
    assert tree(outside) == theirs
    assert tree(folder) == before


@pytest.mark.parametrize("name", [*FILES, *FOLDERS, *INNER])
@pytest.mark.parametrize("target", ["notes.txt", "work", "nothing"])
def test_no_result_is_a_link(result, outside, name, target):
    folder = result("slider")
    refuse_links(folder)
    linked(folder, name, outside / target)
    with pytest.raises(UsageFault, match="is a link"):
        refuse_links(folder)


def test_a_result_is_a_file_where_a_file_is_due(srgc, made, result):
    """Not a folder and not a pipe, at which a reader would wait for ever; nor the reverse."""
    for name, make in {
        "design.json": Path.mkdir,
        ".report.html.part": Path.mkdir,
        "proofs/0000.smt2": os.mkfifo,
        "certificate.json": os.mkfifo,
        "spec": Path.touch,
    }.items():
        folder = result("slider")
        linked(folder, name, Path("gone"))
        (folder / name).unlink()
        make(folder / name)
        for command in ("synth", "report", "why"):
            words = {"SPEC": made("slider") / "slider.srg", "DIR": folder}
            ran = srgc(*(words.get(word, word) for word in COMMANDS[command]))
            assert ran.status == 2
            assert f"{folder / name} is " in ran.err
        linked(folder, name, Path("gone"))
        (folder / name).unlink()
        for each in sorted(folder.rglob("*"), reverse=True):
            each.rmdir() if each.is_dir() else each.unlink()
        folder.rmdir()


def test_links_of_others_stay(srgc, made, result, outside):
    """A link whose name is none of ours is nobody's business."""
    folder = result("slider")
    (folder / "notes").symlink_to(outside)
    theirs = tree(outside)
    spec = made("slider") / "slider.srg"
    assert srgc("synth", spec, "-q", "-o", folder, "--seed", "1", "--force").status == 0
    assert srgc("report", folder, "-q", "--no-verify").status == 0
    assert (folder / "notes").readlink() == outside
    assert tree(outside) == theirs


def test_what_a_user_names_in_the_folder_follows_no_link_either(srgc, result, outside):
    folder = result("slider")
    (folder / "mine.html").symlink_to(outside / "notes.txt")
    (folder / "pages").symlink_to(outside / "work")
    (outside / "way in").symlink_to(folder)
    theirs = tree(outside)
    report = ("report", folder, "-q", "--no-verify", "-o")
    for name in (folder / "mine.html", folder / "pages" / "a.html", outside / "way in/mine.html"):
        ran = srgc(*report, name)
        assert ran.status == 2
        assert "is a link" in ran.err
    for arguments in (
        ("landscape", folder, "-q", "--points", "2", "--csv", folder / "pages" / "a.csv"),
        ("export", folder, "--to", "csv", "-o", folder / "pages" / "a.csv"),
        ("export", folder, "--to", "all", "-o", folder / "pages"),
    ):
        assert srgc(*arguments).status == 2
    assert tree(outside) == theirs
    # Elsewhere a link is where its user wants the file; in the folder a plain file is.
    (outside / "page.html").symlink_to(outside / "work" / "page.html")
    assert srgc(*report, outside / "page.html").status == 0
    assert (outside / "work" / "page.html").is_file()
    assert srgc(*report, outside / "way in" / "another.html").status == 0
    assert (folder / "another.html").is_file()


@pytest.mark.parametrize("name", ["trajectory.csv", "figures/workspace.svg", "DESIGN.json"])
def test_a_landscape_replaces_no_result(srgc, result, name):
    folder = result("slider")
    before = tree(folder)
    output = folder / name
    named = ("-o", output) if output.suffix == ".svg" else ("--csv", output)
    ran = srgc("landscape", folder, "-q", "--points", "2", *named)
    assert ran.status == 2
    assert "is one of the results" in ran.err
    assert tree(folder) == before


def test_a_file_with_two_names_is_written_under_one(srgc, made, result, outside):
    """A hard link in the folder: the other name keeps what it had."""
    folder = result("slider")
    for name in ("report.html", ".report.html.part", "design.json", "journal.jsonl"):
        (folder / name).unlink(missing_ok=True)
        os.link(outside / "notes.txt", folder / name)
    (folder / "design.json").unlink()
    (folder / "design.json").write_bytes((made("slider") / "out/design.json").read_bytes())
    assert srgc("report", folder, "-q", "--no-verify").status == 0
    spec = made("slider") / "slider.srg"
    assert srgc("synth", spec, "-q", "-o", folder).status == 0
    assert (outside / "notes.txt").read_text(encoding="utf-8") == "notes"


def test_python_refuses_links(result, outside, tmp_path):
    folder = result("slider")
    found = public.open_result(folder)
    linked(folder, "figures", outside / "work")
    theirs = tree(outside)
    with pytest.raises(public.SrgcError, match="is a link"):
        public.open_result(folder)
    with pytest.raises(public.SrgcError, match="is a link"):
        found.save(tmp_path / "copy")
    target = tmp_path / "target"
    target.mkdir()
    (target / "spec").symlink_to(outside / "work")
    (folder / "figures").unlink()
    with pytest.raises(public.SrgcError, match="is a link"):
        found.save(target, force=True)
    assert tree(outside) == theirs


def test_a_writer_looks_at_every_part_of_a_name(tmp_path, outside):
    writer = FolderWriter(tmp_path / "out")
    (tmp_path / "out").mkdir()
    writer.write("designs/0/spec/a/b.srg", "text")
    (tmp_path / "out" / "designs" / "1").symlink_to(outside)
    theirs = tree(outside)
    deep = writer.within("designs/1")
    for act in (
        lambda: deep.write("notes.txt", "ours"),
        lambda: deep.append("notes.txt", "ours"),
        lambda: deep.discard("notes.txt"),
        lambda: writer.discard("designs/1"),
        lambda: writer.keep_only("designs/1", ()),
    ):
        with pytest.raises(UsageFault, match="is a link"):
            act()
    assert tree(outside) == theirs
    writer.discard("designs/0")
    assert not (tmp_path / "out" / "designs" / "0").exists()


def test_a_disk_that_takes_no_more_leaves_the_old_file(tmp_path, monkeypatch):
    writer = FolderWriter(tmp_path)
    writer.write("a", "old")

    def full(_descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(UsageFault, match="No space left"):
        writer.write("a", "new")
    assert tree(tmp_path) == {"a": b"old"}


def test_lenses_read_no_links(result, outside):
    from srgc.language_server.tasks.verdicts import Verdicts

    folder = result("slider")
    assert Verdicts().read(folder, {}) is not None
    (outside / "design.json").write_bytes((folder / "design.json").read_bytes())
    linked(folder, "design.json", outside / "design.json")
    assert Verdicts().read(folder, {}) is None
