"""The robot module by module: where modules are, and what is said of them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from compiler.robots.normal_form import family_of
from compiler.words.derivation import Derivation
from compiler.words.structures import derivations_of
from grammar_lang.ir import Program, Task
from grammar_lang.load import load
from srgc.render.module_drawing import DrawnModule, ModuleDrawing, module_drawing
from srgc.render.module_marks import marked_robot
from srgc.render.module_picture import robot_picture
from srgc.report.animation import motion_section
from srgc.report.evidence import Evidence
from srgc.report.robot_and_word import derivation_section, derivation_tree, robot_section
from tests.oracles.drawn_texts import drawn_texts, outside, overlaps
from tests.oracles.small_specs import SLIDER, replaced

On = Callable[[str], Evidence]
SPECS = Path(__file__).parents[3] / "specs"
BOLD_LETTER = 8.6
"""Width of a letter of names on the picture, all in all, in a wide font (DejaVu Sans Bold)."""


def structure(spec: str, word: str) -> tuple[Program, Task, Derivation]:
    program = load(SPECS / f"{spec}.srg").program
    assert program is not None
    task = next(iter(program.tasks.values()))
    language = family_of(program, task).language
    return program, task, next(iter(derivations_of(language, tuple(word.split()))))


def drawn(spec: str, word: str, values: list[str]) -> ModuleDrawing:
    program, task, derivation = structure(spec, word)
    grammar = program.grammars[task.grammar]
    dimension = program.workspaces[task.workspace].dimension
    robot = marked_robot(grammar, program.modules, derivation, dimension)
    return module_drawing(
        robot,
        derivation.word,
        dict(program.modules),
        np.array([float(Fraction(value)) for value in values]),
    )


def by_place(drawing: ModuleDrawing) -> dict[int, DrawnModule]:
    return {module.place: module for module in drawing.modules}


def lengths(lines: list[np.ndarray]) -> list[float]:  # type: ignore[type-arg]
    return [float(np.linalg.norm(line[1] - line[0])) for line in lines]


def test_every_link_of_an_arm_is_its_own_length() -> None:
    modules = by_place(drawn("planar_arm", "B eps JO eps L eps JO eps L eps EN", ["2", "1.5"]))
    assert {*modules} == {0, 2, 4, 6, 8, 10}
    assert lengths(modules[4].lines) == pytest.approx([2])
    assert lengths(modules[8].lines) == pytest.approx([1.5])
    assert lengths(modules[8].bodies) == pytest.approx([1.5])
    assert modules[0].at == pytest.approx([0, 0])
    assert modules[2].at == pytest.approx([0, 0])
    assert modules[6].at == pytest.approx(modules[4].lines[0][1])
    assert modules[10].at == pytest.approx(modules[8].lines[0][1])
    assert modules[2].joint == modules[6].joint == "revolute"


def test_pose_bends_the_arm() -> None:
    modules = by_place(drawn("planar_arm", "B eps JO eps L eps JO eps L eps EN", ["2", "1.5"]))
    tip, elbow = modules[10].at, modules[6].at
    assert tip is not None
    assert elbow is not None
    assert abs(float(np.linalg.det(np.stack([tip, elbow])))) > 0.5


def test_branches_start_at_the_ends_of_the_beam() -> None:
    word = "B eps W eps T [ JO eps L eps EN ] [ JO eps L eps JO eps L eps EN ]"
    modules = by_place(drawn("two_arm", word, ["0.3", "0.4", "0.5"]))
    left, right = modules[6].at, modules[13].at
    assert left is not None
    assert right is not None
    assert float(np.linalg.norm(left - right)) == pytest.approx(1)
    assert left + right == pytest.approx([0, 0], abs=1e-9)
    assert lengths(modules[4].bodies) == pytest.approx([1])
    for place, length in ((8, 0.3), (15, 0.4), (19, 0.5)):
        assert [*lengths(modules[place].bodies), *lengths(modules[place].lines)][0] == (
            pytest.approx(length)
        )
    assert modules[10].at == pytest.approx(modules[8].bodies[0][1])
    assert modules[21].at == pytest.approx(modules[19].bodies[0][1])


def test_l_shaped_link_has_two_legs_at_a_right_angle() -> None:
    modules = by_place(drawn("l_shaped", "B eps JO eps LL eps EN", ["0.4"]))
    legs = modules[4].lines
    assert lengths(legs) == pytest.approx([0.4, 0.4])
    first, second = (leg[1] - leg[0] for leg in legs)
    assert float(first @ second) == pytest.approx(0, abs=1e-12)
    assert lengths(modules[0].lines) == pytest.approx([0.3])
    assert modules[2].axis == pytest.approx([0, 0, 1])


def test_slide_is_drawn_out_along_its_axis() -> None:
    modules = by_place(drawn("prismatic", "B eps R eps P eps EN", []))
    slide = modules[4]
    assert slide.joint == "prismatic"
    (line,) = slide.lines
    assert slide.axis is not None
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    assert along == pytest.approx(slide.axis)
    assert 0.2 <= lengths([line])[0] <= 0.6 + 1e-9


def test_shipped_robots_are_drawn_whole(evidence_on: On) -> None:
    for spec in ("planar_arm", "spatial", "turner", "slider", "motor"):
        evidence = evidence_on(spec)
        sections = robot_section(evidence) + derivation_section(evidence)
        page = ElementTree.fromstring(f"<main>{sections}</main>")
        found = evidence.found
        assert found is not None
        modules = [
            i for i, name in enumerate(found.derivation.word) if name in found.program.modules
        ]
        for kind, count in (("module", 1), ("name", 1), ("chip", 1), ("leaf", 1)):
            marks = [
                each.get("data-symbol")
                for each in page.iter()
                if kind in (each.get("class") or "").split()
            ]
            for place in modules:
                assert marks.count(str(place)) == count, (spec, kind, place)


def test_picture_is_inside_its_frame() -> None:
    word = "B eps JO eps JO eps JO eps L eps JO eps L eps JO eps EN"
    drawing = drawn("planar_arm", word, ["1", "2"])
    svg = ElementTree.fromstring(robot_picture(drawing, {6: ["1 m"], 10: ["2 m"]}))
    _, _, width, height = map(float, (svg.get("viewBox") or "").split())
    spots = [(float(t.get("x") or 0), float(t.get("y") or 1)) for t in svg.iter("tspan")]
    assert len(spots) >= 8
    for x, y in spots:
        assert 0 < x < width
        assert 0 < y < height


@pytest.mark.parametrize(
    ("size", "width"), [(13.0, None), (21.0, None), (13.0, 340.0)]
)  # letters on a screen, on a phone, and in the line of robots of a mission
def test_names_of_one_spot_do_not_lie_on_each_other(size: float, width: float | None) -> None:
    word = "B eps JO eps JO eps JO eps JO eps L eps L eps EN"
    drawing = drawn("planar_arm", word, ["1", "2"])
    values = {10: ["length = 1 m"], 12: ["length = 2 m"]}
    svg = robot_picture(drawing, values, width=width)
    svg = svg.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1)
    texts = drawn_texts(svg, size)
    assert len(texts) == 10
    assert overlaps(texts) == []
    assert outside(texts, svg) == []


def test_tree_has_every_production_and_the_word_in_order() -> None:
    _, _, derivation = structure(
        "two_arm", "B eps W eps T [ JO eps L eps EN ] [ JO eps L eps JO eps L eps EN ]"
    )
    svg = ElementTree.fromstring(derivation_tree(derivation, {}))
    groups = {kind: [g for g in svg.iter("g") if kind in (g.get("class") or "").split()]
              for kind in ("leaf", "replaced")}  # fmt: skip
    leaves = [(float(g[0].get("x") or 0), g[0].text) for g in groups["leaf"]]
    assert [name for _, name in sorted(leaves)] == list(derivation.word)
    assert [g[1].text for g in groups["replaced"]] == ["beam", "hand", "longer", "hand"]
    arrows = list(svg.iter("path"))
    assert len(arrows) == len(derivation.word) + len(derivation.nodes) - 1


def test_tools_are_joined_to_what_carries_them(tmp_path: Path) -> None:
    """An effector away from the last frame, by the lines of the picture and no body between."""
    old = "effector(frame: N.frame);"
    new = "effector(frame: N.frame * move(y, 30 cm));"
    path = tmp_path / "spec.srg"
    path.write_text(replaced(SLIDER, old, new), encoding="utf-8")
    program = load(path).program
    assert program is not None
    (task,) = program.tasks.values()
    language = family_of(program, task).language
    word = ("B", "eps", "P", "eps", "M", "eps", "EN")
    derivation = next(iter(derivations_of(language, word)))
    robot = marked_robot(program.grammars[task.grammar], program.modules, derivation, 2)
    modules = by_place(module_drawing(robot, derivation.word, dict(program.modules), np.zeros(0)))
    (line,) = modules[6].lines
    assert modules[6].at == pytest.approx(line[1])
    assert line[1] - line[0] == pytest.approx([0, 0.3])


def test_long_names_fit_into_the_pictures() -> None:
    """All of a tree is within its picture, and no name lies over the next one."""
    _, _, derivation = structure("planar_arm", "B eps JO eps L eps EN")
    name = "Base_with_a_name_that_is_far_too_long_for_any_picture"
    word = (name, *derivation.word[1:])
    svg = ElementTree.fromstring(derivation_tree(replace(derivation, word=word), {}))
    width = float(svg.get("width") or 0)
    places = []
    for mark in svg.iter("g"):
        if (mark.get("class") or "").startswith("leaf"):
            text = next(mark.iter("text"))
            half = BOLD_LETTER * len(text.text or "") / 2
            places.append((float(text.get("x") or 0) - half, float(text.get("x") or 0) + half))
    assert places[0][0] >= 0
    assert places[-1][1] <= width
    assert all(end <= begin for (_, end), (begin, _) in pairwise(places))
    assert name in [title.text for title in svg.iter("title")]


def test_names_cannot_break_the_page(evidence_on: On) -> None:
    evidence = evidence_on("turner")
    for section in (
        robot_section(evidence), motion_section(evidence), derivation_section(evidence)
    ):  # fmt: skip
        ElementTree.fromstring(section)
        assert not re.search(r"https?:", section)


@pytest.mark.parametrize("spec", ["beyond_reach", "too_short"])
def test_no_robot_is_invented(evidence_on: On, spec: str) -> None:
    evidence = evidence_on(spec)
    motion = motion_section(evidence)
    assert robot_section(evidence) == derivation_section(evidence) == ""
    assert 'class="robot"' not in motion
    for region in evidence.workspace.regions:
        assert f">{region.name}</text>" in motion


def test_unknown_claims_nothing(evidence_on: On) -> None:
    evidence = evidence_on("beyond_reach")
    unknown = replace(evidence, design={**evidence.design, "verdict": "unknown"})
    assert robot_section(unknown) == ""
    section = motion_section(unknown)
    assert "proved" not in section
    assert "There is no robot" in section


def test_sections_are_the_same_again(evidence_on: On) -> None:
    evidence = evidence_on("spatial")
    assert robot_section(evidence) == robot_section(evidence)
    assert motion_section(evidence) == motion_section(evidence)
    assert len(robot_section(evidence)) + len(motion_section(evidence)) < 400_000
