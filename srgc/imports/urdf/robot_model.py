"""A URDF as links and joints: read by yourdfpy, after its text was checked line by line.

Source: wiki.ros.org/urdf/XML.  yourdfpy takes what is missing for a default and forgets where
things stood; so numbers and names are looked at first, in the elements that lxml gives.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from grammar_lang.diagnostics.wording import nearest
from grammar_lang.files.file_tree import visible
from srgc.imports.module_set import Move, Steps, Turn, Vector
from srgc.imports.source_fault import SourceFault, file_fault
from srgc.imports.xml_source import Element, XmlFile, xml_file

if TYPE_CHECKING:
    from yourdfpy.urdf import Joint, Link

TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3},
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
"""By element and attribute how many numbers it holds."""
NEEDED = {
    "mass": ("value",),
    "inertia": ("ixx", "iyy", "izz"),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "box": ("size",),
    "mesh": ("filename",),
    "mimic": ("joint",),
}
Elements: TypeAlias = "Mapping[tuple[str, str], Element]"
LARGEST = 1e9
UNLIMITED = LARGEST
"""From here on a limit is none: exporters write such numbers where URDF demands one."""


@dataclass(frozen=True, slots=True)
class UrdfRobot:
    """A robot.

    Attributes:
        file: its text.
        name: as the file has it.
        links: by name.
        joints: by name, in the order of the file.
        below: by link the joints that it carries, in the order of the file.
        root: the link that no joint carries.
        elements: by ``("link", name)`` and ``("joint", name)`` where they stand.
        gears: by joint the reduction of its transmission.
        geared_otherwise: transmissions of no or several joints, or without a reduction, by name.
        others: how many elements there are that say nothing of a robot's body, by their names.
    """

    file: XmlFile
    name: str
    links: Mapping[str, Link]
    joints: Mapping[str, Joint]
    below: Mapping[str, tuple[str, ...]]
    root: str
    elements: Mapping[tuple[str, str], Element]
    gears: Mapping[str, float]
    geared_otherwise: tuple[str, ...]
    others: Mapping[str, int] = field(default_factory=dict)

    def fault(self, kind: str, name: str, message: str, hint: str | None = None) -> SourceFault:
        """A fault of a link or joint."""
        return self.file.fault(self.elements[kind, name], message, hint)

    def steps(self, element: Element) -> Steps:
        """The ``origin`` of a joint, inertial, visual or collision, as shift and turns."""
        origin = element.find("origin")
        if origin is None:
            return ()
        xyz = _vector(origin, "xyz")
        roll, pitch, yaw = _vector(origin, "rpy")
        return (Move(xyz), Turn("z", yaw), Turn("y", pitch), Turn("x", roll))


def robot_model(data: bytes, path: Path, *, expanded: bool = False) -> UrdfRobot:
    """The robot of a URDF.

    Args:
        data: its text.
        path: the file.
        expanded: whether the text is what a xacro file became, which is another than in the file.

    Raises:
        SourceFault: it is no robot.
    """
    file = xml_file(data, f"{path} (expanded)" if expanded else path)
    root = file.root
    if root.tag != "robot":
        hint = "srgc reads URDF, whose root is <robot>"
        raise file.fault(file.root, f"the root is <{visible(str(root.tag))}>", hint)
    for loop in root.iter("loop_joint"):
        raise file.fault(loop, "a <loop_joint> closes a chain", "srgc has trees of links")
    elements = _named(file)
    _check_numbers(file)
    below, top = _tree(file, elements)
    from yourdfpy import URDF

    if "name" not in root.attrib:
        root.set("name", path.stem)
    try:
        # The meshes are read elsewhere, and only those that may be.
        model = URDF.load(
            BytesIO(_plain(root)),
            build_scene_graph=False,
            load_meshes=False,
        ).robot
    except (ValueError, KeyError, AttributeError, IndexError, TypeError) as error:
        raise file_fault(path, f"yourdfpy cannot read it: {error}") from None
    return UrdfRobot(
        file,
        model.name,
        {link.name: link for link in model.links},
        {joint.name: joint for joint in model.joints},
        below,
        top,
        elements,
        dict(_gears(file, elements)),
        tuple(_geared_otherwise(file, elements)),
        _others(root),
    )


def _plain(root: Element) -> bytes:
    from lxml import etree

    text: bytes = etree.tostring(root)
    return text


def _named(file: XmlFile) -> dict[tuple[str, str], Element]:
    """Links and joints by name; each has one of its own."""
    found = dict[tuple[str, str], Element]()
    for element in file.root:
        kind = str(element.tag)
        if kind not in ("link", "joint"):
            continue
        name = element.get("name")
        if not name:
            raise file.fault(element, f"a {kind} without a name")
        if (kind, name) in found:
            first = file.line(found[kind, name])
            raise file.fault(
                element, f"a second {kind} `{visible(name)}`, after that of line {first}"
            )
        found[kind, name] = element
    if not any(kind == "link" for kind, _ in found):
        raise file.fault(file.root, "a robot without links")
    return found


# --- Numbers --------------------------------------------------------------------------------------


def _check_numbers(file: XmlFile) -> None:
    parts = (each for top in file.root if top.tag in ("link", "joint") for each in top.iter())
    for element in parts:
        tag = str(element.tag)
        for name in NEEDED.get(tag, ()):
            if element.get(name) is None:
                raise file.fault(element, f"<{tag}> lacks `{name}`")
        for name, count in NUMBERS.get(tag, {}).items():
            if (text := element.get(name)) is not None:
                _check(file, element, name, text, count)
        if tag == "geometry":
            _check_geometry(file, element)
        if tag in ("visual", "collision") and element.find("geometry") is None:
            raise file.fault(element, f"<{tag}> lacks a <geometry>")


def _check(file: XmlFile, element: Element, name: str, text: str, count: int) -> None:
    """Refuse what is not so many finite numbers of a usual size."""

    def fault(said: str) -> SourceFault:
        shown = f"`{name}` is `{visible(text[:60])}`, {said}"
        return file.fault(element, shown, attribute=name)

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
        # Some write infinity for no limit.
        element.set(name, repr(math.copysign(UNLIMITED, values[0])))
        return
    if element.tag != "limit" and max(map(abs, values)) > LARGEST:
        raise fault(f"larger than {LARGEST:g}")
    if name in ("radius", "length", "size") and min(values) <= 0:
        raise fault("and has to be above 0")


def _check_geometry(file: XmlFile, element: Element) -> None:
    kinds = [str(child.tag) for child in element]
    if len(kinds) != 1:
        raise file.fault(element, f"a <geometry> of {len(kinds)} shapes, where one is due")
    if kinds[0] not in ("box", "cylinder", "sphere", "mesh"):
        hint = "known: box, cylinder, sphere, mesh"
        raise file.fault(element, f"a <geometry> of <{visible(kinds[0])}>", hint)
    scale = element[0].get("scale")
    if kinds[0] == "mesh" and scale is not None:
        parts = scale.replace(",", " ").split()
        _check(file, element[0], "scale", " ".join(parts), 1 if len(parts) == 1 else 3)


def _vector(element: Element, name: str) -> Vector:
    x, y, z = (float(part) for part in element.get(name, "0 0 0").split())
    return x, y, z


# --- The tree of links ----------------------------------------------------------------------------


def _tree(file: XmlFile, elements: Elements) -> tuple[dict[str, tuple[str, ...]], str]:
    """The joints that each link carries, and the link that none carries."""
    links = [name for kind, name in elements if kind == "link"]
    below: dict[str, tuple[str, ...]] = dict.fromkeys(links, ())
    carrier = dict[str, str]()
    for (kind, name), element in elements.items():
        if kind == "joint":
            parent, child = _ends(file, name, element, links)
            if child in carrier:
                raise file.fault(
                    element,
                    f"joint `{visible(name)}` carries link `{visible(child)}`, which joint "
                    f"`{visible(carrier[child])}` carries already: the links form a loop",
                    "srgc has trees of links; cut the loop",
                )
            carrier[child] = name
            below[parent] += (name,)
    tops = [link for link in links if link not in carrier]
    if len(tops) != 1:
        said = ", ".join(f"`{visible(link)}`" for link in tops[:4]) or "none"
        raise file.fault(file.root, f"one link is to be carried by no joint, and here {said}")
    reached = _reached(tops[0], below, elements)
    for link in links:
        if link not in reached:
            element = elements["link", link]
            raise file.fault(element, f"link `{visible(link)}` is in a loop of joints")
    return below, tops[0]


def _ends(file: XmlFile, name: str, element: Element, links: list[str]) -> tuple[str, str]:
    """The links of a joint, its type looked at as well."""
    kind = element.get("type")
    if kind not in TYPES:
        said = "no type" if kind is None else f"the type `{visible(kind)}`"
        raise file.fault(
            element, f"joint `{visible(name)}` has {said}", f"known: {', '.join(TYPES)}"
        )
    ends = []
    for tag in ("parent", "child"):
        end = element.find(tag)
        link = None if end is None else end.get("link")
        if link is None:
            raise file.fault(element, f"joint `{visible(name)}` lacks <{tag} link=...>")
        if link not in links:
            near = nearest(link, links)
            hint = None if near is None else f"did you mean `{near}`?"
            raise file.fault(element, f"there is no link `{visible(link)}`", hint)
        ends.append(link)
    return ends[0], ends[1]


def _reached(
    top: str,
    below: Mapping[str, tuple[str, ...]],
    elements: Mapping[tuple[str, str], Element],
) -> set[str]:
    found, due = {top}, [top]
    while due:
        for joint in below[due.pop()]:
            child = elements["joint", joint].find("child")
            link = "" if child is None else str(child.get("link"))
            if link not in found:
                found.add(link)
                due.append(link)
    return found


# --- What stands beside links and joints ----------------------------------------------------------


def _gears(file: XmlFile, elements: Elements) -> Iterator[tuple[str, float]]:
    """The reductions of transmissions with one joint; 1 says nothing."""
    for transmission in file.root.iter("transmission"):
        for reduction in transmission.iter("mechanicalReduction"):
            text = reduction.text or ""
            _check(file, reduction, "mechanicalReduction", text, 1)
            value = abs(float(text))
            joint = _one_joint(transmission, elements)
            if joint is not None and value not in (0.0, 1.0):
                yield joint, value


def _geared_otherwise(file: XmlFile, elements: Elements) -> Iterator[str]:
    """Transmissions that say nothing of the gear of one joint."""
    for transmission in file.root.iter("transmission"):
        reductions = [float(each.text or 0) for each in transmission.iter("mechanicalReduction")]
        if _one_joint(transmission, elements) is None or 0.0 in reductions:
            yield transmission.get("name") or "transmission"


def _one_joint(transmission: Element, elements: Elements) -> str | None:
    """The joint that a transmission is about, if that is one of the robot alone."""
    named = [str(joint.get("name")) for joint in transmission.findall("joint")]
    return named[0] if len(named) == 1 and ("joint", named[0]) in elements else None


def _others(root: Element) -> dict[str, int]:
    known = ("link", "joint", "transmission", "material")
    counts = Counter(str(element.tag).rpartition("}")[2] for element in root)
    return {tag: count for tag, count in sorted(counts.items()) if tag not in known}
