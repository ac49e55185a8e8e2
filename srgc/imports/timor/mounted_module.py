"""Convert a module of a set, mounted at one of its connectors, to a module of the language.

A connector's z axis points away from its module, and two connectors that meet differ by a half turn
about x.  So the frame of an output is the frame of its connector, where the next module stands, and
the frame ``in`` of that module is its own connector rotated by 180 degrees about x, so that z
points into it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from srgc.imports.module_set import (
    Body,
    Dof,
    Drive,
    Frame,
    Module,
    Motion,
    Move,
    Placement,
    Port,
    Role,
    Shape,
    Step,
    Steps,
    Turn,
    steps_of,
)
from srgc.imports.names import Names
from srgc.imports.timor.geometry_data import Geometry
from srgc.imports.timor.mesh_hulls import MeshHulls
from srgc.imports.timor.port_types import GENDER_WORDS, PortTypes
from srgc.imports.timor.set_data import (
    BASE,
    EFFECTOR,
    BodyData,
    Connector,
    JointData,
    ModuleData,
    Pose,
)

HALF_TURN = np.diag([1.0, -1.0, -1.0, 1.0])
"""Rotates a connector onto the one that it meets: a half turn about x."""
NOTHING = 1e-12
"""Displacements with entries of at most this size are ignored."""
FAR_ANGLE, FAR_LENGTH = 1000.0, 1000.0
"""Replaces an infinite limit if the other limit is finite, in rad and m."""
_TAKEN = ("in", "u", "rate", "pi", "rot", "move", "sin", "cos", "tan", "sqrt", "abs")


@dataclass(frozen=True, slots=True)
class Mounting:
    """A module, and the connector by which it stands on others."""

    module: ModuleData
    entry: Connector

    @property
    def outputs(self) -> list[Connector]:
        """The connectors on which other modules may stand."""
        return [
            connector
            for connector in self.module.connectors
            if connector is not self.entry and connector.type not in (BASE, EFFECTOR)
        ]

    @property
    def effectors(self) -> list[Connector]:
        """The connectors that are effectors."""
        return [each for each in self.module.connectors if each.type == EFFECTOR]


def mounted_module(
    mounting: Mounting, name: str, types: PortTypes, meshes: MeshHulls, remarks: list[str]
) -> Module:
    """The module in the language; adds to ``remarks`` what the language cannot express."""
    return _Mounted(mounting, name, types, meshes, remarks).module()


def output_names(mounting: Mounting) -> dict[str, str]:
    """Maps the IDs of connectors that are outputs to the names of their ports."""
    outputs, names = mounting.outputs, Names(_TAKEN)
    if len(outputs) == 1:
        return {outputs[0].id: "out"}
    found = dict[str, str]()
    for output in outputs:
        wanted = _short(output.id, mounting.module)
        found[output.id] = names.name(wanted if wanted[:1].isalpha() else f"out_{wanted}")
    return found


@dataclass(slots=True)
class _Mounted:
    mounting: Mounting
    name: str
    types: PortTypes
    meshes: MeshHulls
    remarks: list[str]
    frames: list[Frame] = field(default_factory=list)
    dofs: list[Dof] = field(default_factory=list)
    at: dict[str, str] = field(default_factory=dict)

    def module(self) -> Module:
        mounting, data = self.mounting, self.mounting.module
        ports = output_names(mounting)
        names = Names((*_TAKEN, *ports.values()))
        self._walk(names)
        outputs = [
            Frame(ports[output.id], self._placed(output.body, output.pose))
            for output in mounting.outputs
        ]
        return Module(
            name=self.name,
            role=self._role(),
            ports=[self._port("in", mounting.entry)]
            + [self._port(ports[output.id], output) for output in mounting.outputs],
            frames=[*self.frames, *outputs],
            dofs=self.dofs,
            bodies=[
                Body(Placement(self.at[body.id]), body.mass, body.com, body.inertia)
                for body in data.bodies
                if body.id in self.at and (body.mass > 0 or any(body.inertia))
            ],
            shapes=[
                shape for body in data.bodies if body.id in self.at for shape in self._of_body(body)
            ],
            effectors=[self._placed(each.body, each.pose) for each in mounting.effectors],
            comments=[self._comment(ports)],
        )

    def _port(self, name: str, connector: Connector) -> Port:
        return Port(name, self.types.name(connector), GENDER_WORDS[connector.gender])

    def _role(self) -> Role:
        data = self.mounting.module
        if any(connector.type == BASE for connector in data.connectors):
            return "base"
        if self.dofs:
            return "joint"
        return "effector" if self.mounting.effectors and not self.mounting.outputs else "link"

    def _comment(self, ports: Mapping[str, str]) -> str:
        """A comment with the module's name in the set, and the connector of each port."""
        data = self.mounting.module
        called = data.id if data.name == data.id else f"{data.name} (ID {data.id})"
        met = [f"in is its connector {self.mounting.entry.id}"]
        met += [f"{port} {connector}" for connector, port in ports.items()]
        cost = f"; cost {data.cost:g}" if data.cost else ""
        return f"{called}: {', '.join(met)}{cost}."

    # --- Frames -----------------------------------------------------------------------------------

    def _walk(self, names: Names) -> None:
        """Add frames of the bodies, joint by joint from the body with the entry."""
        data, entry = self.mounting.module, self.mounting.entry
        places = {joint.id: (joint, where) for joint, where in _placed_joints(data)}
        needed = self._needed()
        self._frame(entry.body, "in", steps_of(HALF_TURN @ np.linalg.inv(entry.pose)), names)
        waiting = [entry.body]
        while waiting:
            body = waiting.pop(0)
            for key in [key for key, (joint, _) in places.items() if body in _ends(joint)]:
                joint, where = places.pop(key)
                other = joint.child if joint.parent == body else joint.parent
                if other not in needed:
                    self.remarks.append(f"{where}: the joint moves nothing; it is left out")
                    continue
                self._frame(other, self.at[body], self._steps(joint, body, where, names), names)
                waiting.append(other)

    def _needed(self) -> set[str]:
        """The bodies that are not empty, or that lead to one that is not."""
        data, entry = self.mounting.module, self.mounting.entry
        needed = {body.id for body in data.bodies if _has_something(body)} | {entry.body}
        joints = list(data.joints)
        neighbours = {body.id: set[str]() for body in data.bodies}
        for joint in joints:
            neighbours[joint.parent].add(joint.child)
            neighbours[joint.child].add(joint.parent)
        leaves = [body for body, near in neighbours.items() if len(near) == 1]
        gone = set[str]()
        while leaves:
            leaf = leaves.pop()
            if leaf in needed or leaf in gone:
                continue
            gone.add(leaf)
            for near in neighbours[leaf]:
                neighbours[near].discard(leaf)
                leaves += [near] if len(neighbours[near]) == 1 else []
        return set(neighbours) - gone

    def _steps(self, joint: JointData, body: str, where: str, names: Names) -> Steps:
        """The steps from one body of a joint to the other.

        From the child to the parent all displacements are inverted.  The angle remains that of the
        child relative to the parent, so the axis is -z.
        """
        forward = joint.parent == body
        first, second = joint.to_joint, joint.to_child
        if not forward:
            first, second = _inverse(joint.to_child), _inverse(joint.to_joint)
        if joint.kind == "fixed":
            return steps_of(first @ second)
        dof = self._dof(joint, where, names, forward=forward)
        self.dofs.append(dof)
        return (*_some_steps(first), Motion(dof.name), *_some_steps(second))

    def _frame(self, body: str, base: str, steps: Steps, names: Names) -> None:
        if not _moves(steps):
            self.at[body] = base
            return
        wanted = _short(body, self.mounting.module).lower()
        name = names.name(wanted if wanted[:1].isalpha() else f"body_{wanted}".rstrip("_"))
        self.frames.append(Frame(name, Placement(base, steps)))
        self.at[body] = name

    def _placed(self, body: str, pose: Pose) -> Placement:
        return Placement(self.at[body], _some_steps(pose))

    # --- Joints and shapes ------------------------------------------------------------------------

    def _dof(self, joint: JointData, where: str, names: Names, *, forward: bool) -> Dof:
        turns = joint.kind == "revolute"
        short = _short(joint.id, self.mounting.module).lower()
        plain = re.sub(r"[^a-z]", "", short) in ("", "revolute", "prismatic", "joint")
        only = sum(each.kind != "fixed" for each in self.mounting.module.joints) == 1
        wanted = ("q" if turns else "s") if plain and only else short
        has_rotor = joint.rotor > 0
        drive = Drive(
            gear=joint.gear if has_rotor and (joint.gear != 1 or not turns) else None,
            rotor=joint.rotor if has_rotor else None,
            viscous=joint.viscous or None,
            coulomb=joint.coulomb or None,
        )
        if joint.gear != 1 and not has_rotor:
            self.remarks.append(f"{where}: gear {joint.gear:g} without a rotor has no effect")
        return Dof(
            names.name(wanted if wanted[:1].isalpha() else f"joint_{wanted}".rstrip("_")),
            "revolute" if turns else "prismatic",
            "z" if forward else "-z",
            range=self._range(joint, where, turns=turns),
            rate=None if math.isinf(joint.rate) else joint.rate,
            accel=None if math.isinf(joint.accel) else joint.accel,
            effort=None if math.isinf(joint.effort) or joint.passive else joint.effort,
            drive=drive,
            passive=joint.passive,
        )

    def _range(self, joint: JointData, where: str, *, turns: bool) -> tuple[float, float] | None:
        lower, upper = joint.range
        if math.isinf(lower) and math.isinf(upper):
            return None
        far = FAR_ANGLE if turns else FAR_LENGTH
        if math.isinf(lower) or math.isinf(upper):
            unit = "rad" if turns else "m"
            self.remarks.append(f"{where}: a limit that is infinite became {far:g} {unit}")
        return max(lower, -far), min(upper, far)

    def _of_body(self, body: BodyData) -> Iterator[Shape]:
        for geometry in body.shapes:
            yield from self._shapes(body.id, geometry)
        for geometry in body.visuals:
            yield from self.meshes.visuals(geometry, self.at[body.id])

    def _shapes(self, body: str, geometry: Geometry) -> Iterator[Shape]:
        if geometry.kind == "mesh":
            yield from self.meshes.shapes(geometry, self.at[body])
            return
        pose = _from_its_end(geometry) if geometry.kind == "cylinder" else geometry.pose
        yield Shape(geometry.kind, Placement(self.at[body], _some_steps(pose)), geometry.size)


