"""Includes and maps: which files a program is made of, and what is said of the others."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from grammar_lang.diagnostics.render import records, to_text
from grammar_lang.load import Loaded, load, load_text

Write = Callable[[Mapping[str, str | bytes]], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Files by their paths below ``tmp_path/tree``; gives the first one's path."""

    def make(files: Mapping[str, str | bytes]) -> Path:
        top = tmp_path / "tree"
        for name, content in files.items():
            path = top / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return top / next(iter(files))

    return make


def found(loaded: Loaded) -> list[tuple[str, str, str]]:
    """Code, path of the file and marked text of every finding, each with a hint."""
    shown = []
    for diagnostic in loaded.diagnostics:
        source, span = loaded.sources[diagnostic.span.file], diagnostic.span
        assert diagnostic.hint
        assert "\n" not in diagnostic.message
        shown.append((diagnostic.code.value, source.path, source.text[span.start : span.end]))
    assert to_text(loaded.diagnostics, loaded.sources).count("hint: ") == len(shown)
    return shown


def messages(loaded: Loaded) -> list[str]:
    return [diagnostic.message for diagnostic in loaded.diagnostics]


def module(name: str) -> str:
    return f"module {name} {{ role link; }}\n"


# --- the order and the number of times -----------------------------------------------------------


def test_items_come_in_the_place_of_their_include(write: Write) -> None:
    loaded = load(
        write(
            {
                "a.srg": module("A1") + 'include "sub/b.srg";\n' + module("A2"),
                "sub/b.srg": module("B1") + 'include "c.srg";' + module("B2"),
                "sub/c.srg": module("C"),
            }
        )
    )
    assert loaded.diagnostics == ()
    assert loaded.program is not None
    assert loaded.program.terminals == ("A1", "B1", "C", "B2", "A2")
    assert [source.path for source in loaded.sources] == ["a.srg", "sub/b.srg", "sub/c.srg"]
    assert loaded.program.sources == loaded.sources


def test_one_program_in_several_files(write: Write, build: Callable[..., str], arm: str) -> None:
    """Cut anywhere between its items, a text means what it meant in one piece."""
    whole = load_text(arm, "t").program
    pieces = re.split(r"(?<=^\}\n)", arm, flags=re.MULTILINE)
    assert len(pieces) > 4
    files = {f"p/{i}.srg": piece for i, piece in enumerate(pieces)}
    main = "".join(f'include "{name}";' for name in files)
    loaded = load(write({"main.srg": main, **files}))
    assert loaded.program == whole
    assert whole is not None


def test_a_diamond_is_read_once(write: Write) -> None:
    loaded = load(
        write(
            {
                "a.srg": 'include "b.srg"; include "c.srg"; include "./x/../d.srg";',
                "b.srg": 'include "d.srg";' + module("B"),
                "c.srg": module("C") + 'include "d.srg"; include "d.srg";',
                "d.srg": module("D"),
            }
        )
    )
    assert loaded.diagnostics == ()
    assert loaded.program is not None
    assert loaded.program.terminals == ("D", "B", "C")
    assert [source.path for source in loaded.sources] == ["a.srg", "b.srg", "d.srg", "c.srg"]


def test_a_link_inside_the_tree_is_the_same_file(write: Write) -> None:
    path = write(
        {"a.srg": 'include "m.srg"; include "n.srg"; include "n.srg";', "m.srg": "edge e;"}
    )
    (path.parent / "n.srg").symlink_to("m.srg")
    loaded = load(path)
    assert loaded.diagnostics == ()
    assert loaded.program is not None
    assert loaded.program.terminals == ("e",)
    assert [(s.path, s.twin) for s in loaded.sources] == [
        ("a.srg", None),
        ("m.srg", None),
        ("n.srg", "m.srg"),
    ]


@pytest.mark.parametrize("text", ["", "// nothing\n", "/* still */", "\ufeff", "\ufeff\r\n"])
def test_an_included_file_may_declare_nothing(write: Write, text: str) -> None:
    loaded = load(write({"a.srg": 'include "b.srg";', "b.srg": text}))
    assert loaded.diagnostics == ()
    assert loaded.program is not None


