"""Write SRDF: planning groups for MoveIt, and links that may touch (wiki.ros.org/srdf).

A group is the chain of joints from the base to an effector.  Links may touch if the task's ``avoid
self`` exempts them, or if a joint connects them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

from compiler.rigid_links.rigid_tree import LinkJoint, RigidTree
from srgc.exports.exported_robot import ExportedRobot
from srgc.exports.xml_lines import XmlLines

ADJACENT = "Adjacent"
SIBLINGS = "Joints on one link"
BARE = "Adjacent but for links without bodies"
EXEMPT = "Exempt in the task"


@dataclass(frozen=True, slots=True)
class PlanningGroup:
    """The names of the joints from the base to an effector, beginning at the base."""

    name: str
    hand: str
    effector: int
    joints: tuple[str, ...]


def planning_groups(robot: ExportedRobot) -> tuple[PlanningGroup, ...]:
    """A group for each effector that moves: ``arm``, or for several ``arm_1`` and so on."""
    tree = robot.tree
    single = len(tree.effectors) == 1
    found = []
    for number, frame in enumerate(tree.effectors):
        joints = [joint.dof for _, joint in _below(tree, frame.link)]
        end = "" if single else f"_{number + 1}"
        names = tuple(robot.names.joints[dof] for dof in reversed(joints))
        if names:
            found.append(PlanningGroup(f"arm{end}", f"hand{end}", number, names))
    return tuple(found)


def srdf_text(robot: ExportedRobot, groups: tuple[PlanningGroup, ...]) -> str:
    """The SRDF document; its names are those of the URDF."""
    names, xml = robot.names, XmlLines()
    for remark in robot.remarks:
        xml.comment(remark)
    xml.open("robot", name=robot.name)
    for group in groups:
        tip = names.effectors[group.effector]
        xml.open("group", name=group.name)
        xml.element("chain", base_link=names.links[0], tip_link=tip)
        xml.close()
        xml.open("group", name=group.hand)
        xml.element("link", name=tip)
        xml.close()
    for group in groups:
        _start(xml, robot, group)
    for group in groups:
        carrier = names.links[robot.tree.effectors[group.effector].link]
        xml.element(
            "end_effector", name=f"{group.hand}_tip", parent_link=carrier, group=group.hand,
            parent_group=group.name,
        )  # fmt: skip
    xml.element(
        "virtual_joint", name="world_to_base", type="fixed", parent_frame="world",
        child_link=names.links[0],
    )  # fmt: skip
    for one, two, reason in touching(robot):
        xml.element("disable_collisions", link1=one, link2=two, reason=reason)
    xml.close()
    return xml.document()


def _start(xml: XmlLines, robot: ExportedRobot, group: PlanningGroup) -> None:
    """Write the start of the motion as a named state."""
    if not robot.start:
        return
    places = {name: dof for dof, name in enumerate(robot.names.joints)}
    xml.open("group_state", name="start", group=group.name)
    for joint in group.joints:
        xml.element("joint", name=joint, value=robot.start[places[joint]])
    xml.close()


def touching(robot: ExportedRobot) -> Iterator[tuple[str, str, str]]:
    """Pairs of links that MoveIt should not check, with the reason, in the order of the links.

    The links of effectors have no shapes.
    """
    tree, names = robot.tree, robot.names.links
    exempt = {*tree.touching}
    for one, two in combinations(range(len(tree.links)), 2):
        reason = _nearness(tree, one, two)
        if (one, two) in exempt or reason == ADJACENT:
            yield names[one], names[two], reason or EXEMPT


def _nearness(tree: RigidTree, one: int, two: int) -> str | None:
    """How two links are connected if they are neighbours, otherwise None."""
    parents = [None if link.joint is None else link.joint.parent for link in tree.links]
    if parents[two] == one:
        return ADJACENT
    between = [number for number, _ in _below(tree, two)][1:]
    if one in (*between, 0):
        bare = between[: between.index(one)] if one in between else between
        return BARE if all(not tree.links[number].collisions for number in bare) else None
    return SIBLINGS if parents[one] == parents[two] else None


def _below(tree: RigidTree, link: int) -> Iterator[tuple[int, LinkJoint]]:
    """The links from one down to the first above the base, with their joints."""
    joint = tree.links[link].joint
    while joint is not None:
        yield link, joint
        link = joint.parent
        joint = tree.links[link].joint
