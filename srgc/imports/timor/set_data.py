"""Read the file of a module set: bodies, joints and connectors, by CoBRA's ModuleSchema."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from srgc.imports.json_place import Place
from srgc.imports.quantities import decimal_text
from srgc.imports.timor.geometry_data import IDENTITY, Geometry, read_geometries

Pose: TypeAlias = NDArray[np.float64]
ConnectorGender: TypeAlias = Literal["f", "m", "h"]
JointKind: TypeAlias = Literal["revolute", "prismatic", "fixed"]

GENDERS: dict[str, ConnectorGender] = {
    "f": "f",
    "female": "f",
    "m": "m",
    "male": "m",
    "h": "h",
    "hermaphroditic": "h",
}
JOINTS: dict[str, tuple[JointKind, bool]] = {
    "revolute": ("revolute", False),
    "revolute_active": ("revolute", False),
    "revolute_passive": ("revolute", True),
    "continuous": ("revolute", False),
    "prismatic": ("prismatic", False),
    "prismatic_active": ("prismatic", False),
    "prismatic_passive": ("prismatic", True),
    "fixed": ("fixed", False),
}
"""Maps the name of a joint's type to its kind, and to whether it is passive."""
JOINT_KEYS = (
    *("ID", "type", "passive", "parent", "child", "poseParent", "poseChild", "limits"),
    *("gearRatio", "motorInertia", "frictionCoulomb", "frictionViscous"),
)
MOST_MODULES, MOST_BODIES = 2000, 500
"""The most modules of a set, and the most bodies or joints of a module."""
BASE, EFFECTOR = "base", "eef"
"""The types of connectors that stand on the world, and that are effectors."""


@dataclass(frozen=True, slots=True)
class Connector:
    """A connector, to which another module fits; its z axis points away from the module.

    Two connectors fit if their types and sizes are equal, and one is male and the other female, or
    both are hermaphroditic.
    """

    id: str
    gender: ConnectorGender
    type: str
    size: tuple[str, ...]
    pose: Pose
    body: str


@dataclass(frozen=True, slots=True)
class BodyData:
    """A rigid body: mass (kg), centre (m), and inertia about it (xx, yy, zz, xy, xz, yz)."""

    id: str
    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]
    shapes: Sequence[Geometry]
    visuals: Sequence[Geometry]
    connectors: Sequence[Connector]


@dataclass(frozen=True, slots=True)
class JointData:
    """A joint: parent * to_joint * (motion about z) * to_child = child."""

    id: str
    kind: JointKind
    passive: bool
    parent: str
    child: str
    to_joint: Pose
    to_child: Pose
    range: tuple[float, float]
    effort: float
    rate: float
    accel: float
    gear: float
    rotor: float
    coulomb: float
    viscous: float


@dataclass(frozen=True, slots=True)
class ModuleData:
    """A module of a set; ``place`` is its place in the file."""

    id: str
    name: str
    cost: float
    authors: Sequence[str]
    bodies: Sequence[BodyData]
    joints: Sequence[JointData]
    place: Place

    @property
    def connectors(self) -> list[Connector]:
        """The connectors of all bodies."""
        return [connector for body in self.bodies for connector in body.connectors]


@dataclass(frozen=True, slots=True)
class SetData:
    """A module set; ``collisions`` says which neighbours Timor excludes from collision checks."""

    modules: Sequence[ModuleData]
    collisions: str


def read_set(place: Place) -> SetData:
    """Read the modules of a file, which is a list of them or an object with ``modules``.

    Raises:
        UsageFault: the file violates the schema, an ID occurs twice, or bodies are not connected.
    """
    listed, collisions = place, "via_joint"
    if not isinstance(place.value, list):
        place.keys(("modules", "ignore_collisions", "name"))
        listed = place["modules"]
        collisions = place.get("ignore_collisions", "via_joint").text()
    modules = [_module(entry) for entry in listed.entries(MOST_MODULES)]
    if not modules:
        raise listed.fault("expected at least one module")
    for what in ("ID", "name"):
        _different(
            [module.place["header"][what] for module in modules if what in module.place["header"]]
        )
    return SetData(modules, collisions)


def _module(place: Place) -> ModuleData:
    place.keys(("header", "bodies", "joints"))
    header = place["header"]
    header.keys(("ID", "name", "date", "author", "email", "affiliation", "cost"))
    entries = place["bodies"].one_or_more(MOST_BODIES)
    _different([entry["ID"] for entry in entries])
    bodies = [_body(entry) for entry in entries]
    if not bodies:
        raise place["bodies"].fault("expected at least one body")
    connectors = [
        connector["ID"]
        for entry in entries
        if "connectors" in entry
        for connector in entry["connectors"].one_or_more()
    ]
    _different(connectors)
    joints = _joints(place, {body.id for body in bodies})
    authors = [entry.text() for entry in header.get("author", []).one_or_more()]
    found = ModuleData(
        header["ID"].text(),
        header.get("name", header["ID"].value).text(),
        header.get("cost", 0.0).number(least=0.0),
        authors,
        bodies,
        joints,
        place,
    )
    _tree(found)
    return found