def _from_its_end(geometry: Geometry) -> Pose:
    """The pose of a cylinder's lower end; it is only rotated if its axis is not vertical."""
    pose, down = geometry.pose, np.eye(4)
    down[2, 3] = -geometry.size[1] / 2
    if abs(abs(pose[2, 2]) - 1) <= NOTHING:
        upright = np.eye(4)
        upright[:3, 3] = pose[:3, 3]
        pose = upright
    found: Pose = np.matmul(pose, down, dtype=np.float64)
    return found


def _inverse(pose: Pose) -> Pose:
    found: Pose = np.linalg.inv(pose).astype(np.float64)
    return found


def _some_steps(pose: Pose) -> Steps:
    """The steps of a pose without negligible ones."""
    return tuple(step for step in steps_of(pose) if _moves((step,)))


def _moves(steps: Steps) -> bool:
    return any(map(_does_something, steps))


def _does_something(step: Step) -> bool:
    match step:
        case Motion():
            return True
        case Move():
            return max(map(abs, step.by)) > NOTHING
        case Turn():
            return abs(step.angle) > NOTHING


def _has_something(body: BodyData) -> bool:
    inert = body.mass > 0 or any(body.inertia)
    return inert or bool(body.shapes) or bool(body.connectors)


def _ends(joint: JointData) -> tuple[str, str]:
    return joint.parent, joint.child


def _placed_joints(data: ModuleData) -> Iterator[tuple[JointData, str]]:
    entries = data.place.get("joints", []).one_or_more()
    for joint, entry in zip(data.joints, entries, strict=True):
        yield joint, entry.path


def _short(wanted: str, module: ModuleData) -> str:
    """An ID without the ID or name of its module as a prefix."""
    for start in (module.id, module.name):
        if wanted.startswith(start) and (wanted == start or not wanted[len(start)].isalnum()):
            return wanted[len(start) :].lstrip("_- .")
    return wanted