def test_byte_order_mark_and_line_ends_do_not_matter(write: Write) -> None:
    text = "\ufeff// é\r\nmodule L { role link;\r\n const a = 3 kgs; }\r\n"
    loaded = load(write({"a.srg": "edge e;\ninclude 'b.srg';", "b.srg": text}))
    (record,) = records(loaded.diagnostics, loaded.sources)
    assert (record["line"], record["column"]) == (3, 14)
    assert str(record["file"]).endswith("b.srg")


def test_names_of_any_letters(write: Write) -> None:
    name = "größe 机器人/ ~&;'x'.srg"
    loaded = load(write({"a.srg": f'include "{name}";', name: module("M")}))
    assert loaded.program is not None
    assert loaded.sources[1].path == name


@pytest.mark.parametrize("text", ['// include "no.srg";', '/* include "no.srg"; */', "edge 'i';"])
def test_an_include_in_a_comment_is_none(write: Write, text: str) -> None:
    assert load(write({"a.srg": f"{module('A')}{text}"})).diagnostics == ()


# --- cycles --------------------------------------------------------------------------------------


@pytest.mark.parametrize("length", [1, 2, 3, 7, 8])
def test_cycles(write: Write, length: int) -> None:
    names = [f"f{i}.srg" for i in range(length)]
    files = {
        name: module(f"M{i}") + f'include "{names[(i + 1) % length]}";'
        for i, name in enumerate(names)
    }
    loaded = load(write(files))
    assert found(loaded) == [("SRG0107", names[-1], '"f0.srg"')]
    chain = [*names, "f0.srg"]
    if length == 8:
        chain = [*names[:3], "… 2 more …", *names[-3:], "f0.srg"]
    assert messages(loaded) == [f"a file includes itself: {' -> '.join(chain)}"]
    assert loaded.program is None


def test_a_cycle_beside_the_way(write: Write) -> None:
    """The chain begins at the file that is included twice, not at the main one."""
    loaded = load(
        write(
            {
                "a.srg": 'include "s/b.srg";',
                "s/b.srg": "include 'c.srg';",
                "s/c.srg": "include 'b.srg';",
            }
        )
    )
    assert messages(loaded) == ["a file includes itself: s/b.srg -> s/c.srg -> s/b.srg"]


def test_a_cycle_through_links(write: Write) -> None:
    path = write({"a.srg": 'include "s/up/a.srg";', "s/b.srg": ""})
    (path.parent / "s" / "up").symlink_to("..")
    loaded = load(path)
    assert messages(loaded) == ["a file includes itself: a.srg -> s/up/a.srg"]


def test_a_deep_chain(write: Write) -> None:
    count = 2000
    files = {f"f{i}.srg": f'include "f{i + 1}.srg"; edge e{i};' for i in range(count)}
    path = write({**files, f"f{count}.srg": "edge last;"})
    start = time.perf_counter()
    loaded = load(path)
    assert time.perf_counter() - start < 10
    assert loaded.program is not None
    assert loaded.program.terminals == ("last", *(f"e{i}" for i in reversed(range(count))))


# --- outside the tree ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "target", ["../out.srg", "sub/../../out.srg", "../tree/b.srg", "..", "sub/../..", "/etc/passwd"]
)
def test_paths_that_climb_out(write: Write, target: str) -> None:
    path = write({"a.srg": f'include "{target}";', "sub/b.srg": "", "../out.srg": "edge e;"})
    assert found(load(path)) == [("SRG0108", "a.srg", f'"{target}"')]


def test_an_absolute_path_even_into_the_tree(write: Write) -> None:
    path = write({"a.srg": "", "b.srg": "edge e;"})
    target = path.parent / "b.srg"
    path.write_text(f'include "{target}";')
    assert [code for code, _, _ in found(load(path))] == ["SRG0108"]


def test_the_tree_is_that_of_the_file_on_the_command_line(write: Write) -> None:
    files = {
        "a.srg": "edge a; include 'sub/b.srg';",
        "sub/b.srg": "include '../c.srg';",
        "c.srg": "edge c;",
    }
    path = write(files)
    assert load(path).diagnostics == ()
    assert found(load(path.parent / "sub" / "b.srg")) == [("SRG0108", "b.srg", "'../c.srg'")]


