"""What an export of a robot is made of, whatever the format."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from compiler.rigid_links.part_names import PartNames
from compiler.rigid_links.rigid_tree import LinkJoint, RigidTree


@dataclass(frozen=True, slots=True)
class Motor:
    """A joint by its name, the number of the link that it carries, and the bound of its effort.

    ``damping`` is its viscous friction (N m s or N s/m).
    """

    name: str
    link: int
    joint: LinkJoint
    bound: float | None
    damping: float


@dataclass(frozen=True, slots=True)
class ExportedRobot:
    """A robot with the numbers of its task.

    ``efforts`` are the bounds of the motors by degree of freedom (N m, N), None without one, and
    ``dampings`` the viscous friction of the joints (N m s, N s/m), 0 without;
    ``gravity`` is in m/s^2, ``step`` that of the task in seconds; ``start`` holds coordinates and
    rates, or nothing; ``remarks`` are lines for a reader.
    """

    name: str
    tree: RigidTree
    names: PartNames
    efforts: tuple[float | None, ...]
    dampings: tuple[float, ...]
    gravity: tuple[float, float, float]
    step: Fraction
    start: tuple[float, ...]
    remarks: tuple[str, ...]

    def motors(self) -> Iterator[Motor]:
        """The motors in the order of the degrees of freedom."""
        for link, joint in self.tree.carried():
            dof = joint.dof
            name, damping = self.names.joints[dof], self.dampings[dof]
            yield Motor(name, link, joint, self.efforts[dof], damping)
