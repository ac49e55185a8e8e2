"""Write URDF, the robot description format of ROS (wiki.ros.org/urdf/XML).

Every link has an inertial, as many readers require.  What the frame of an effector has to have is
taken from the link that carries it, so the sum is that of the robot.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from compiler.expressions.evaluators.balls import ball, column, working_precision
from compiler.rigid_links.ball_pose import WORLD_POSE, Pose, doubles, unit
from compiler.rigid_links.link_shape import Geometry
from compiler.rigid_links.mass_moments import MassMoments, inertial, legal, token
from compiler.rigid_links.rigid_tree import PRECISION, axis_of
from srgc.exports.exported_robot import ExportedRobot, Motor, UnusedNames
from srgc.exports.visual_meshes import VisualMesh
from srgc.exports.xml_lines import XmlLines

LEAST = Fraction(1, 10**9)
"""Some readers reject smaller masses (kg) and principal moments of inertia (kg m^2)."""
UNLIMITED = 1e9
"""Written if a robot has no limit where URDF requires a number (SI)."""


def urdf_text(
    robot: ExportedRobot,
    meshes: Mapping[tuple[float, ...], str] | None = None,
    visuals: Mapping[str, str] | None = None,
) -> str:
    """The robot as URDF; ``meshes`` maps the corners of hulls to their files.

    Other hulls are replaced by their bounding boxes.  ``visuals`` maps digests to the files of
    visuals; others are left out.

    Raises:
        ValueError: a link has an inertia that no body has.
    """
    with working_precision(PRECISION):
        return _Writer(robot, meshes or {}, visuals or {}).document()


class _Writer:
    def __init__(
        self,
        robot: ExportedRobot,
        meshes: Mapping[tuple[float, ...], str],
        visuals: Mapping[str, str],
    ) -> None:
        self.robot = robot
        self.meshes = meshes
        self.visuals = visuals
        self.xml = XmlLines()
        self.tools = robot.tree.tools()

    def document(self) -> str:
        robot, xml = self.robot, self.xml
        for remark in robot.remarks:
            xml.comment(remark)
        xml.open("robot", name=robot.name)
        for number in range(len(robot.tree.links)):
            self.link(number)
        for motor in robot.motors():
            self.joint(motor)
        for number, frame in enumerate(robot.tree.effectors):
            self.effector(number, robot.names.links[frame.link], frame.pose)
        for motor in robot.motors():
            self.transmission(motor)
        xml.close()
        return xml.document()

    def link(self, number: int) -> None:
        link = self.robot.tree.links[number]
        self.xml.open("link", name=self.robot.names.links[number])
        self.inertial(self.remaining(number))
        seen = [v for v in self.robot.visuals if v.link == number and v.file.digest in self.visuals]
        for visual in seen:
            self.visual(visual)
        for look in () if seen else link.looks:
            for part in _parts(look):
                self.geometry("visual", part)
        for geometry in link.collisions:
            for part in _parts(geometry):
                self.geometry("collision", part)
        self.xml.close()

    def remaining(self, number: int) -> MassMoments:
        """The moments of a link less those given to the frames of its effectors.

        The difference is corrected as little as ``legal`` allows; a link with too little mass for
        that is not changed.
        """
        tree = self.robot.tree
        whole = tree.links[number].moments
        left = whole
        for tool in self.tools[number]:
            left = left - token(LEAST, tree.effectors[tool].pose.origin)
        if left is whole or not left.mass > ball(LEAST):
            return whole
        inertial(whole, tree.dimension, LEAST)  # this rejects an inertia that no body has
        return legal(left, tree.dimension, LEAST)

    def inertial(self, moments: MassMoments) -> None:
        values = inertial(moments, self.robot.tree.dimension, LEAST)
        names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        tensor = dict(zip(names, values.inertia, strict=True))
        self.xml.open("inertial")
        self.xml.element("origin", xyz=values.com, rpy=(0, 0, 0))
        self.xml.element("mass", value=values.mass)
        self.xml.element("inertia", **{name: tensor[name] for name in sorted(tensor)})
        self.xml.close()

    def origin(self, pose: Pose) -> None:
        self.xml.element("origin", xyz=doubles(pose.origin), rpy=pose.roll_pitch_yaw())

    def geometry(self, tag: str, geometry: Geometry) -> None:
        mesh = self.meshes.get(geometry.size) if geometry.kind == "hull" else None
        if geometry.kind == "hull" and mesh is None:
            self.xml.comment("a box about a hull, for which URDF needs a file of its own")
            geometry = _box_about(geometry)
        self.xml.open(tag)
        self.origin(geometry.pose)
        self.xml.open("geometry")
        match geometry.kind:
            case "cylinder" | "capsule":
                radius, length = geometry.size
                self.xml.element("cylinder", radius=radius, length=length)
            case "sphere":
                self.xml.element("sphere", radius=geometry.size[0])
            case "box":
                self.xml.element("box", size=geometry.size)
            case "hull":
                self.xml.element("mesh", filename=mesh or "")
        self.xml.close()
        self.xml.close()

    def visual(self, visual: VisualMesh) -> None:
        self.xml.open("visual")
        self.origin(visual.pose)
        self.xml.open("geometry")
        scale = (float(visual.scale),) * 3
        self.xml.element("mesh", filename=self.visuals[visual.file.digest], scale=scale)
        self.xml.close()
        self.xml.close()

    def joint(self, motor: Motor) -> None:
        name, joint, names = motor.name, motor.joint, self.robot.names
        kind = joint.kind
        if kind == "revolute" and joint.range is None:
            self.xml.open("joint", name=name, type="continuous")
        else:
            self.xml.open("joint", name=name, type=kind)
        self.origin(joint.origin)
        self.xml.element("parent", link=names.links[joint.parent])
        self.xml.element("child", link=names.links[motor.link])
        self.xml.element("axis", xyz=axis_of(joint))
        most = UNLIMITED if motor.bound is None else motor.bound
        speed = UNLIMITED if joint.rate is None else max(abs(rate) for rate in joint.rate)
        if joint.rate is not None and joint.rate[0] != -joint.rate[1]:
            bounds = f"[{joint.rate[0]!r}, {joint.rate[1]!r}]"
            self.xml.comment(f"the rate is in {bounds}, and URDF has one bound for both ways")
        if kind == "revolute" and joint.range is None:
            self.xml.element("limit", effort=most, velocity=speed)
        else:
            lower, upper = joint.range or (-UNLIMITED, UNLIMITED)
            self.xml.element("limit", lower=lower, upper=upper, effort=most, velocity=speed)
        drive = motor.drive
        friction = {"damping": drive.damping, "friction": drive.friction}
        if any(friction.values()):
            self.xml.element("dynamics", **{key: value for key, value in friction.items() if value})
        if drive.armature:
            rotor = f"the rotor adds {drive.armature!r} in SI units to M, which URDF cannot say"
            self.xml.comment(rotor)
        self.xml.close()

    def effector(self, number: int, parent: str, pose: Pose) -> None:
        name = self.robot.names.effectors[number]
        self.xml.open("link", name=name)
        self.inertial(token(LEAST, WORLD_POSE.origin))
        self.xml.close()
        joint = UnusedNames(self.robot.names.joints).name(f"{name}_fixed")
        self.xml.open("joint", name=joint, type="fixed")
        self.origin(pose)
        self.xml.element("parent", link=parent)
        self.xml.element("child", link=name)
        self.xml.close()

    def transmission(self, motor: Motor) -> None:
        xml, joint, gear = self.xml, motor.name, motor.drive.gear
        xml.open("transmission", name=f"{joint}_transmission")
        xml.text("type", "transmission_interface/SimpleTransmission")
        xml.open("joint", name=joint)
        xml.text("hardwareInterface", "hardware_interface/EffortJointInterface")
        xml.close()
        xml.open("actuator", name=f"{joint}_motor")
        # A reduction of 0 is not valid; with it the rotor has no effect at the joint either.
        xml.text("mechanicalReduction", _ratio(gear or 1.0))
        xml.close()
        xml.close()


def _ratio(gear: float) -> str:
    """The number as it reads back; a whole number has no point."""
    return repr(gear).removesuffix(".0")


def _box_about(hull: Geometry) -> Geometry:
    """The bounding box of a hull along the axes of its frame."""
    sides = [hull.size[axis::3] for axis in range(3)]
    middle = [(Fraction(min(side)) + Fraction(max(side))) / 2 for side in sides]
    pose = hull.pose.moved(column([ball(value) for value in middle]))
    return Geometry("box", pose, tuple(max(side) - min(side) for side in sides))


def _parts(geometry: Geometry) -> list[Geometry]:
    """The geometry in shapes of URDF: a capsule becomes a cylinder and two spheres."""
    if geometry.kind != "capsule":
        return [geometry]
    radius, length = geometry.size
    ends = [geometry.pose.moved(unit(2, sign) * (ball(Fraction(length)) / 2)) for sign in (-1, 1)]
    return [
        Geometry("cylinder", geometry.pose, geometry.size),
        *(Geometry("sphere", end, (radius,)) for end in ends),
    ]