@pytest.mark.parametrize("kind", ["file", "folder", "dangling", "through"])
def test_links_that_lead_out(write: Write, tmp_path: Path, kind: str) -> None:
    path = write({"a.srg": 'include "link.srg";', "../out/x.srg": "edge e;"})
    link, out = path.parent / "link.srg", tmp_path / "out"
    if kind == "folder":
        path.write_text('include "link/x.srg";')
        (path.parent / "link").symlink_to(out)
    elif kind == "through":
        (path.parent / "middle").symlink_to("../out/x.srg")
        link.symlink_to("middle")
    else:
        link.symlink_to(out / ("x.srg" if kind == "file" else "none.srg"))
    [(code, file, _)] = found(load(path))
    assert (code, file) == ("SRG0108", "a.srg")


def test_a_sibling_whose_name_begins_alike_is_outside(write: Write) -> None:
    path = write({"a.srg": 'include "link.srg";', "../tree2/x.srg": "edge e;"})
    (path.parent / "link.srg").symlink_to("../tree2/x.srg")
    assert [code for code, _, _ in found(load(path))] == ["SRG0108"]


def test_a_folder_that_is_reached_by_a_link_is_a_tree(write: Write, tmp_path: Path) -> None:
    write({"a.srg": 'include "b.srg";', "b.srg": "edge e;"})
    (tmp_path / "link").symlink_to("tree")
    assert load(tmp_path / "link" / "a.srg").diagnostics == ()


# --- files that cannot be read -------------------------------------------------------------------


MISSING, FOLDER, READABLE = (
    "no such file or directory",
    "it is a folder",
    "give the path of a file that can be read",
)


@pytest.mark.parametrize(
    ("target", "why", "hint"),
    [
        ("sub/", FOLDER, "write the path of a file"),
        ("sub", FOLDER, READABLE),
        (".", FOLDER, "write the path of a file"),
        ("sub/..", FOLDER, READABLE),
        ("pipe", "it is not a regular file", READABLE),
        ("modul.srg", MISSING, "did you mean `modules.srg`?"),
        ("sub/bb.srg", MISSING, "did you mean `sub/b.srg`?"),
        ("modules", MISSING, "did you mean `modules.srg`?"),
        ("xyz.srg", MISSING, "known: `a.srg`, `modules.srg`"),
        ("sub/q", MISSING, "known: `sub/b.srg`"),
        ("no/b.srg", MISSING, "there is no folder `no`"),
        ("leer/b.srg", MISSING, "that folder has no file that ends in `.srg`"),
        ("a.srg/b.srg", "not a directory", "there is no folder `a.srg`"),
    ],
)
def test_unreadable_files(write: Write, target: str, why: str, hint: str) -> None:
    path = write({"a.srg": f'edge e; include "{target}";', "modules.srg": "", "sub/b.srg": ""})
    (path.parent / "leer").mkdir()
    os.mkfifo(path.parent / "pipe")
    loaded = load(path)
    assert found(loaded) == [("SRG0109", "a.srg", f'"{target}"')]
    said = f"cannot read `{target}`: {why}"
    assert [(d.message, d.hint) for d in loaded.diagnostics] == [(said, hint)]


@pytest.mark.parametrize(
    ("target", "said", "hint"),
    [
        ("", "an empty path", "write the path of a file"),
        ("s\\b.srg", "a backslash in a path", "folders are separated by `/`: `s/b.srg`"),
    ],
)
def test_what_is_no_path(write: Write, target: str, said: str, hint: str) -> None:
    loaded = load(write({"a.srg": f'edge e; include "{target}";'}))
    assert found(loaded) == [("SRG0109", "a.srg", f'"{target}"')]
    assert [(d.message, d.hint) for d in loaded.diagnostics] == [(said, hint)]


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is forbidden to root")
def test_a_file_that_may_not_be_opened(write: Write) -> None:
    path = write({"a.srg": 'include "b.srg";', "b.srg": "edge e;"})
    (path.parent / "b.srg").chmod(0)
    assert messages(load(path)) == ["cannot read `b.srg`: permission denied"]


