"""`include std`: files of the library, copies of them, and what `srgc expand` makes of includes."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.files.file_tree import LIBRARY
from grammar_lang.formatting.expansion import expanded
from grammar_lang.load import load, load_text

Write = Callable[[Mapping[str, str]], Path]
FILES = sorted(Path(LIBRARY).glob("*.srg"))
SOME = FILES[0].name
MINE = "module Mine { role link; }"
MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Files by their paths; gives the first one's."""

    def make(files: Mapping[str, str]) -> Path:
        for name, text in files.items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return tmp_path / next(iter(files))

    return make


# --- the library ----------------------------------------------------------------------------------


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_file_of_the_library(file: Path, write: Write) -> None:
    """It has no findings, is canonical, and all that it declares begins with `Std_`."""
    loaded = load(write({"a.srg": f'include std "{file.name}";\n'}))
    assert loaded.program is not None, loaded.diagnostics
    assert loaded.diagnostics == ()
    assert loaded.names is not None
    declared = loaded.names.entities("module", "edge", "grammar", "workspace", "task", "port type")
    assert declared
    assert [entity.name for entity in declared if not entity.name.startswith("Std_")] == []
    assert not loaded.program.tasks


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_file_names_a_source(file: Path) -> None:
    """Comments before the first module say where the values are from."""
    head = file.read_text(encoding="utf-8").partition("module ")[0]
    assert head.startswith("//")
    assert len(head) > 100


def test_a_copy_in_the_tree_is_read_instead(write: Write) -> None:
    text = "module Std_Mine { role base; }\n"
    loaded = load(write({"a.srg": f'include std "{SOME}";\n', f"@std/{SOME}": text}))
    assert loaded.program is not None
    assert list(loaded.program.modules) == ["Std_Mine"]
    assert [source.path for source in loaded.sources] == ["a.srg", f"@std/{SOME}"]


def test_library_files_stand_in_std(write: Write) -> None:
    """Under one path, whichever file includes it."""
    files = {
        "a.srg": f'include "b/c.srg"; include std "{SOME}";',
        "b/c.srg": f'include std "{SOME}";',
    }
    loaded = load(write(files))
    assert loaded.program is not None
    assert [source.path for source in loaded.sources] == ["a.srg", "b/c.srg", f"@std/{SOME}"]


def test_a_link_in_std_that_leads_out_is_refused(write: Write, tmp_path: Path) -> None:
    path = write({"tree/a.srg": f'include std "{SOME}";'})
    outside = tmp_path / "outside.srg"
    outside.write_text("module Outside { role base; }", encoding="utf-8")
    (path.parent / "@std").mkdir()
    (path.parent / "@std" / SOME).symlink_to(outside)
    (found,) = load(path).diagnostics
    assert found.code is Code.OUTSIDE_TREE


@pytest.mark.parametrize(
    ("path", "code", "hint"),
    [
        (SOME.replace(".srg", "x.srg"), Code.UNREADABLE_REFERENCE, f"did you mean `{SOME}`?"),
        ("zzzzzzz.srg", Code.UNREADABLE_REFERENCE, "known: "),
        ("../load.py", Code.OUTSIDE_TREE, "write a file of it"),
        ("/etc/passwd", Code.OUTSIDE_TREE, "relative"),
        ("", Code.UNREADABLE_REFERENCE, "write the path"),
        ("..", Code.OUTSIDE_TREE, "write a file of it"),
    ],
)
def test_what_the_library_does_not_have(path: str, code: Code, hint: str, write: Write) -> None:
    (found,) = load(
        write({"a.srg": f'include std "{path}"; module B {{ role base; }}'})
    ).diagnostics
    assert found.code is code
    assert hint in (found.hint or "")


def test_a_text_without_a_folder_includes_the_library_alone() -> None:
    assert load_text(f'include std "{SOME}";', "t").program is not None
    (found,) = load_text(f'include "{SOME}";', "t").diagnostics
    assert found.code is Code.UNREADABLE_REFERENCE


