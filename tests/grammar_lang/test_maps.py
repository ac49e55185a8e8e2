"""Names of maps: what they are, what else may not have them, where they may stand."""

from __future__ import annotations

from pathlib import Path

import pytest

from grammar_lang.load import Loaded, load
from grammar_lang.names.declarations import map_name
from grammar_lang.parsing.tables import RESERVED

SPEC = """\
module B {{ role base; }}
module J {{ role joint; dof q: prismatic x; }}
module E {{ role effector; }}
grammar G {{ start N; n: N -> B J E; }}
semantics G {{
  n {{ this.at = move(x, J.q); point(frame: this.at, mass: 1 kg); effector(frame: this.at); }}
}}
workspace W {{
  plane xy;
  bounds box [0, 9] x [0, 9];
  region A box [0, 1] x [0, 1];
  {items}
}}
task T {{
  robot G;
  workspace W;
  start in A;
  effort <= 1 N;
  horizon 2 steps of 1 s;
  {clauses}
}}
"""
EMPTY = '{"type": "FeatureCollection", "features": []}'
YARD = 'obstacles from "m/yard.json";'


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("yard.yaml", "yard"),
        ("maps/yard.yaml", "yard"),
        ("./a.b/Yard_2.GEOJSON", "Yard_2"),
        ("2nd floor.yaml", "_2nd_floor"),
        ("hall-7.v2.json", "hall_7_v2"),
        ("Füße.yaml", "F__e"),
        ("start.yaml", "_start"),
        ("x.json", "_x"),
        ("last.json", "last"),
        (".yaml", "_yaml"),
        ("m/", "_"),
        ("", "_"),
        ("7", "_7"),
    ],
)
def test_names_of_files(path: str, name: str) -> None:
    assert map_name(path) == name


@pytest.mark.parametrize("word", RESERVED)
def test_reserved_words_are_no_names(word: str) -> None:
    assert map_name(f"{word}.yaml") == f"_{word}"


def loaded(tmp_path: Path, items: str, clauses: str, **maps: str) -> Loaded:
    (tmp_path / "m").mkdir(exist_ok=True)
    for name, text in {"yard": EMPTY, "other": EMPTY, **maps}.items():
        (tmp_path / "m" / f"{name}.json").write_text(text)
    path = tmp_path / "a.srg"
    path.write_text(SPEC.format(items=items, clauses=clauses))
    return load(path)


def said(found: Loaded) -> list[tuple[str, str]]:
    """Code and place of every finding."""
    return [
        (d.code.value, found.sources[d.span.file].text[d.span.start : d.span.end])
        for d in found.diagnostics
        if d.code.value != "SRG0206"
    ]


@pytest.mark.parametrize(
    "clauses",
    [
        "reach A; avoid yard with effector;",
        "reach A; avoid A, yard with body margin 0.1 m;",
        "satisfy always not yard and eventually A;",
        "satisfy not yard by effector 1 until A;",
    ],
)
def test_where_a_map_may_stand(tmp_path: Path, clauses: str) -> None:
    found = loaded(tmp_path, YARD, clauses)
    assert said(found) == []
    assert found.program is not None
    assert [m.name for m in found.program.workspaces["W"].maps] == ["yard"]


@pytest.mark.parametrize(
    ("items", "clauses", "expected"),
    [
        (YARD, "reach yard;", [("SRG0203", "yard")]),
        (YARD, "reach A; avoid yrad with body;", [("SRG0201", "yrad")]),
        (YARD, "reach yrad;", [("SRG0201", "yrad")]),
        (YARD, "reach A; satisfy always not yardd;", [("SRG0201", "yardd")]),
        (YARD + YARD, "reach A;", [("SRG0202", '"m/yard.json"')]),
        (YARD + "target yard box [2, 3] x [2, 3];", "reach A;", [("SRG0202", "yard")]),
        ("obstacle yard box [2, 3] x [2, 3];" + YARD, "reach A;", [("SRG0202", '"m/yard.json"')]),
        # Of a map that cannot be read the name is known all the same, and nothing else is said.
        ('obstacles from "none.json";', "reach A; avoid none with body;",
         [("SRG0109", '"none.json"')]),
        ('obstacles from "none.json"; region none box [0, 1] x [0, 1];', "reach A;",
         [("SRG0109", '"none.json"'), ("SRG0202", "none")]),
        ("", "reach A; avoid W with body;", [("SRG0203", "W")]),
    ],
)  # fmt: skip
def test_findings(
    tmp_path: Path, items: str, clauses: str, expected: list[tuple[str, str]]
) -> None:
    assert said(loaded(tmp_path, items, clauses)) == expected


def test_hints_and_notes(tmp_path: Path) -> None:
    [error] = loaded(tmp_path, YARD, "reach A; avoid yrad with body;").diagnostics
    assert error.hint == "did you mean `yard`?"
    # A place to go to is looked for among the regions.
    [error] = loaded(tmp_path, YARD, "reach yrad;").diagnostics
    assert error.hint == "known: `A`"
    found = loaded(tmp_path, YARD, "reach yard;")
    [error] = found.diagnostics
    [(span, _)] = error.notes
    assert found.sources[0].text[span.start : span.end] == '"m/yard.json"'
    assert error.hint == "name a region; a map is avoided, or named in a formula"
    other = 'workspace V { plane xy; bounds box [0, 1] x [0, 1]; obstacles from "m/other.json"; }'
    found = loaded(tmp_path, "} " + other + " workspace Z { plane xy; bounds box [0, 1] x [0, 1];",
                   "reach A; avoid other with body;")  # fmt: skip
    [error] = [d for d in found.diagnostics if d.code.value == "SRG0203"]
    assert error.message == (
        "`other` is a map of obstacles of workspace `V`, not a region of workspace `W`"
    )


def test_a_map_in_space_is_reported_once(tmp_path: Path) -> None:
    items = 'obstacles from "m/yard.json";'
    path = tmp_path / "a.srg"
    text = SPEC.format(items=items, clauses="reach A; avoid yard with body;")
    loaded(tmp_path, items, "reach A;")
    for flat, solid in (
        ("plane xy", "space xyz"),
        ("[0, 9] x [0, 9]", "[0, 9] x [0, 9] x [0, 9]"),
        ("[0, 1] x [0, 1]", "[0, 1] x [0, 1] x [0, 1]"),
    ):
        text = text.replace(flat, solid)
    path.write_text(text)
    assert said(load(path)) == [("SRG0507", items)]