def test_links_in_a_circle(write: Write) -> None:
    path = write({"a.srg": 'include "x.srg";'})
    (path.parent / "x.srg").symlink_to("y.srg")
    (path.parent / "y.srg").symlink_to("x.srg")
    assert [code for code, _, _ in found(load(path))] == ["SRG0109"]


def test_a_text_without_a_folder_has_the_library() -> None:
    loaded = load_text('include std "serial.srg";', "<stdin>")
    assert loaded.program is not None
    assert "Std_Plate" in loaded.program.modules
    missing = load_text('include std "cereal.srg";', "<stdin>")
    assert [code for code, _, _ in found(missing)] == ["SRG0109"]
    [finding] = missing.diagnostics
    assert finding.hint == "did you mean `serial.srg`?"


@pytest.mark.parametrize("length", [300, 5000, 100_000])
def test_paths_that_are_too_long(write: Write, length: int) -> None:
    loaded = load(write({"a.srg": f'include "{"n" * length}";'}))
    assert [code for code, _, _ in found(loaded)] == ["SRG0109"]
    assert len(messages(loaded)[0]) < 200


def test_a_text_has_no_folder(write: Write, tmp_path: Path) -> None:
    text = 'edge a; include "b.srg"; workspace W { plane xy; obstacles from "m.json"; }'
    loaded = load_text(text, "<stdin>")
    assert [code for code, _, _ in found(loaded)] == ["SRG0109", "SRG0109"]
    assert all("has no folder" in message for message in messages(loaded))
    write({"b.srg": "edge b;"})
    loaded = load_text('edge a; include "b.srg";', "<stdin>", tmp_path / "tree")
    assert loaded.program is not None
    assert loaded.program.terminals == ("a", "b")


# --- errors in included files --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "code", "line", "column"),
    [
        (b"edge eps;\nedge \xff;", "SRG0102", 2, 6),
        (b"edge eps;\r\nedge\0;", "SRG0103", 2, 5),
        (b"\xef\xbb\xbfedge eps;\r\nedge ;", "SRG0104", 2, 6),
        (b"edge \xc2\xb0;", "SRG0103", 1, 6),
        (b"edge a; /* open", "SRG0104", 1, 9),
        (b"module L { role link; const a = 1 kgs; }", "SRG0302", 1, 35),
    ],
)
def test_errors_in_an_included_file(
    write: Write, content: bytes, code: str, line: int, column: int
) -> None:
    loaded = load(write({"a.srg": 'include "s/b.srg";\n', "s/b.srg": content}))
    assert loaded.program is None
    (record,) = records(loaded.diagnostics, loaded.sources)
    assert (record["code"], record["line"], record["column"]) == (code, line, column)
    assert str(record["file"]).endswith("/s/b.srg")


def test_errors_of_all_files_in_one_run(write: Write) -> None:
    loaded = load(
        write(
            {
                "a.srg": 'include "no.srg"; include "b.srg"; module { }',
                "b.srg": 'edge ; include "../x"; include "c.srg";',
                "c.srg": b"\xff",
            }
        )
    )
    codes = [(code, path) for code, path, _ in found(loaded)]
    assert codes == [
        ("SRG0109", "a.srg"),
        ("SRG0104", "a.srg"),
        ("SRG0104", "b.srg"),
        ("SRG0108", "b.srg"),
        ("SRG0102", "c.srg"),
    ]


def test_one_name_in_two_files(write: Write) -> None:
    loaded = load(write({"a.srg": "include 'b.srg';\n" + module("M"), "b.srg": module("M")}))
    assert found(loaded) == [("SRG0202", "a.srg", "M")]
    ((span, _),) = loaded.diagnostics[0].notes
    assert loaded.sources[span.file].path == "b.srg"
    assert re.search(r"b\.srg:1:8: note: ", to_text(loaded.diagnostics, loaded.sources))


