"""Faults of imported files stand where the file has what is wrong."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any
from xml.parsers.expat import ParserCreate

import pytest
from hypothesis import given
from hypothesis import strategies as st

from srgc.imports.json_place import Place, json_file
from srgc.imports.meshes.mesh_file import read_mesh
from srgc.imports.source_fault import SourceFault
from srgc.imports.source_files import source_files
from srgc.imports.urdf.robot_model import robot_model
from srgc.imports.xml_source import xml_file

PARTS = st.sampled_from(
    ["<!-- <b> > -->", "<![CDATA[<c/>]]>", "<?d <e?>", "\n", "  ", "\u00e4\u00f6", "&lt;f", "\t"]
)
NAMES = st.sampled_from(["a", "robot", "x.y", "l\u00e4nge", "n:m"])
TEXTS = st.recursive(
    PARTS,
    lambda inner: st.builds(
        lambda name, blank, parts: f"<{name}{blank}p='>'{blank}>{''.join(parts)}</{name}>",
        NAMES,
        st.sampled_from([" ", "\n\t ", "\n\n"]),
        st.lists(inner, max_size=4),
    ),
    max_leaves=12,
)


def place(fault: SourceFault, file: str) -> tuple[int, int]:
    """Line and column as the message says them."""
    line, column = str(fault).removeprefix(f"{file}:").split(": error")[0].split(":")
    return int(line), int(column)


@given(st.lists(TEXTS, max_size=4))
def test_elements_are_where_expat_finds_them(texts: list[str]) -> None:
    text = f"<top xmlns:n='u'>{''.join(texts)}</top>"
    due = list[tuple[int, int]]()
    parser = ParserCreate()
    parser.StartElementHandler = lambda *_: due.append(
        (parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)
    )
    parser.Parse(text.encode(), True)
    file = xml_file(text.encode(), "f")
    assert [place(file.fault(element, "wrong"), "f") for element in file.root.iter()] == due


def leaves(at: Place) -> Iterator[Place]:
    if isinstance(at.value, dict):
        for key in at.value:
            yield from leaves(at[key])
    elif isinstance(at.value, list):
        for inner in at.entries():
            yield from leaves(inner)
    else:
        yield at


@given(
    st.recursive(
        st.just(0),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(st.text('ab"\\{[,: \u00e4', max_size=3), inner, max_size=3)
        ),
        max_leaves=15,
    ),
    st.sampled_from([None, 0, 3]),
)
def test_values_of_json_are_where_their_texts_are(tmp_path_factory, shape: Any, indent) -> None:
    numbers = count(10_000)

    def numbered(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: numbered(inner) for key, inner in value.items()}
        return [numbered(each) for each in value] if isinstance(value, list) else next(numbers)

    text = json.dumps(numbered(shape), indent=indent, ensure_ascii=False)
    path = tmp_path_factory.mktemp("json") / "f"
    path.write_text(text, encoding="utf-8")
    for leaf in leaves(json_file(source_files(path))):
        start = text.index(str(leaf.value))
        line = text.count("\n", 0, start) + 1
        column = start - (text.rfind("\n", 0, start) + 1) + 1
        assert place(leaf.fault("no"), str(path)) == (line, column)


def test_a_key_that_is_missing_is_at_its_object(tmp_path: Path) -> None:
    path = tmp_path / "f.json"
    path.write_text('{"a": [1,\n  {"b": 2}]}')
    with pytest.raises(SourceFault) as caught:
        json_file(source_files(path))["a"].entries()[1]["c"]
    assert str(caught.value) == (
        f'{path}:2:3: error[SRG0803]: a[1]: `c` is missing\n    2 |   {{"b": 2}}]}}\n      |   ^'
    )


def test_an_attribute_is_underlined() -> None:
    text = "<robot name='r'>\n<link name='a'/><link\n  name='b'><inertial><mass\n value = 'x'/>"
    text += "</inertial></link></robot>"
    with pytest.raises(SourceFault) as caught:
        robot_model(text.encode(), Path("r.urdf"))
    assert str(caught.value) == (
        "r.urdf:4:2: error[SRG0803]: `value` is `x`, no number\n"
        "    4 |  value = 'x'/></inertial></link></robot>\n"
        "      |  ^^^^^^^^^^^"
    )


def test_lines_that_go_on_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "m.obj"
    path.write_text("v 0 0 0\nv 1 0 \\\n 0\nv 0 1 0\nf 1 2 \\\n  3\nf 1 2 x\n")
    with pytest.raises(SourceFault, match=r"m.obj:7:1: error\[SRG0801\]"):
        read_mesh(path)
    path.write_text("v 0 0 0\r\nv 1 0 \\\r\n 0\r\nv 0 1 0\r\nf 1 2 \\\r\n  3")
    assert len(read_mesh(path).triangles) == 1
