"""Paths that no file has, for every command that takes one: one message, and never status 70."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import srgc as interface
from srgc.cli import run
from srgc.paths import near_spec, no_folder, refuse_impossible
from srgc.terminal import escape_unencodable
from tests.oracles.small_specs import SLIDER
from tests.srgc.conftest import Ran

Run = Callable[..., Ran]

WORD = "B P EN"
LONG = "n" * 5000
PATHS = {
    "NUL": "a\0b",
    "a surrogate": "a\ud800b",
    "a long name": LONG,
    "a name of 300 characters": "n" * 300,
    "a long path": "d/" * 3000 + "x",
    "below a file": "slider.srg/x",
    "a file with a slash": "slider.srg/",
    "a loop of links": "loop",
    "below a loop": "loop/x",
    "a broken link": "broken",
    "nothing": "nothing",
    "below nothing": "no/thing",
    "empty": "",
    "bytes that are no UTF-8": "\udcff",
    "a line end": "a\nb",
    "a folder that is none of ours": "folder",
    "a pipe": "pipe",
    "a device": "/dev/null",
}
SUFFIXED = {
    name: path if path in {"", "slider.srg/", "folder", "pipe", "/dev/null"} else f"{path}.srg"
    for name, path in PATHS.items()
}
FILES: dict[str, list[str]] = {
    "check": [],
    "check --json": [],
    "fmt": [],
    "fmt --check": [],
    "words": [],
    "accepts": ["--", "B"],
    "language": [],
    "compare": ["G", "H"],
    "graph --of sra": [],
    "model": ["--word", WORD],
    "plan": [],
    "synth --quiet": [],
}
FOLDERS: dict[str, list[str]] = {
    "verify": [],
    "verify --json": [],
    "why --no-runs": [],
    "report --no-verify": [],
    "compare found": [],
    "landscape": [],
    "export": ["--to", "urdf"],
    "replay": ["--in", "python"],
}
OUTPUTS = {
    "graph": ("graph slider.srg --of sra", "-o", ""),
    "graph as a picture": ("graph slider.srg --of sra", "-o", ".svg"),
    "model": (f"model slider.srg --word|{WORD}", "-o", ""),
    "plan": ("plan slider.srg", "-o", ".svg"),
    "plan --dump": ("plan slider.srg --dump dimacs", "-o", ""),
    "synth": ("synth slider.srg --quiet", "-o", ""),
    "report": ("report found --no-verify", "-o", ""),
    "landscape": ("landscape found --points 2", "-o", ".svg"),
    "landscape --csv": ("landscape found --points 2", "--csv", ""),
    "export urdf": ("export found --to urdf", "-o", ""),
    "export all": ("export found --to all", "-o", ""),
    "new": ("new planar", "-o", ""),
    "verify --spec": ("verify found", "--spec", ""),
}
WRITTEN = {"nothing", "below nothing", "bytes that are no UTF-8", "a line end", "a broken link"}
"""What may be written, if not by every command."""


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("found")
    (place / "slider.srg").write_text(SLIDER, encoding="utf-8")
    assert run(["synth", "--quiet", str(place / "slider.srg"), "-o", str(place / "found")]) == 0
    return place


@pytest.fixture
def place(found: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a spec, results, links that lead nowhere, and a pipe."""
    (tmp_path / "slider.srg").write_bytes((found / "slider.srg").read_bytes())
    (tmp_path / "found").symlink_to(found / "found")
    (tmp_path / "folder").mkdir()
    for name in ("loop", "loop.srg", "loop.svg"):
        (tmp_path / name).symlink_to(name)
    for name in ("broken", "broken.srg", "broken.svg"):
        (tmp_path / name).symlink_to(f"no/{name}")
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    assert (tmp_path / "slider.srg").read_text(encoding="utf-8") == SLIDER