def test_the_same_bytes_in_two_files_are_two_declarations(write: Write) -> None:
    files = {"a.srg": "include 'b.srg'; include 'c.srg';", "b.srg": "edge e;", "c.srg": "edge e;"}
    assert found(load(write(files))) == [("SRG0202", "c.srg", "e")]


def test_files_are_called_as_the_user_calls_them(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write(
        {"a.srg": "include 's/b.srg';", "s/b.srg": "include './../c.srg';", "c.srg": "edge ;"}
    )
    monkeypatch.chdir(tmp_path)
    for name in (Path("tree/a.srg"), path, Path("tree/../tree/a.srg")):
        (record,) = records(load(name).diagnostics, load(name).sources)
        assert record["file"] == str(name.parent / "c.srg")
    monkeypatch.chdir(path.parent)
    (record,) = records(load(Path("a.srg")).diagnostics, load(Path("a.srg")).sources)
    assert record["file"] == "c.srg"


# --- sizes ---------------------------------------------------------------------------------------

LIMIT = 8 * 1024 * 1024


@pytest.mark.parametrize("over", [0, 1])
def test_the_limit_is_of_all_files_together(write: Write, over: int) -> None:
    main = 'edge e; include "b.srg"; include "b.srg";'
    loaded = load(write({"a.srg": main, "b.srg": b" " * (LIMIT - len(main) + over)}))
    if not over:
        assert loaded.diagnostics == ()
        return
    assert found(loaded)[0] == ("SRG0110", "a.srg", '"b.srg"')
    assert messages(loaded)[0] == "with `b.srg` the files have 8,388,609 bytes, more than 8,388,608"


def test_a_large_main_file(tmp_path: Path) -> None:
    path = tmp_path / "a.srg"
    path.write_bytes(b"(" * (LIMIT + 1))
    for loaded in (load(path), load_text("(" * (LIMIT + 1), "t")):
        assert [d.code.value for d in loaded.diagnostics] == ["SRG0110"]
        assert "8,388,609 bytes, more than 8,388,608" in loaded.diagnostics[0].message


# --- maps ----------------------------------------------------------------------------------------

YAML = "image: hall.pgm\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\n"
HALL = 'workspace W {{ {}; bounds box [0, 1] x [0, 1]; obstacles from "{}"; }}'


def hall(name: str) -> str:
    return HALL.format("plane xy", name)


@pytest.mark.parametrize(
    "image",
    [
        "hall.pgm",
        '"hall.pgm"',
        "'hall.pgm'  # drawn by hand",
        "hall.pgm\t# x",
        "./x/../hall.pgm \r",
    ],
)
def test_a_map_of_map_server(write: Write, image: str) -> None:
    text = YAML.replace("hall.pgm", image)
    loaded = load(
        write({"a.srg": hall("maps/hall.yaml"), "maps/hall.yaml": text, "maps/hall.pgm": b"P5\0"})
    )
    assert loaded.diagnostics == ()
    assert loaded.program is not None
    (found_map,) = loaded.program.workspaces["W"].maps
    assert (found_map.path, found_map.kind, found_map.text) == (
        "maps/hall.yaml",
        "map_server",
        text,
    )
    assert found_map.image is not None
    assert (found_map.image.path, found_map.image.data) == ("maps/hall.pgm", b"P5\0")
    assert loaded.sources[found_map.file].path == "maps/hall.yaml"
    assert [s.path for s in loaded.sources] == ["a.srg", "maps/hall.yaml", "maps/hall.pgm"]
    assert loaded.sources[2].data == b"P5\0"


def test_a_quote_in_the_name_of_an_image(write: Write) -> None:
    text = YAML.replace("hall.pgm", "'Anna''s #1.pgm'")
    loaded = load(write({"a.srg": hall("m.yml"), "m.yml": text, "Anna's #1.pgm": b""}))
    assert loaded.program is not None


@pytest.mark.parametrize("name", ["m.geojson", "m.json", "M.GEOJSON"])
def test_geojson(write: Write, name: str) -> None:
    text = '{"type": "FeatureCollection", "features": []}'
    loaded = load(write({"s/a.srg": hall(name), f"s/{name}": text}))
    assert loaded.program is not None
    (found_map,) = loaded.program.workspaces["W"].maps
    assert (found_map.path, found_map.kind, found_map.text, found_map.image) == (
        name, "geojson", text, None,
    )  # fmt: skip


def test_a_map_in_an_included_file_lies_beside_it(write: Write) -> None:
    text = '{"type": "Polygon"}'
    files = {
        "a.srg": "include 's/b.srg'; include 's/c.srg';",
        "s/b.srg": hall("m.json"),
        "s/m.json": text,
    }
    loaded = load(write({**files, "s/c.srg": hall("m.json").replace("W", "V")}))
    assert loaded.program is not None
    paths = [m.path for w in loaded.program.workspaces.values() for m in w.maps]
    assert paths == ["s/m.json", "s/m.json"]
    assert [source.path for source in loaded.sources].count("s/m.json") == 1


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("none.yaml", "", ("SRG0109", "a.srg", '"none.yaml"')),
        ("m.png", "x", ("SRG0109", "a.srg", '"m.png"')),
        ("../m.yaml", YAML, ("SRG0108", "a.srg", '"../m.yaml"')),
        ("m.yaml", "resolution: 1\norigin: [0, 0, 0]", ("SRG0109", "m.yaml", "r")),
        ("m.yaml", YAML.replace("origin", "# origin"), ("SRG0109", "m.yaml", "i")),
        ("m.yaml", YAML.replace("resolution", " resolution"), ("SRG0109", "m.yaml", "i")),
        ("m.yaml", YAML.replace("hall", "hal"), ("SRG0109", "m.yaml", "hal.pgm")),
        ("m.yaml", YAML.replace("hall", "/tmp/hall"), ("SRG0108", "m.yaml", "/tmp/hall.pgm")),
        ("m.yaml", YAML.replace("hall", "'../hall"), ("SRG0109", "m.yaml", "'")),
        ("m.yaml", YAML.replace(" hall.pgm", ' "../h.pgm"'), ("SRG0108", "m.yaml", '"../h.pgm"')),
        ("m.yaml", YAML.replace(" hall.pgm", ""), ("SRG0109", "m.yaml", "\n")),
        ("m.yaml", b"\xff", ("SRG0102", "m.yaml", "\ufffd")),
        ("m.json", b"{\0}", ("SRG0103", "m.json", "\0")),
        ("m.json", "", ("SRG0109", "m.json", "")),
        ("m.json", '{"type": }', ("SRG0109", "m.json", "}")),
        ("m.json", "[" * 200_000, ("SRG0109", "m.json", "[")),
        ("m.json", "9" * 10_000, ("SRG0109", "m.json", "9")),
        ("m.json", '{"type": NaN}', ("SRG0109", "m.json", "{")),
        ("m.json", '{"type": "Poligon"}', ("SRG0109", "m.json", "{")),
        ("m.json", '{"type": ["Polygon"]}', ("SRG0109", "m.json", "{")),
        ("m.json", '{"typ": "Polygon"}', ("SRG0109", "m.json", "{")),
        ("m.json", '["type"]', ("SRG0109", "m.json", "[")),
    ],
)
def test_maps_that_are_none(
    write: Write, name: str, content: str | bytes, expected: tuple[str, str, str]
) -> None:
    files: dict[str, str | bytes] = {"a.srg": hall(name), "hall.pgm": b"P5"}
    if name.startswith("m"):
        files[name] = content
    assert found(load(write(files))) == [expected]


def test_a_misspelt_map(write: Write) -> None:
    loaded = load(write({"a.srg": hall("hal.yaml"), "hall.yml": "", "hall.pgm": ""}))
    assert [d.hint for d in loaded.diagnostics] == ["did you mean `hall.yml`?"]


def test_maps_lie_in_the_plane(write: Write) -> None:
    text = HALL.format("space xyz", "m.json").replace("x [0, 1];", "x [0, 1] x [0, 1];")
    loaded = load(write({"a.srg": text, "m.json": '{"type": "Point"}'}))
    assert found(loaded) == [("SRG0507", "a.srg", 'obstacles from "m.json";')]
