"""A robot: a drawing, its coordinates and its parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from compiler.descriptions.document import Entry
from compiler.descriptions.robot_sections import robot_sections
from srgc.chosen_robot import ChosenRobot
from srgc.displays.figure import image
from srgc.render.html_block import block, code, lines, table
from srgc.render.html_text import number, text
from srgc.render.robot_drawing import pose_picture


def robot_html(chosen: ChosenRobot, theta: Sequence[Fraction]) -> str:
    """A display of a robot."""
    word = " ".join(chosen.word)
    picture = image(pose_picture(chosen.model, theta), f"the robot {word}")
    rows = table(("", "", "", "value"), _rows(chosen, theta), (3,))
    title = f'<div class="strong">{code(word)}</div>'
    return block(
        title, f'<div class="side">{picture}<div>{rows}</div></div>', lines(*chosen.remarks)
    )


def _rows(chosen: ChosenRobot, theta: Sequence[Fraction]) -> Iterator[list[str]]:
    """Coordinates, parameters with their values, inputs."""
    for section in robot_sections(chosen.model, chosen.word, chosen.task):
        if section.title not in ("Coordinates", "Parameters", "Inputs"):
            continue
        values = iter(theta if section.title == "Parameters" else ())
        for item in section.items:
            if isinstance(item, Entry):
                value = next(values, None)
                shown = "" if value is None else number(float(value), 6)
                yield [code(item.symbol[0]), text(item.meaning), text(item.bounds), shown]
