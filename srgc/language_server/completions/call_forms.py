"""The arguments of emissions and functions, for signatures and completion."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Form:
    """The form of a call: its parameters with their meanings, and the meaning of the call.

    ``named``: whether arguments are written ``name: value``.
    """

    parameters: tuple[tuple[str, str], ...]
    means: str
    named: bool = True

    def label(self, name: str) -> str:
        """The call in one line."""
        return f"{name}({', '.join(parameter for parameter, _ in self.parameters)})"


_ALONG = (
    ("frame", "where its axis begins"),
    ("axis", "the axis of the frame along which it lies: x, y, z, -x, -y or -z"),
    ("length", "how far it leads, m"),
    ("radius", "its radius, m"),
)
EMISSIONS: dict[str, Form] = {
    "rod": Form(
        (
            ("frame", "where it begins"),
            ("axis", "the axis of the frame along which it lies: x, y, z, -x, -y or -z"),
            ("length", "its length, m"),
            ("density", "its mass per length, kg/m"),
            ("radius", "may be left out: makes it a capsule for `avoid … with body`, m"),
        ),
        "a uniform rod from the origin of a frame",
    ),
    "point": Form(
        (("frame", "where it is"), ("mass", "its mass, kg")),
        "a point mass at the origin of a frame",
    ),
    "solid": Form(
        (
            ("frame", "the frame in which the others are given"),
            ("mass", "its mass, kg"),
            ("com", "its centre of mass in the frame, m"),
            (
                "inertia",
                "about `com`, kg*m^2: one number, in space (xx, yy, zz, xy, xz, yz)",
            ),
        ),
        "a rigid body",
    ),
    "effector": Form((("frame", "where it is"),), "an effector at the origin of a frame"),
    "sphere": Form(
        (("frame", "where its centre is"), ("radius", "its radius, m")),
        "a ball that collides, without mass",
    ),
    "capsule": Form(_ALONG, "all that is nearer than the radius to a segment, without mass"),
    "cylinder": Form(_ALONG, "a cylinder that collides, without mass"),
    "box": Form(
        (("frame", "where its middle is"), ("size", "its edges (a, b, c), in the plane (a, b), m")),
        "a box along the axes of the frame that collides, without mass",
    ),
    "hull": Form(
        (
            ("frame", "the frame of the mesh"),
            ("file", "the path of a mesh in quotes: STL or OBJ"),
            ("scale", "the unit of the mesh, such as 1 mm"),
        ),
        "the convex hull of a mesh that collides, without mass",
    ),
    "visual": Form(
        (
            ("frame", "the frame of the mesh"),
            ("file", "the path of a mesh in quotes: STL, OBJ, COLLADA or glTF (.glb)"),
            ("scale", "the unit of the mesh, such as 1 mm"),
        ),
        "a mesh that exports show; it has no mass and does not collide",
    ),
}
FUNCTIONS: dict[str, Form] = {
    "rot": Form(
        (("axis", "x, y, z, -x, -y or -z"), ("angle", "a revolute degree of freedom, or rad")),
        "the frame turned about an axis",
        named=False,
    ),
    "move": Form(
        (("axis", "x, y, z, -x, -y or -z"), ("distance", "a prismatic one, or m")),
        "the frame moved along an axis; also `move((x, y, z))`",
        named=False,
    ),
    "sin": Form((("angle", "rad"),), "the sine", named=False),
    "cos": Form((("angle", "rad"),), "the cosine", named=False),
    "tan": Form((("angle", "rad"),), "the tangent", named=False),
    "sqrt": Form((("value", "not negative"),), "the square root", named=False),
    "abs": Form((("value", "any number"),), "the absolute value", named=False),
    "rate": Form(
        (("dof", "a degree of freedom of this module"),),
        "the rate of a degree of freedom, in rad/s or m/s",
        named=False,
    ),
}