@pytest.fixture
def ran(srgc: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """A command, with the output that ``main`` makes of it."""
    monkeypatch.delenv("SRGC_TRACEBACK", raising=False)

    def call(*arguments: object) -> Ran:
        escape_unencodable()
        return srgc(*arguments)

    return call


def _said_once(ran: Ran) -> None:
    """One message, of the lines that it needs."""
    text = ran.err or ran.out
    assert text
    assert text.lower().count("error") <= 3, text
    assert len(text.splitlines()) <= 8, text
    assert "internal" not in text


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("command", FILES)
def test_a_file(ran: Run, place: Path, command: str, name: str) -> None:
    for path in {PATHS[name], SUFFIXED[name]}:
        found = ran(*command.split(), path, *FILES[command])
        assert found.status in ({1, 2} if command.startswith("check") else {2, 5}), found
        if command != "check --json" or found.status == 2:
            _said_once(found)
        else:
            assert [each["code"] for each in json.loads(found.out)] == ["SRG0101"]


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("command", FOLDERS)
def test_a_folder(ran: Run, place: Path, command: str, name: str) -> None:
    found = ran(*command.split(), PATHS[name], *FOLDERS[command])
    assert found.status in ({2, 4} if command.startswith("verify") else {2}), found
    if found.status == 2:
        _said_once(found)


@pytest.mark.parametrize("name", [each for each in PATHS if each not in {"a pipe", "a device"}])
@pytest.mark.parametrize("output", OUTPUTS)
def test_an_output(ran: Run, place: Path, output: str, name: str) -> None:
    command, option, suffix = OUTPUTS[output]
    path = PATHS[name] if PATHS[name].endswith("/") else f"{PATHS[name]}{suffix}"
    words, _, last = command.partition("|")
    found = ran(*words.split(), *([last] if last else []), option, path)
    usual = {"nothing", "empty"} if suffix or output == "synth" else set()
    if name in WRITTEN | usual | {"a folder that is none of ours", "empty"}:
        assert found.status in {0, 1, 2}, found
    else:
        assert found.status == 2, found
    if found.status == 2:
        _said_once(found)


def test_arguments_that_are_no_names(ran: Run, place: Path) -> None:
    for path in PATHS.values():
        for command in (
            ["words", "slider.srg", "--grammar", path],
            ["synth", "slider.srg", "--task", path],
            ["accepts", "slider.srg", "--", path],
            ["explain", path],
            ["landscape", "found", "--over", path],
            ["new", path],
        ):
            assert ran(*command).status in {0, 1, 2, 5}


def test_a_folder_that_nobody_may_look_into(
    ran: Run, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who runs the tests may be allowed to look anywhere, so that the system is stood in for."""
    real = os.stat

    def stat(path: object, *rest: object, **more: object) -> os.stat_result:
        if "secret" in str(path):
            raise PermissionError(13, "Permission denied")
        return real(path, *rest, **more)  # type: ignore[call-overload, no-any-return]

    monkeypatch.setattr(os, "stat", stat)
    for command, rest in FOLDERS.items():
        found = ran(*command.split(), "secret/x", *rest)
        assert (found.status, found.err) == (2, "error: `secret/x`: Permission denied\n")
    (place / "secrets").mkdir()
    assert "is not a folder" in str(no_folder(place / "secretx"))


def test_the_name_itself_is_no_hint(ran: Run, place: Path) -> None:
    (place / "loops.srg").write_text(SLIDER, encoding="utf-8")
    assert near_spec(Path("loop.srg")) == Path("loops.srg")
    (place / "loops.srg").unlink()
    assert "is it" not in ran("words", "loop.srg").err


def test_a_task_with_a_long_name(ran: Run, place: Path) -> None:
    """Its results would be in a folder of that name."""
    for length in (300, 5000):
        text = SLIDER.replace("task Slide", f"task {'T' * length}")
        (place / "long.srg").write_text(text, encoding="utf-8")
        found = ran("synth", "--quiet", "long.srg")
        assert found.status == 2
        _said_once(found)


@pytest.mark.parametrize("name", ["NUL", "a surrogate", "a long name", "a long path"])
def test_the_python_interface_refuses_them(found: Path, place: Path, name: str) -> None:
    path = PATHS[name]
    program = interface.load(text=SLIDER)
    result = interface.open_result(found / "found")
    calls: list[Callable[[], object]] = [
        lambda: interface.check(path),
        lambda: interface.load(path),
        lambda: interface.check(text=SLIDER, folder=path),
        lambda: interface.verify(path),
        lambda: interface.verify(found / "found", spec=path),
        lambda: interface.open_result(path),
        lambda: interface.why(path),
        lambda: interface.export(path, "urdf"),
        lambda: interface.export(found / "found", "urdf", path),
        lambda: interface.synthesize(program, folder=path),
        lambda: result.save(path),
        lambda: result.report().save(path),
    ]
    for call in calls:
        with pytest.raises(interface.SrgcError) as caught:
            call()
        assert len(str(caught.value)) < 200
        assert str(caught.value).isprintable()


def test_what_may_come_to_be_is_possible(place: Path) -> None:
    for path in ("nothing", "no/thing", "loop", "slider.srg/x", "slider.srg", "folder/", "-"):
        refuse_impossible(path)
    for path in ("slider.srg/", LONG, "a\0", "\ud800"):
        with pytest.raises(interface.SrgcError):
            refuse_impossible(path)


@pytest.mark.parametrize("kind", ["include", "map", "image"])
@pytest.mark.parametrize("name", [each for each in PATHS if each not in {"NUL", "a surrogate"}])
def test_a_path_in_a_file(ran: Run, place: Path, kind: str, name: str) -> None:
    path = PATHS[name]
    end = {"include": ".srg", "map": ".yaml", "image": ".pgm"}[kind]
    for written in (path, f"{path}{end}"):
        (place / "m.yaml").write_bytes(
            f"image: {written}\nresolution: 1\norigin: [0, 0, 0]\n".encode(errors="surrogateescape")
        )
        text = {
            "include": f'include "{written}";\nmodule M {{ role base; }}\n',
            "map": f'workspace W {{ plane xy; obstacles from "{written}"; }}\n',
            "image": 'workspace W { plane xy; obstacles from "m.yaml"; }\n',
        }[kind]
        (place / "main.srg").write_bytes(text.encode(errors="surrogateescape"))
        found = ran("check", "main.srg")
        assert found.status == 1, found
        assert "internal" not in found.err
        assert ran("words", "main.srg").status == 5


@pytest.mark.parametrize("odd", ["a\0b", "a\ud800b"])
def test_a_path_in_a_text_from_elsewhere(odd: str, place: Path) -> None:
    """An editor and Python can give texts that no file holds."""
    include = f'include "{odd}.srg";\nmodule M {{ role base; }}\n'
    for text in (include, f'workspace W {{ plane xy; obstacles from "{odd}.yaml"; }}\n'):
        codes = [each.code.value for each in interface.check(text=text, folder=place)]
        assert {"SRG0109", "SRG0103"} & set(codes)
