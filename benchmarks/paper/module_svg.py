"""A robot module by module, as a file: the picture of reports with a look of its own."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

import srgc
from compiler.words.language import language
from compiler.words.structures import derivations_of
from srgc.render.module_drawing import module_drawing
from srgc.render.module_marks import marked_robot
from srgc.render.module_picture import robot_picture
from srgc.render.svg import document

WIDTH = 380.0
_SVG = re.compile(r'<svg [^>]*viewBox="0 0 (\S+) (\S+)"[^>]*>(.*)</svg>', re.DOTALL)
_ROLES = {"base": "#5b6472", "joint": "#2166ac", "link": "#2e7d32", "effector": "#b3372f"}
STYLE = (
    "".join(f".{role}{{color:{colour}}}" for role, colour in _ROLES.items())
    + "g text{fill:currentColor;font:600 13px sans-serif;text-anchor:middle;paint-order:stroke;"
    "stroke:#fff;stroke-width:3px}.length,.rod,.turn,.slide,.arrow,.axis,.ground,.tool,.other{"
    "fill:none;stroke:currentColor;stroke-width:2.4;stroke-linecap:round}.length{stroke-width:9;"
    "opacity:.75}.joint .length{stroke-width:3}.rod{stroke-width:5;opacity:.6}.turn,.slide{"
    "fill:#fff}.axis{stroke-width:1.6;stroke-dasharray:7 3 2 3}.mass,.still,.pin{"
    "fill:currentColor}.leader{fill:none;stroke:#566074;stroke-width:.8}"
)


def module_svg(spec: Path, word: str) -> str:
    """The picture of the robot of a word; parameters have the middle of their ranges."""
    robot = srgc.robot(spec, word)
    program, grammar, model = robot.chosen.program, robot.chosen.grammar, robot.chosen.model
    family = language(grammar, program.terminals, program.modules)
    derivation = next(iter(derivations_of(family, word.split())))
    marked = marked_robot(grammar, program.modules, derivation, model.dimension)
    theta = np.array([float(value) for value in robot.theta])
    drawing = module_drawing(marked, derivation.word, dict(program.modules), theta)
    found = _SVG.fullmatch(robot_picture(drawing, {}, width=WIDTH))
    assert found is not None
    width, height, marks = found.groups()
    size = float(width), float(height)
    return document(f"<style>{STYLE}</style>{marks}", size, "modules", word.replace("eps", "ε"))
