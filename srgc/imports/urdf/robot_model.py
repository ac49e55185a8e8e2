"""Read a URDF into links and joints with yourdfpy, after checking its elements.

Source: wiki.ros.org/urdf/XML.  yourdfpy replaces missing values by defaults and does not keep
positions, so numbers and names are checked first, in the elements from lxml.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from grammar_lang.diagnostics.wording import nearest
from grammar_lang.files.file_tree import visible
from srgc.imports.module_set import Move, Steps, Turn, Vector, turns_of
from srgc.imports.source_fault import SourceFault, file_fault
from srgc.imports.source_warning import SourceWarning
from srgc.imports.urdf.known_parts import BESIDE, unknown_parts
from srgc.imports.urdf.transmissions import Gears
from srgc.imports.urdf.written_numbers import check_numbers
from srgc.imports.xml_source import Element, XmlFile, xml_file

if TYPE_CHECKING:
    from yourdfpy.urdf import Joint, Link

TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
Elements: TypeAlias = "Mapping[tuple[str, str], Element]"


@dataclass(frozen=True, slots=True)
class UrdfRobot:
    """A robot.

    Attributes:
        file: the document.
        name: its name in the file.
        links: the links by name.
        joints: the joints by name, in the order of the file.
        below: maps each link to the joints that it carries, in the order of the file.
        root: the link that no joint carries.
        elements: maps ``("link", name)`` and ``("joint", name)`` to their elements.
        gears: maps joints to the reduction of their transmission, if it is not 1.
        warnings: what is not carried over from the file.
        others: the numbers of elements that do not describe the robot's body, by their names.
    """

    file: XmlFile
    name: str
    links: Mapping[str, Link]
    joints: Mapping[str, Joint]
    below: Mapping[str, tuple[str, ...]]
    root: str
    elements: Mapping[tuple[str, str], Element]
    gears: Mapping[str, float]
    warnings: tuple[SourceWarning, ...] = ()
    others: Mapping[str, int] = field(default_factory=dict)

    def fault(self, kind: str, name: str, message: str, hint: str | None = None) -> SourceFault:
        """A fault at a link or joint."""
        return self.file.fault(self.elements[kind, name], message, hint)

    def steps(self, element: Element) -> Steps:
        """The ``origin`` of a joint, inertial, visual or collision: a translation and rotations."""
        origin = element.find("origin")
        if origin is None:
            return ()
        xyz = _vector(origin, "xyz")
        if (quaternion := origin.get("quat_xyzw")) is not None:
            return (Move(xyz), *turns_of(_rotation(quaternion)))
        roll, pitch, yaw = _vector(origin, "rpy")
        return (Move(xyz), Turn("z", yaw), Turn("y", pitch), Turn("x", roll))


def robot_model(data: bytes, path: Path, *, expanded: bool = False) -> UrdfRobot:
    """Read the robot of a URDF.

    Args:
        data: its text.
        path: the file.
        expanded: whether the text was expanded from a xacro file, and so differs from the file.

    Raises:
        SourceFault: the text is not a valid robot.
    """
    file = xml_file(data, f"{path} (expanded)" if expanded else path)
    root = file.root
    _without_namespace(root)
    if root.tag != "robot":
        hint = "srgc reads URDF, whose root is <robot>"
        raise file.fault(file.root, f"the root is <{visible(str(root.tag))}>", hint)
    for loop in root.iter("loop_joint"):
        raise file.fault(loop, "a <loop_joint> closes a chain", "srgc has trees of links")
    warnings = unknown_parts(file)
    elements = _named(file)
    check_numbers(file)
    below, top = _tree(file, elements)
    gears = Gears(file, {name: each for (kind, name), each in elements.items() if kind == "joint"})
    gears.read()
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
        gears.ratios,
        (*warnings, *gears.warnings),
        {tag: count for tag in BESIDE if (count := len(root.findall(tag)))},
    )


def _rotation(quaternion: str) -> NDArray[np.float64]:
    """The rotation matrix (3, 3) of a quaternion `x y z w`, which is normalised."""
    four = np.array([float(part) for part in quaternion.split()])
    x, y, z, w = four / np.linalg.norm(four)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix: NDArray[np.float64] = np.eye(3) + 2 * w * cross + 2 * cross @ cross
    return matrix


def _vector(element: Element, name: str) -> Vector:
    x, y, z = (float(part) for part in element.get(name, "0 0 0").split())
    return x, y, z


def _without_namespace(root: Element) -> None:
    """Remove the default namespace from the names of elements, as parsers of ROS do."""
    from lxml import etree

    if None not in root.nsmap:
        return
    begun = f"{{{root.nsmap[None]}}}"
    for element in root.iter():
        element.tag = str(element.tag).removeprefix(begun)
    etree.cleanup_namespaces(root)


def _plain(root: Element) -> bytes:
    """The text for yourdfpy, with cylinders instead of capsules, which it does not know."""
    from lxml import etree

    known = deepcopy(root)
    for capsule in known.iter("capsule"):
        capsule.tag = "cylinder"
    text: bytes = etree.tostring(known)
    return text


def _named(file: XmlFile) -> dict[tuple[str, str], Element]:
    """Links and joints by kind and name; duplicates are rejected."""
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


# --- The tree of links ----------------------------------------------------------------------------


def _tree(file: XmlFile, elements: Elements) -> tuple[dict[str, tuple[str, ...]], str]:
    """The joints that each link carries, and the root link, which no joint carries."""
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
    """The parent and child links of a joint, whose type is checked too."""
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
