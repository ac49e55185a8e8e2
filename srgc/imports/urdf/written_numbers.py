"""Check the numbers of a URDF: the right count in each attribute, finite and not too large."""

from __future__ import annotations

import math

from grammar_lang.files.file_tree import visible
from srgc.imports.source_fault import SourceFault
from srgc.imports.xml_source import Element, XmlFile

NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3, "quat_xyzw": 4},
    "axis": {"xyz": 3},
    "mass": {"value": 1},
    "inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), 1),
    "limit": dict.fromkeys(("lower", "upper", "effort", "velocity"), 1),
    "dynamics": {"damping": 1, "friction": 1},
    "mimic": {"multiplier": 1, "offset": 1},
    "sphere": {"radius": 1},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
    "box": {"size": 3},
}
"""Maps each element and attribute to the count of its numbers."""
NEEDED = {
    "mass": ("value",),
    "inertia": ("ixx", "iyy", "izz"),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "box": ("size",),
    "mesh": ("filename",),
    "mimic": ("joint",),
}
GEOMETRIES = ("box", "cylinder", "capsule", "sphere", "mesh")
LARGEST = 1e9
UNIT = 1e-3
"""How far the length of a quaternion may differ from 1, since files round."""
UNLIMITED = LARGEST
"""Limits from here on mean no limit: exporters write such numbers where URDF requires one."""


def check_numbers(file: XmlFile) -> None:
    """Check all numbers of links and joints.

    Raises:
        SourceFault: one of them is invalid, or a required attribute or geometry is missing.
    """
    parts = (each for top in file.root if top.tag in ("link", "joint") for each in top.iter())
    for element in parts:
        tag = str(element.tag)
        for name in NEEDED.get(tag, ()):
            if element.get(name) is None:
                raise file.fault(element, f"<{tag}> lacks `{name}`")
        for name, count in NUMBERS.get(tag, {}).items():
            if (text := element.get(name)) is not None:
                check_text(file, element, name, text, count)
        if tag == "origin" and "quat_xyzw" in element.attrib:
            _check_quaternion(file, element)
        if tag == "geometry":
            _check_geometry(file, element)
        if tag in ("visual", "collision") and element.find("geometry") is None:
            raise file.fault(element, f"<{tag}> lacks a <geometry>")


def check_text(file: XmlFile, element: Element, name: str, text: str, count: int) -> None:
    """Reject a text other than ``count`` finite numbers that are not too large.

    Args:
        file: the document, for messages.
        element: the element with the text.
        name: the attribute, or the name of the element whose text it is.
        text: the text to check.
        count: how many numbers it has to hold.

    Raises:
        SourceFault: the text is anything else.
    """

    def fault(said: str) -> SourceFault:
        shown = f"`{name}` is `{visible(text[:60])}`, {said}"
        return file.fault(element, shown, attribute=name)

    if "_" in text or not text.isascii():  # Python accepts these in numbers
        raise fault("no number")
    try:
        values = [float(part) for part in text.split()]
    except ValueError:
        raise fault("no number") from None
    if len(values) != count:
        due = "a number is" if count == 1 else f"{count} numbers are"
        raise fault(f"where {due} due")
    if not all(math.isfinite(value) for value in values):
        if element.tag != "limit" or any(math.isnan(value) for value in values):
            raise fault("which is not finite")
        # Some files have infinity for no limit.
        element.set(name, repr(math.copysign(UNLIMITED, values[0])))
        return
    if element.tag != "limit" and max(map(abs, values)) > LARGEST:
        raise fault(f"larger than {LARGEST:g}")
    if name in ("radius", "length", "size") and min(values) <= 0:
        raise fault("and has to be above 0")


def _check_quaternion(file: XmlFile, element: Element) -> None:
    """Reject an origin with two rotations, or with a quaternion that is not of unit length."""
    if "rpy" in element.attrib:
        raise file.fault(element, "<origin> has both `rpy` and `quat_xyzw`", "remove one")
    length = math.hypot(*map(float, str(element.get("quat_xyzw")).split()))
    if abs(length - 1) > UNIT:
        message = f"`quat_xyzw` has the length {length:g}, and a rotation has 1"
        raise file.fault(element, message, attribute="quat_xyzw")


def _check_geometry(file: XmlFile, element: Element) -> None:
    kinds = [str(child.tag) for child in element]
    if len(kinds) != 1:
        raise file.fault(element, f"a <geometry> of {len(kinds)} shapes, where one is expected")
    if kinds[0] not in GEOMETRIES:
        hint = f"known: {', '.join(GEOMETRIES)}"
        raise file.fault(element, f"a <geometry> of <{visible(kinds[0])}>", hint)
    scale = element[0].get("scale")
    if kinds[0] == "mesh" and scale is not None:
        parts = scale.replace(",", " ").split()
        check_text(file, element[0], "scale", " ".join(parts), 1 if len(parts) == 1 else 3)
        if 0 in map(float, parts):
            message = f"`scale` is `{visible(scale[:60])}`, which leaves a mesh flat"
            raise file.fault(element[0], message, attribute="scale")