def _body(place: Place) -> BodyData:
    place.keys(("ID", "mass", "inertia", "r_com", "collision", "visual", "connectors"))
    body = place["ID"].text()
    x, y, z = place.get("r_com", [0, 0, 0]).numbers(3)
    return BodyData(
        body,
        place.get("mass", 0.0).number(least=0.0),
        (x, y, z),
        _inertia(place.get("inertia", np.zeros((3, 3)).tolist())),
        read_geometries(place.get("collision", [])),
        read_geometries(place.get("visual", [])),
        [_connector(entry, body) for entry in place.get("connectors", []).one_or_more()],
    )


def _inertia(place: Place) -> tuple[float, float, float, float, float, float]:
    matrix = place.matrix(3, 3)
    largest = float(np.abs(matrix).max())
    if np.abs(matrix - matrix.T).max() > 1e-9 * largest:
        raise place.fault("expected a symmetric matrix")
    if np.linalg.eigvalsh(matrix).min() < -1e-9 * largest:
        raise place.fault("expected moments of inertia that are not negative")
    xx, yy, zz = (float(matrix[i, i]) for i in range(3))
    xy, xz, yz = (float(matrix[i, j]) for i, j in ((0, 1), (0, 2), (1, 2)))
    return xx, yy, zz, xy, xz, yz


def _connector(place: Place, body: str) -> Connector:
    place.keys(("ID", "gender", "type", "size", "pose"))
    gender = place.get("gender", "h").text()
    if gender not in GENDERS:
        raise place["gender"].fault(f"expected f, m or h, found {gender[:40]!r}")
    size = tuple(
        decimal_text(entry.number()) if isinstance(entry.value, int | float) else entry.text()
        for entry in place.get("size", []).one_or_more()
    )
    return Connector(
        place["ID"].text(),
        GENDERS[gender],
        place.get("type", "").text(),
        size,
        place.get("pose", IDENTITY).pose(),
        body,
    )


# --- Joints ---------------------------------------------------------------------------------------


def _joints(place: Place, bodies: set[str]) -> list[JointData]:
    entries = place.get("joints", []).one_or_more(MOST_BODIES)
    _different([entry["ID"] for entry in entries])
    return [_joint(entry, bodies) for entry in entries]


def _joint(place: Place, bodies: set[str]) -> JointData:
    place.keys(JOINT_KEYS)
    named = place.get("type", "revolute").text()
    if named not in JOINTS:
        raise place["type"].fault(f"unknown joint `{named[:40]}`; known are {', '.join(JOINTS)}")
    kind, passive = JOINTS[named]
    for end in ("parent", "child"):
        if place[end].text() not in bodies:
            raise place[end].fault(f"no body has the ID {place[end].text()[:40]!r}")
    if place["parent"].text() == place["child"].text():
        raise place["child"].fault("a joint connects two bodies, not one with itself")
    limits = place.get("limits", {})
    limits.keys(("positionLower", "positionUpper", "peakTorque", "velocity", "acceleration"))
    return JointData(
        place["ID"].text(),
        kind,
        passive or place.get("passive", False).truth(),
        place["parent"].text(),
        place["child"].text(),
        place.get("poseParent", IDENTITY).pose(),
        place.get("poseChild", IDENTITY).pose(),
        _range(limits),
        _bound(limits, "peakTorque"),
        _bound(limits, "velocity"),
        _bound(limits, "acceleration"),
        place.get("gearRatio", 1.0).number(least=0.0),
        place.get("motorInertia", 0.0).number(least=0.0),
        place.get("frictionCoulomb", 0.0).number(least=0.0),
        place.get("frictionViscous", 0.0).number(least=0.0),
    )


def _range(limits: Place) -> tuple[float, float]:
    lower = limits.get("positionLower", -math.inf).limit()
    upper = limits.get("positionUpper", math.inf).limit()
    if lower > upper or lower == math.inf or upper == -math.inf:
        if "positionUpper" not in limits:
            raise limits["positionLower"].fault(f"no position is above {lower:g}")
        raise limits["positionUpper"].fault(f"{upper:g} is below the lower limit {lower:g}")
    return lower, upper


def _bound(limits: Place, name: str) -> float:
    found = limits.get(name, math.inf).limit()
    if found <= 0:
        raise limits[name].fault(f"expected a limit above 0, found {found:g}")
    return found


# --- Conditions on a whole module -----------------------------------------------------------------


def _different(places: Sequence[Place]) -> None:
    seen = dict[str, Place]()
    for place in places:
        if (before := seen.setdefault(place.text(), place)) is not place:
            raise place.fault(f"{place.text()[:40]!r} is at {before.path} already")


def _tree(module: ModuleData) -> None:
    """Reject joints and bodies that are not a tree with all bodies."""
    group = {body.id: body.id for body in module.bodies}

    def top(body: str) -> str:
        while group[body] != body:
            group[body] = group[group[body]]  # path compression
            body = group[body]
        return body

    places = module.place.get("joints", []).one_or_more()
    for joint, place in zip(module.joints, places, strict=True):
        one, other = top(joint.parent), top(joint.child)
        if one == other:
            raise place.fault("it closes a loop, which no module may have")
        group[other] = one
    apart = [body.id for body in module.bodies if top(body.id) != top(module.bodies[0].id)]
    if apart:
        raise module.place["bodies"].fault(f"no joint connects {apart[0][:40]!r} with the others")


def fits(one: Connector, other: Connector) -> bool:
    """Whether two connectors fit."""
    genders = {one.gender, other.gender}
    return (one.type, one.size) == (other.type, other.size) and genders in ({"f", "m"}, {"h"})
