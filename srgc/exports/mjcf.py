"""Write MJCF, the model format of MuJoCo (mujoco.readthedocs.io, XML reference).

A massless link that only carries one joint is not written as a body: MuJoCo allows several joints
in one body instead, which is exact.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

from compiler.expressions.evaluators.balls import working_precision
from compiler.rigid_links.ball_pose import WORLD_POSE, Pose, doubles, unit
from compiler.rigid_links.link_shape import Geometry
from compiler.rigid_links.mass_moments import inertial
from compiler.rigid_links.rigid_tree import PRECISION, LinkJoint
from srgc.exports.exported_robot import ExportedRobot
from srgc.exports.visual_meshes import VisualMesh, mujoco_reads
from srgc.exports.xml_lines import Value, XmlLines

LEAST = Fraction(1, 10**12)
"""The least moment of inertia (kg m^2) of a moving body, and its mass (kg) if it has none."""
LIGHTEST = 1e-15
"""MuJoCo rejects lighter moving bodies (mjMINVAL)."""
LONGEST_STEP = Fraction(1, 1000)
"""The longest step of the simulation, in seconds."""
AT_ONCE = (1e-9, 1.0)
"""The time constant (s) and damping ratio of dry friction; MuJoCo raises it to two steps (refsafe).

So friction changes its sign with the rate, at most two steps early; the default is 20 ms.
"""
HARD = (0.9999, 0.9999)
"""The hardest dry friction that MuJoCo accepts, from the first creep on: joints stick."""
_SEEN: Mapping[str, Value] = {"group": "2", "contype": "0", "conaffinity": "0"}
JOINT_TYPES = {"revolute": "hinge", "prismatic": "slide"}


@dataclass(frozen=True, slots=True)
class _BodyJoint:
    """A joint with its place in the frame of the body that it moves."""

    joint: LinkJoint
    place: Pose


def substeps(step: Fraction) -> int:
    """The number of simulation steps in a step of the task."""
    return max(1, ceil(step / LONGEST_STEP))


def mjcf_text(robot: ExportedRobot, visuals: Mapping[str, str] | None = None) -> str:
    """The robot as MJCF; ``visuals`` maps the digests of visuals to their files.

    Other visuals, and those that MuJoCo cannot read, are left out.

    Raises:
        ValueError: a link has an inertia that no body has, or MuJoCo would not load the robot.
    """
    with working_precision(PRECISION):
        return _Writer(robot, visuals or {}).document()


class _Writer:
    def __init__(self, robot: ExportedRobot, visuals: Mapping[str, str]) -> None:
        self.robot = robot
        self.visuals = [v for v in robot.visuals
                        if v.file.digest in visuals and mujoco_reads(v.file)]  # fmt: skip
        self.files = visuals
        self.seen: dict[tuple[str, Fraction], str] = {}
        self.xml = XmlLines()
        self.children = robot.tree.children()
        self.tools = robot.tree.tools()
        self.order: list[int] = []
        self.hulls: dict[tuple[float, ...], str] = {}

    def document(self) -> str:
        robot, xml = self.robot, self.xml
        count = substeps(robot.step)
        for remark in robot.remarks:
            xml.comment(remark)
        xml.comment(f"{count} steps of the simulation are one step of the task ({robot.step} s)")
        xml.open("mujoco", model=robot.name)
        # inertiafromgeom: geoms do not define inertia.
        xml.element("compiler", angle="radian", inertiafromgeom="false", balanceinertia="false")
        timestep = float(robot.step / count)
        xml.open("option", timestep=timestep, integrator="RK4", gravity=robot.gravity)
        xml.element("flag", contact="disable")
        xml.close()
        self.meshes()
        xml.open("worldbody")
        self.bodies()
        xml.close()
        self.exclusions()
        self.motors()
        self.keyframe()
        xml.close()
        return xml.document()

    def meshes(self) -> None:
        """Write the collision hulls of links, each once, and the files of visuals."""
        links = self.robot.tree.links
        found = [g.size for link in links for g in (*link.looks, *link.collisions)
                 if g.kind == "hull"]  # fmt: skip
        if not found and not self.visuals:
            return
        self.xml.open("asset")
        for visual in self.visuals:
            self.visual_asset(visual)
        for number, corners in enumerate(dict.fromkeys(found), 1):
            self.hulls[corners] = f"hull_{number}"
            self.xml.element("mesh", name=self.hulls[corners], vertex=corners)
        self.xml.close()

    def visual_asset(self, visual: VisualMesh) -> None:
        key = visual.file.digest, visual.scale
        if key in self.seen:
            return
        name = self.seen[key] = f"visual_{len(self.seen) + 1}"
        scale = (float(visual.scale),) * 3
        # With the inertia of a shell, the mesh may be flat or open.
        file = self.files[visual.file.digest]
        self.xml.element("mesh", name=name, file=file, scale=scale, inertia="shell")

    def bodies(self) -> None:
        """Write all bodies, depth first; a None on the stack closes a body."""
        todo: list[tuple[int, tuple[LinkJoint, ...]] | None] = [(0, ())]
        while todo:
            item = todo.pop()
            if item is None:
                self.xml.close()
                continue
            number, joints = item
            below = self.robot.tree.links[number].joint
            joints = joints if below is None else (*joints, below)
            if self.passed_over(number):
                todo.append((self.children[number][0], joints))
                continue
            self.order += [joint.dof for joint in joints]
            self.body(number, joints)
            todo.append(None)
            todo += [(child, ()) for child in reversed(self.children[number])]

    def passed_over(self, number: int) -> bool:
        """Whether a link is not written as a body."""
        link = self.robot.tree.links[number]
        bare = number > 0 and link.moments.massless and not link.looks and not link.collisions
        bare = bare and all(visual.link != number for visual in self.visuals)
        return bare and len(self.children[number]) == 1 and not self.tools[number]

    def body(self, number: int, joints: tuple[LinkJoint, ...]) -> None:
        """Write the start of a body with everything that is fixed in it."""
        robot, xml = self.robot, self.xml
        pose, placed = _placed(joints)
        xml.open(
            "body",
            name=robot.names.links[number],
            pos=doubles(pose.origin),
            quat=pose.quaternion(),
        )
        link = robot.tree.links[number]
        if number > 0 or not link.moments.massless:
            self.inertial(number)
        for item in placed:
            self.joint(item)
        seen = [visual for visual in self.visuals if visual.link == number]
        for visual in seen:
            what: dict[str, Value] = {"mesh": self.seen[visual.file.digest, visual.scale]}
            self.placed_geom({"type": "mesh", **what}, visual.pose, _SEEN)
        for look in () if seen else link.looks:
            self.geom(look, **_SEEN)
        for geometry in link.collisions:
            self.geom(geometry, group="3")
        for tool in self.tools[number]:
            pose = robot.tree.effectors[tool].pose
            origin, turn = doubles(pose.origin), pose.quaternion()
            xml.element("site", name=robot.names.effectors[tool], pos=origin, quat=turn)

    def inertial(self, number: int) -> None:
        tree = self.robot.tree
        values = inertial(tree.links[number].moments, tree.dimension, LEAST)
        if number > 0 and values.mass < LIGHTEST:
            raise ValueError(
                f"MuJoCo takes no moving body below {LIGHTEST} kg, and "
                f"{self.robot.names.links[number]} has {values.mass} kg"
            )
        self.xml.element("inertial", pos=values.com, mass=values.mass, fullinertia=values.inertia)

    def joint(self, item: _BodyJoint) -> None:
        joint, place = item.joint, item.place
        name, drive = self.robot.names.joints[joint.dof], self.robot.drives[joint.dof]
        limits: dict[str, Value] = {"limited": "false"}
        if joint.range is not None:
            if not joint.range[0] < joint.range[1]:
                raise ValueError(f"MuJoCo takes no range of one value, and {name} has such a range")
            limits = {"limited": "true", "range": joint.range}
        if drive.damping:
            limits["damping"] = drive.damping
        if drive.armature:
            limits["armature"] = drive.armature
        if drive.friction:
            limits["frictionloss"] = drive.friction
            limits |= {"solreffriction": AT_ONCE, "solimpfriction": HARD}
        self.xml.element(
            "joint",
            name=name,
            type=JOINT_TYPES[joint.kind],
            pos=doubles(place.origin),
            axis=doubles(place.rotation * unit(joint.axis, joint.sign)),
            **limits,
        )

    def geom(self, geometry: Geometry, **more: Value) -> None:
        size = geometry.size
        if geometry.kind in {"cylinder", "capsule"}:
            size = (geometry.size[0], geometry.size[1] / 2)
        elif geometry.kind == "box":
            size = tuple(side / 2 for side in geometry.size)
        what: dict[str, Value] = {"type": geometry.kind, "size": size}
        if geometry.kind == "hull":
            what = {"type": "mesh", "mesh": self.hulls[size]}
        self.placed_geom(what, geometry.pose, more)

    def placed_geom(self, what: Mapping[str, Value], pose: Pose, more: Mapping[str, Value]) -> None:
        place: dict[str, Value] = {"pos": doubles(pose.origin), "quat": pose.quaternion()}
        self.xml.element("geom", **what, **place, **more)

    def exclusions(self) -> None:
        """Exclude pairs of bodies that the task lets touch; MuJoCo itself exempts adjacent ones."""
        pairs = self.robot.tree.touching
        if not pairs:
            return
        self.xml.open("contact")
        for one, two in pairs:
            first, second = (self.robot.names.links[number] for number in (one, two))
            self.xml.element("exclude", body1=first, body2=second)
        self.xml.close()

    def motors(self) -> None:
        self.xml.open("actuator")
        for motor in self.robot.motors():
            limits: dict[str, Value] = {"ctrllimited": "false"}
            if motor.bound is not None:
                if not motor.bound > 0:
                    raise ValueError(f"the effort bound of {motor.name} is too small for a double")
                limits = {"ctrllimited": "true", "ctrlrange": (-motor.bound, motor.bound)}
            self.xml.element("motor", name=motor.name, joint=motor.name, **limits)
        self.xml.close()

    def keyframe(self) -> None:
        """Write the start of the motion, in the order in which MuJoCo numbers the joints."""
        start, n = self.robot.start, len(self.order)
        state: dict[str, Value] = {}
        if start:
            state = {
                "qpos": [start[dof] for dof in self.order],
                "qvel": [start[n + dof] for dof in self.order],
            }
        self.xml.open("keyframe")
        self.xml.element("key", name="start", **state)
        self.xml.close()


def _placed(joints: tuple[LinkJoint, ...]) -> tuple[Pose, list[_BodyJoint]]:
    """The pose of a body relative to the one below at zero joints, and its joints in its frame."""
    whole = WORLD_POSE
    poses = []
    for joint in joints:
        whole = whole * joint.origin
        poses.append(whole)
    back = whole.inverse()
    placed = [_BodyJoint(joint, back * pose) for joint, pose in zip(joints, poses, strict=True)]
    if placed:
        # The last joint is exactly at the origin of the body.
        placed[-1] = _BodyJoint(joints[-1], WORLD_POSE)
    return whole, placed