def test_a_program_means_the_same_with_copies(write: Write, tmp_path: Path) -> None:
    """As results keep them."""
    path = write({"a.srg": "".join(f'include std "{file.name}";\n' for file in FILES)})
    first = load(path).program
    shutil.copytree(LIBRARY, tmp_path / "@std")
    again = load(path)
    assert first is not None
    assert again.program == first
    assert all(str(tmp_path) in source.name for source in again.sources)


# --- what `srgc expand` makes of includes ---------------------------------------------------------

KIT = """
module Plate { role base; port out: F; frame out = in; }
module Hand { role effector; port in: F; effector(frame: in);
  hull(frame: in, file: "a.obj", scale: 1 m); }
grammar Arm from ports { start Plate; with Hand; }
"""


def test_an_included_kit_takes_the_place_of_its_include(write: Write, tmp_path: Path) -> None:
    files = {
        "main.srg": '// first\ninclude "lib/kit.srg";\ninclude "plain.srg";\n' + MINE,
        "lib/kit.srg": 'include "more/parts.srg"; // the kit\n' + KIT,
        "lib/more/parts.srg": "module Part { role link; } workspace W { plane xy; "
        'bounds box [0, 1] x [0, 1] m; obstacles from "yard.geojson"; }',
        "lib/a.obj": MESH,
        "lib/more/yard.geojson": '{"type": "FeatureCollection", "features": []}',
        "plain.srg": "module Plain { role link; }",
    }
    loaded = load(write(files))
    assert loaded.program is not None, loaded.diagnostics
    text = expanded(loaded)
    assert 'include "lib/more/parts.srg";' in text
    assert 'include "plain.srg";' in text
    assert "lib/kit.srg" not in text
    assert 'file: "lib/a.obj"' in text
    assert "// the kit" in text
    (tmp_path / "main.srg").write_text(text, encoding="utf-8")
    again = load(tmp_path / "main.srg")
    assert again.program is not None, again.diagnostics
    assert again.program.grammars == loaded.program.grammars
    assert again.program.modules == loaded.program.modules


def test_a_kit_that_is_included_twice_is_put_in_once(write: Write, tmp_path: Path) -> None:
    files = {
        "main.srg": 'include "kit.srg"; include "b.srg"; include "kit.srg";',
        "b.srg": 'include "kit.srg"; grammar Two from ports { start Plate; with Hand; }',
        "kit.srg": KIT,
        "a.obj": MESH,
    }
    loaded = load(write(files))
    text = expanded(loaded)
    assert text.count("module Hand") == 1
    assert "include" not in text
    (tmp_path / "main.srg").write_text(text, encoding="utf-8")
    again = load(tmp_path / "main.srg").program
    assert again is not None
    assert loaded.program is not None
    assert again.grammars == loaded.program.grammars


def test_the_page_names_all_robots_and_modules_of_the_kit() -> None:
    page = (Path(__file__).parents[2] / "docs/reference/library.md").read_text(encoding="utf-8")
    for file in FILES:
        assert f"`{file.name}`" in page
        syntax = load_text(file.read_text(encoding="utf-8"), "t").syntax
        assert syntax is not None
        kit = file.stem == "serial"
        named = [i.name.text for i in syntax.items if isinstance(i, s.Module if kit else s.Grammar)]
        assert [name for name in named if f"`{name}`" not in page] == []


def test_what_the_tasks_do_not_need_is_left_out(write: Write) -> None:
    """Of files that are put in; with the comments right above."""
    kit = """
    // The plate.
    module Plate { role base; port out: F; frame out = in; }
    // Never carried here.
    module Other { role effector; port in: F; effector(frame: in); }
    module Hand { role effector; port in: F; effector(frame: in); }
    // Of others.
    grammar Others from ports { start Plate; with Other; }
    grammar Arm from ports { start Plate; with Hand; }
    """
    task = """
    module Mine { role link; }
    workspace W { plane xy; bounds box [0, 1] x [0, 1] m; region A box [0, 1] x [0, 1] m; }
    task T { robot Arm; workspace W; start in A; reach A; horizon 1 steps of 1 s; }
    """
    text = expanded(load(write({"main.srg": 'include "kit.srg";' + task, "kit.srg": kit})))
    assert "Other" not in text
    assert "Never" not in text
    assert "Of others" not in text
    assert "// The plate." in text
    assert "module Mine" in text
    assert load_text(text, "t").program is not None
