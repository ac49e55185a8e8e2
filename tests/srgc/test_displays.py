"""What objects show of themselves in notebooks: sound HTML that says the same as plain text."""

from __future__ import annotations

import base64
import shutil
import subprocess
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import srgc
from tests.oracles.small_specs import TURNER

SVG = "http://www.w3.org/2000/svg"

ROOT = Path(__file__).parents[2]
VOID = {"br", "img", "meta", "hr"}
ODD = TURNER.replace("edge eps;", 'edge "<b>&";').replace(" eps ", ' "<b>&" ')
ODD_WORD = "B <b>& JO <b>& L <b>& EN"


class MembershipTest(HTMLParser):
    """Elements, their attributes and text; every element has to be closed in its turn."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.style = ""

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] == ["style"]:
            self.style += data
        else:
            self.text += data


def read(thing):
    """The display of a thing, which brings no scripts and loads nothing."""
    shown = thing if isinstance(thing, str) else thing._repr_html_()
    reader = MembershipTest()
    reader.feed(shown)
    reader.close()
    assert reader.open == []
    names = {tag for tag, _ in reader.tags}
    assert not names & {"script", "link", "object"}
    assert not names & {"b", "i"}, "a name of the specification has become an element"
    for tag, attributes in reader.tags:
        assert not any(name.startswith("on") for name in attributes), tag
        assert (attributes.get("src") or "data:").startswith("data:")
    assert "http" not in reader.style
    return reader


def pictures(reader):
    """The SVG pictures in a display, each read as XML."""
    found = [attributes for tag, attributes in reader.tags if tag == "img"]
    assert all(attributes["alt"] for attributes in found)
    data = [attributes["src"].partition("base64,")[2] for attributes in found]
    return [ET.fromstring(base64.b64decode(each)) for each in data]


@pytest.fixture(scope="module")
def odd():
    return srgc.load(text=ODD)


def test_a_program(odd):
    shown = read(odd)
    assert "Turner" in shown.text
    assert "plane: region S, obstacle O, target T" in shown.text
    assert 'edge "<b>&";' in shown.text
    assert "module     L              link, parameter length" in str(odd)
    assert repr(odd) == "<Program spec.srg: tasks Turn>"


def test_findings_have_their_carets():
    text = ODD.replace("reach T;", "reach <script>;")
    found = srgc.check(text=text)
    shown = read(found)
    line = next(line for line in text.splitlines() if "script" in line)
    assert line.strip() in shown.text
    assert "^" in shown.text
    assert "bad" in {attributes.get("class") for _, attributes in shown.tags}
    assert all(line in shown.text for line in str(found).splitlines()[:-1])
    fine = read(srgc.check(text=ODD))
    assert "1 file without errors" in fine.text


def test_an_automaton_without_graphviz(odd, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    graph = srgc.graph(odd, "sra", highlight=ODD_WORD)
    shown = read(graph)
    assert sum(tag == "tr" for tag, _ in shown.tags) == len(graph.picture.edges) + 1
    assert "N <b>& JO" in shown.text
    marked = [attributes for _, attributes in shown.tags if attributes.get("class") == "bad"]
    assert len(marked) == 3 * sum(edge.highlighted for edge in graph.picture.edges) > 0
    assert "◎" in shown.text
    (said,) = graph.picture.caption
    assert said in shown.text
    assert str(graph).splitlines()[-1] == said
    assert len(str(graph).splitlines()) == len(graph.picture.edges) + 2


def test_an_automaton_by_graphviz(odd, monkeypatch):
    asked = []

    def draw(command, **options):
        asked.append((command, options["input"].decode()))
        return subprocess.CompletedProcess(command, 0, b"<svg><title>drawn</title></svg>", b"")

    monkeypatch.setattr(shutil, "which", lambda _: "/usr/bin/dot")
    monkeypatch.setattr(subprocess, "run", draw)
    graph = srgc.graph(odd, "sra")
    [picture] = pictures(read(graph))
    assert picture.findtext("title") == "drawn"
    assert asked == [(["/usr/bin/dot", "-Tsvg"], graph.dot)]
    failed = subprocess.CompletedProcess([], 1, b"", b"no")
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: failed)
    assert "table" in {tag for tag, _ in read(graph).tags}


def test_a_large_graph_is_not_drawn_whole(odd):
    graph = srgc.graph(odd, "words", depth=7)
    assert len(graph.picture.edges) > 200
    shown = read(graph)
    assert sum(tag == "tr" for tag, _ in shown.tags) == 201
    assert f"and {len(graph.picture.edges) - 200} more" in shown.text


def joints_and_tool(picture):
    """Where the joints and effectors of a drawing are, in its units; y goes down."""
    marks = [g for g in picture.iter(f"{{{SVG}}}g") if g.get("class") in ("joint", "effector")]
    return np.array([[float(x) for x in g.get("transform")[10:-1].split()] for g in marks])


def test_a_robot_is_drawn_to_scale():
    """Joints and tool of a two-link arm: sides of the drawing are as those of the arm."""
    program = srgc.load(ROOT / "specs" / "planar_arm.srg")
    arm = srgc.robot(program, "B eps JO eps L eps JO eps L eps EN", [2, 1])
    first, second, tool = joints_and_tool(ET.fromstring(arm.svg([0.3, 1.2])))
    upper, lower = np.linalg.norm(second - first), np.linalg.norm(tool - second)
    assert upper / lower == pytest.approx(2, rel=0.01)
    turn = [np.arctan2(-(b - a)[1], (b - a)[0]) for a, b in ((first, second), (second, tool))]
    np.testing.assert_allclose(turn, [0.3, 1.5], atol=0.01)
    with pytest.raises(srgc.SrgcError, match="is expected"):
        arm.svg([0.3])


@pytest.mark.parametrize(
    ("spec", "marks"),
    [("two_arm", "circle"), ("l_shaped", "circle"), ("prismatic", "path"), ("motor_arm", "circle")],
)
def test_all_kinds_of_robots_show_themselves(spec, marks):
    program = srgc.load(ROOT / "specs" / f"{spec}.srg")
    robots = (srgc.robot(program, word) for word in srgc.words(program, limit=40))
    robot = next(
        one for one in robots if "prismatic" in one.dofs or (marks == "circle" and one.dofs)
    )
    [picture] = pictures(read(robot))
    drawn = [g for g in picture.iter(f"{{{SVG}}}g") if g.get("class") == "joint"]
    assert f"{{{SVG}}}{marks}" in {g[0].tag for g in drawn}
    shown = read(robot).text
    for number in range(len(robot.dofs)):
        assert f"q{number + 1}" in shown


def test_a_robot_of_odd_names(odd):
    shown = read(srgc.robot(odd, ODD_WORD))
    assert ODD_WORD in shown.text


def test_a_plan(odd):
    plan = srgc.plan(odd)
    shown = read(plan)
    assert len(pictures(shown)) == 1
    assert all(name in shown.text for name in plan.paths[1])
    assert repr(plan).startswith("<Plan: S > ")


def test_a_found_result(made):
    result = srgc.open_result(made("turner") / "out")
    before = read(result)
    assert "not verified yet" in before.text
    answer = result.verify()
    after = read(result)
    assert "verified: valid, level validated" in after.text
    assert result.word in after.text
    assert f"{result.parameters['4.length']:.6g} m" in after.text
    [picture] = pictures(after)
    assert picture.tag.endswith("svg")
    for finding in answer.findings:
        assert finding.name in after.text
        assert finding.name in read(answer).text
    assert repr(answer) == "<Verification: valid: found, level validated>"
    assert "verdict:     found" in str(result)


def test_an_impossible_result(made):
    result = srgc.open_result(made("beyond_reach") / "out")
    shown = read(result)
    assert result.reason in shown.text
    assert pictures(shown) == []
    why = srgc.why(result, runs=False)
    assert "an effector starts in `S`" in read(why).text
    assert str(why).splitlines()[0] in read(why).text


def test_a_refuted_claim_is_seen(result):
    altered = srgc.open_result(result("turner"))
    (altered.folder / "certificate.json").write_text("{}", encoding="utf-8")
    shown = read(altered.verify())
    assert "refuted" in shown.text
    assert "bad" in {attributes.get("class") for _, attributes in shown.tags}


def test_a_landscape(made):
    result = srgc.open_result(made("turner") / "out")
    found = result.landscape(points=2)
    [picture] = pictures(read(found))
    assert picture.tag.endswith("svg")
    assert "rho" in str(found)


def test_a_report_is_in_a_frame_of_its_own(made, tmp_path):
    page = srgc.open_result(made("turner") / "out").report(verify=False)
    [(_, frame)] = [item for item in read(page).tags if item[0] == "iframe"]
    assert frame["srcdoc"] == page.html
    assert frame["sandbox"] == "allow-scripts"
    assert page.html.lstrip().lower().startswith("<!doctype html>")
    assert page.save(tmp_path / "report.html").read_text(encoding="utf-8") == page.html
