"""Ports, modules with bodies and the library, as an editor sees them."""

from __future__ import annotations

from pathlib import Path

import pytest

from grammar_lang.files.file_tree import LIBRARY
from srgc.language_server.completions.completion import completions
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.documents.places import definition
from srgc.language_server.documents.uris import uri_of
from srgc.language_server.edits.rename import RenameRefused, rename
from srgc.language_server.hovers.hover import hover
from srgc.language_server.outlines.outline import include_links, outline

PATH = "/nowhere/kit.srg"
KIT = """\
module Plate { role base; port out: Flange; frame out = in; }
module Tube { role link; param length in [1, 2] m; port in: Flange; port out: Flange;
  frame out = in * move(x, length); rod(frame: in, axis: x, length: length, density: 1 kg/m); }
module Hand { role effector; port in: Flange; effector(frame: in); }
grammar Arm from ports { start Plate; with Tube, Hand; }
grammar Two { start S; all: S -> Plate Hand; }
semantics Two { all { let up = Plate.out; Plate.in = world; Hand.in = up; } }
"""


def seen(text: str = KIT) -> Analysis:
    return analyse(PATH, text, {})


def offered(before: str, after: str = "") -> list[str]:
    """What may be written behind a text; ``after`` stands behind the cursor."""
    text = KIT + before + after
    return [item.label for item in completions(seen(text), text, len(KIT + before))]


def told(word: str, behind: str = "") -> str:
    offset = KIT.index(word, KIT.index(behind) if behind else 0)
    found = hover(seen(), 0, offset)
    assert found is not None
    return getattr(found.contents, "value", "")


@pytest.mark.parametrize(
    ("before", "labels"),
    [
        ("module M { role link; port in: ", {"Flange"}),
        ("module M { role link; frame f = in; port ", {"in", "f"}),
        ("module M { role link; frame a = in; frame b = ", {"in", "a", "rot", "move"}),
        ("module M { role link; sphere(", {"frame", "radius"}),
        ("module M { role link; sphere(frame: in, ", {"radius"}),
        ("module M { role link; ", {"frame", "port", "rod", "sphere"}),
        ("grammar G from ports { start ", {"Plate", "Tube", "Hand"}),
        ("grammar G from ports { start Plate; with Hand, ", {"Tube"}),
        ("grammar G from ports { ", {"start", "with", "accept"}),
        ("semantics Two { all { Hand.in = Plate.", {"out", "in"}),
        ("semantics Two { all { Hand.in = ", {"Plate", "Hand", "up", "world"}),
        ("", {"grammar from ports", "include std"}),
    ],
)
def test_what_may_be_written(before: str, labels: set[str]) -> None:
    assert labels <= set(offered(before))


def test_a_listed_module_is_not_offered_again() -> None:
    assert "Hand" not in offered("grammar G from ports { start Plate; with Hand, ")


def test_what_does_not_belong_in_a_grammar_from_ports_is_not_offered() -> None:
    assert "production" not in offered("grammar G from ports { ")
    assert "production" in offered("grammar G { ")
    assert "Plate" not in offered("grammar G from ports { start Plate; with ")


def test_a_grammar_from_ports_has_no_semantics() -> None:
    assert "Arm" not in offered("semantics ")


def test_files_of_the_library_are_offered() -> None:
    names = {path.name for path in Path(LIBRARY).glob("*.srg")}
    assert names
    assert set(offered('include std "')) == names


def test_hovers() -> None:
    assert "Flange -> Tube Flange" in told("Arm from")
    assert "Tube: port out: Flange" in told("Flange")
    assert "A frame" in told("out = in *")
    assert "A local value of `all`, used 1 time" in told("up =")
    assert "where modules meet" in told("port in")
    assert "the module is mounted" in told("in * move")


def test_the_outline_has_frames_and_ports() -> None:
    tube = outline(seen(), 0)[1]
    assert [child.name for child in tube.children or ()] == ["length", "in", "out", "out"]


def library_text() -> str:
    name = min(path.name for path in Path(LIBRARY).glob("*.srg"))
    return f'include std "{name}";\n'


def test_the_library_is_shown_and_not_renamed(tmp_path: Path) -> None:
    path = tmp_path / "use.srg"
    text = library_text()
    analysis = analyse(str(path), text, {})
    name = next(n for n, module in analysis.declared.terminals.items() if module.span.file)
    text += f"grammar G {{ start S; all: S -> {name}; }}\n"
    analysis = analyse(str(path), text, {})
    (found,) = definition(analysis, 0, text.index(name), uri_of)
    assert LIBRARY in found.uri
    with pytest.raises(RenameRefused, match="a name of the library"):
        rename([analysis], str(path), text.index(name), "Other", {}, uri_of)
    (link,) = include_links(analysis, 0, uri_of)
    assert LIBRARY in (link.target or "")
