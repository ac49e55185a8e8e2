"""Meshes as an editor sees them: the files that are offered, and what is said of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from srgc.language_server.completions.completion import completions
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.documents.uris import uri_of
from srgc.language_server.hovers.hover import hover
from srgc.language_server.outlines.outline import include_links
from tests.oracles.mesh_files import WEDGE

TEXT = """\
module B { role base; port out: T; frame out = in;
  visual(frame: in, file: "wedge.obj", scale: 1 mm);
  hull(frame: in, file: "wedge.obj", scale: 1 mm); }
module E { role effector; port in: T; effector(frame: in); }
grammar G from ports { start B; with E; }
workspace W { space xyz; bounds box [-1, 1] x [-1, 1] x [-1, 1] m;
  obstacles from "wedge.obj" in mm at move((0.5, 0, 0) m); }
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "wedge.obj").write_text(WEDGE, encoding="utf-8")
    for name in ("a.dae", "b.glb", "c.stl", "d.yaml", "e.txt"):
        (tmp_path / name).write_bytes(b"")
    return tmp_path


def seen(folder: Path, text: str) -> Analysis:
    return analyse(str(folder / "a.srg"), text, {})


def offered(folder: Path, text: str) -> set[str]:
    return {item.label for item in completions(seen(folder, text), text, len(text))}


@pytest.mark.parametrize(
    ("before", "names"),
    [
        ('workspace W { space xyz; obstacles from "', {"c.stl", "wedge.obj", "d.yaml"}),
        ('module M { role link; hull(frame: in, file: "', {"c.stl", "wedge.obj"}),
        ('module M { role link; visual(file: "', {"a.dae", "b.glb", "c.stl", "wedge.obj"}),
        ('module M { role link; box(file: "', set[str]()),
    ],
)
def test_files_are_offered(folder: Path, before: str, names: set[str]) -> None:
    assert offered(folder, before) == names


@pytest.mark.parametrize(
    ("before", "words"),
    [
        ('workspace W { space xyz; obstacles from "c.stl" ', {"in", "at"}),
        ('workspace W { space xyz; obstacles from "c.stl" in ', {"mm", "cm", "m"}),
        ('workspace W { space xyz; obstacles from "c.stl" in mm ', {"at"}),
        ('workspace W { space xyz; obstacles from "c.stl" at ', {"rot", "move", "world"}),
        ("module M { role link; visual(", {"frame", "file", "scale"}),
        ("module M { role link; ", {"visual", "hull"}),
    ],
)
def test_what_may_be_written(folder: Path, before: str, words: set[str]) -> None:
    assert words <= offered(folder, before)


def told(folder: Path, word: str, behind: str = "") -> str:
    offset = TEXT.index(word, TEXT.index(behind) if behind else 0)
    found = hover(seen(folder, TEXT), 0, offset)
    assert found is not None
    return str(getattr(found.contents, "value", ""))


def test_hovers(folder: Path) -> None:
    assert "no mass and does not collide" in told(folder, "visual")
    assert "the unit of a mesh" in told(folder, "in mm", "obstacles")
    assert "where the axes of a mesh are" in told(folder, "at move")
    assert "a mesh" in told(folder, "obstacles")
    assert "All obstacles of the map `wedge`" in told(folder, '"wedge.obj" in mm')


def test_paths_are_links(folder: Path) -> None:
    links = include_links(seen(folder, TEXT), 0, uri_of)
    assert [str(link.target).rpartition("/")[2] for link in links] == ["wedge.obj"] * 3
