"""XML text read back by another parser; robots of a thousand joints are written without trouble."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from fractions import Fraction

from compiler.robots.robot import WORLD
from srgc.exports.mjcf import mjcf_text, substeps
from srgc.exports.urdf import urdf_text
from srgc.exports.xml_lines import XmlLines
from tests.oracles.exported_robots import exported
from tests.oracles.robots import Builder, rod_chain


def test_what_is_written_is_read_back() -> None:
    xml = XmlLines()
    xml.comment("a -- b --> --- \n \x01 &")
    xml.open("robot", name='a < "b" & c')
    xml.element("limit", lower=0.1, upper=(1, -2.5e-300, 1 / 3), class_="x")
    xml.text("type", "<&>")
    xml.close()
    root = ET.fromstring(xml.document())
    assert root.attrib == {"name": 'a < "b" & c'}
    limit, kind = root
    assert float(limit.attrib["lower"]) == 0.1
    assert [float(x) for x in limit.attrib["upper"].split()] == [1, -2.5e-300, 1 / 3]
    assert limit.attrib["class"] == "x"
    assert kind.text == "<&>"


def test_a_thousand_joints() -> None:
    robot = exported(rod_chain(1000), (Fraction(1),) * 1000)
    text = urdf_text(robot)
    assert len(ET.fromstring(text).findall("joint")) == 1001
    text = mjcf_text(robot)
    assert text.count("<body ") == text.count("</body>") == 1001
    builder, frame = Builder(3), WORLD
    for _ in range(500):
        frame = builder.joint(builder.joint(frame, "x"), "y")
    builder.solid(frame, 1, (0, 0, 0), (1, 1, 1, 0, 0, 0))
    bare = mjcf_text(exported(builder.build()))
    assert bare.count("<body ") == 2
    assert bare.count("<joint ") == 1000


def test_a_step_of_the_task_is_whole_steps_of_the_simulation() -> None:
    for step in (Fraction(1, 8), Fraction(10, 81), Fraction(1, 3000), Fraction(1, 1000)):
        assert step / substeps(step) <= Fraction(1, 1000)
        assert substeps(step) == 1 or step / (substeps(step) - 1) > Fraction(1, 1000)
