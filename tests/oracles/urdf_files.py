"""Small URDF files, from their parts."""

from __future__ import annotations

LIMIT = '<limit lower="-1" upper="1.5" effort="5" velocity="2"/>'
INERTIAL = (
    '<inertial><mass value="{mass}"/>'
    '<inertia ixx="{xx}" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def link(name: str, mass: float = 2.0, xx: float = 1.0, more: str = "") -> str:
    """A link with a body; lines of its own make the numbers of lines tell something."""
    return f'<link name="{name}">{INERTIAL.format(mass=mass, xx=xx)}{more}</link>'


def joint(
    kind: str,
    more: str = "",
    *,
    name: str = "j",
    parent: str = "a",
    child: str = "b",
    axis: str = "0 0 1",
) -> str:
    """A joint between two links."""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<axis xyz="{axis}"/>{more}</joint>'
    )


def robot(*parts: str, name: str = "r") -> str:
    """A robot, one part a line: the first stands in line 2."""
    from xml.sax.saxutils import quoteattr

    return "\n".join([f"<robot name={quoteattr(name)}>", *parts, "</robot>"])
