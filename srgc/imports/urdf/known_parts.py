"""The elements and attributes that URDF defines.

Anything else gets a warning, or an error if it would change the robot.  Source:
wiki.ros.org/urdf/XML; ``quat_xyzw`` and ``capsule`` are newer (github.com/ros/urdfdom).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from grammar_lang.diagnostics.wording import nearest
from grammar_lang.files.file_tree import visible
from srgc.imports.source_warning import SourceWarning
from srgc.imports.urdf.written_numbers import NUMBERS
from srgc.imports.xml_source import Element, XmlFile

BESIDE = ("gazebo", "ros2_control", "sensor")
"""Elements of a robot that do not describe its body."""
ONCE: Mapping[str, tuple[str, ...]] = {
    "link": ("inertial",),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"),
    "inertial": ("origin", "mass", "inertia"),
    "visual": ("origin", "geometry"),
    "collision": ("origin", "geometry"),
}
"""Maps each element to the children that it may have at most once."""
SEVERAL: Mapping[str, tuple[str, ...]] = {
    "robot": ("link", "joint", "transmission", "material", *BESIDE),
    "link": ("visual", "collision"),
    "joint": ("calibration", "safety_controller"),
    "visual": ("material",),
}
ATTRIBUTES: Mapping[str, tuple[str, ...]] = {
    **{tag: tuple(names) for tag, names in NUMBERS.items()},
    "robot": ("name", "version"),
    "link": ("name",),
    "joint": ("name", "type"),
    "visual": ("name",),
    "collision": ("name",),
    "parent": ("link",),
    "child": ("link",),
    "mimic": ("joint", *NUMBERS["mimic"]),
    "mesh": ("filename", "scale"),
    "calibration": ("rising", "falling", "reference_position"),
    "safety_controller": ("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"),
}
_SCHEMA = "{http://www.w3.org/2001/XMLSchema-instance}"


def unknown_parts(file: XmlFile) -> list[SourceWarning]:
    """Warn of parts that URDF does not define: the first of each kind, and the lines of the others.

    Raises:
        SourceFault: a part occurs twice or is spelt in other letters, or an ``origin`` has an
            unknown attribute: each would change the robot.
    """
    kinds = dict[tuple[str, str], list[Element]]()
    for element in _read(file.root):
        _refuse_second(file, element)
        for name in _unknown_attributes(file, element):
            kinds.setdefault((str(element.tag), name), []).append(element)
        for child in _unknown_children(file, element):
            kinds.setdefault((str(element.tag), ""), []).append(child)
    return [each for kind in kinds.items() for each in _told(file, *kind)]


def _read(root: Element) -> Iterator[Element]:
    """The elements whose parts are checked: links and joints with their parts, except materials."""
    yield root
    due = [each for each in reversed(root) if each.tag in ("link", "joint")]
    while due:
        element = due.pop()
        yield element
        known = _children(str(element.tag))
        due += [each for each in reversed(element) if each.tag in known or not known]


def _children(tag: str) -> tuple[str, ...]:
    """The children that an element of this name may have."""
    return (*ONCE.get(tag, ()), *SEVERAL.get(tag, ()))


def _refuse_second(file: XmlFile, element: Element) -> None:
    for tag in ONCE.get(str(element.tag), ()):
        found = element.findall(tag)
        if len(found) > 1:
            raise file.fault(found[1], f"a second <{tag}> in one <{element.tag}>", "remove one")


def _unknown_children(file: XmlFile, element: Element) -> Iterator[Element]:
    known = _children(str(element.tag))
    if not known:
        return
    for child in element:
        tag = _called(child)
        if tag in known:
            continue
        if child.prefix == "xacro":
            hint = "xacro is expanded of files whose names end in .xacro"
            raise file.fault(child, f"<{tag}> is no URDF", hint)
        if tag.lower() in known:
            raise file.fault(child, f"<{visible(tag)}> is not <{tag.lower()}>", _meant(tag.lower()))
        yield child


def _unknown_attributes(file: XmlFile, element: Element) -> Iterator[str]:
    known = ATTRIBUTES.get(str(element.tag))
    if known is None:
        return
    for name in map(str, element.keys()):
        if name in known or name.startswith(_SCHEMA):
            continue
        shown = visible(name.rpartition("}")[2])
        if name.lower() in known:
            message = f"`{shown}` of <{element.tag}> is not `{name.lower()}`"
            raise file.fault(element, message, _meant(name.lower()), attribute=name)
        if element.tag == "origin":
            message = f"`{shown}` of <origin> is not read, and the frame would be another one"
            hint = "frames are said by `xyz` and `rpy`, or `xyz` and `quat_xyzw`"
            raise file.fault(element, message, hint, attribute=name)
        yield name


def _told(file: XmlFile, kind: tuple[str, str], elements: list[Element]) -> Iterator[SourceWarning]:
    """Warnings for one kind: an attribute by its name, or children of an element by their names."""
    holder, attribute = kind
    if attribute:
        shown = visible(attribute.rpartition("}")[2])
        hint = _near(shown, ATTRIBUTES[holder])
        said = f"`{shown}` of <{holder}> is left out{_also(file, elements[1:])}"
        yield file.warning(elements[0], said, hint, attribute=shown)
        return
    for tag in dict.fromkeys(map(_called, elements)):
        alike = [each for each in elements if _called(each) == tag]
        said = f"<{visible(tag)}> in <{holder}> is left out{_also(file, alike[1:])}"
        yield file.warning(alike[0], said, _near(tag, _children(holder)))


def _also(file: XmlFile, others: list[Element]) -> str:
    lines = list(dict.fromkeys(file.lines(others)))
    if not lines:
        return ""
    return f", also in line{'s' if len(lines) > 1 else ''} {', '.join(map(str, lines))}"


def _called(element: Element) -> str:
    """The name of an element as it is written."""
    tag = str(element.tag).rpartition("}")[2]
    return f"{element.prefix}:{tag}" if element.prefix else tag


def _near(name: str, known: tuple[str, ...]) -> str | None:
    near = nearest(name, list(known))
    return None if near is None else _meant(near)


def _meant(name: str) -> str:
    return f"did you mean `{name}`?"
