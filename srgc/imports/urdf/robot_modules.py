"""Make modules from the links of a URDF: a base, and a module for each joint that moves.

A module moves as one body: a joint, the link that it carries, and all links attached to that by
held joints.  Its frame ``turned`` or ``moved`` is the frame of the joint's link in the file.
Outputs lead to the next joints and to the tips, which are separate modules, so that another tool
can replace them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from grammar_lang.diagnostics.wording import nearest
from grammar_lang.files.file_tree import visible
from srgc.faults import UsageFault
from srgc.imports.module_set import Family, Frame, Module, ModuleSet, Placement, Port, Role
from srgc.imports.names import Names, in_quotes, legible
from srgc.imports.urdf.joint_motion import JointMotion, JointMotions
from srgc.imports.urdf.link_parts import LinkParts
from srgc.imports.urdf.rigid_part import RigidPart
from srgc.imports.urdf.robot_model import UrdfRobot


@dataclass(slots=True)
class RobotModules:
    """Makes the modules of a robot; all their names begin with ``prefix``."""

    robot: UrdfRobot
    parts: LinkParts
    motions: JointMotions
    prefix: str
    remarks: list[str]
    effectors: Sequence[str] = ()
    made: list[RigidPart] = field(default_factory=list)
    names: Names = field(default_factory=Names)
    types: dict[tuple[str, str], str] = field(default_factory=dict)
    type_names: Names = field(default_factory=Names)

    def module_set(self) -> ModuleSet:
        """The modules, and a grammar whose only word is the robot.

        Raises:
            UsageFault: a joint moves no mass, or an effector is not a link.
        """
        self._collect(self._part("Base", None), self.robot.root, None)
        self._add_tips()
        self._check_masses()
        found = ModuleSet(remarks=self.remarks)
        for part in self.made:
            found.modules += [self._module(part), *self._tips(part)]
        start, *others = (module.name for module in found.modules)
        found.families.append(Family(self.prefix, start, others))
        return found

    # --- From links to parts ----------------------------------------------------------------------

    def _part(self, wanted: str, parent: RigidPart | None) -> RigidPart:
        name = self.names.name(f"{self.prefix}_{_camel(wanted)}")
        part = RigidPart(name, parent)
        self.made.append(part)
        return part

    def _collect(self, part: RigidPart, link: str, entry: tuple[str, JointMotion] | None) -> None:
        """Add a link, and all that it carries, to a part and to new parts for moving joints."""
        frame = "in"
        if entry is not None:
            joint, motion = entry
            part.dofs += motion.dofs
            wanted = "turned" if motion.dofs[-1].kind == "revolute" else "moved"
            frame = part.frame(wanted, Placement("in", motion.steps))
            part.joint = joint
        moving = list[tuple[str, JointMotion]]()
        for each, own in self._held_together(part, link, frame, moving):
            part.take(each, own, self.parts)
        for joint, motion in moving:
            child = self.robot.joints[joint].child
            part.outputs[joint] = part.place_of(joint)
            self._collect(self._part(self._short(child), part), child, (joint, motion))

    def _held_together(
        self, part: RigidPart, link: str, frame: str, moving: list[tuple[str, JointMotion]]
    ) -> Iterator[tuple[str, str]]:
        """The links of a part with their frames; adds the joints that move to ``moving``."""
        due = [(link, frame)]
        while due:
            link, frame = due.pop(0)
            yield link, frame
            for joint in self.robot.below[link]:
                origin = self.robot.steps(self.robot.elements["joint", joint])
                motion = self.motions.of(joint)
                if motion.dofs:
                    part.places[joint] = Placement(frame, origin)
                    moving.append((joint, motion))
                else:
                    child = self.robot.joints[joint].child
                    steps = (*origin, *motion.steps)
                    due.append((child, part.frame(_snake(child, "link"), Placement(frame, steps))))

    def _short(self, link: str) -> str:
        """The name of a link without the name of the robot before it and `_link` after it."""
        plain = _snake(link, "link")
        begun = f"{_snake(self.robot.name, 'robot')}_"
        plain = plain.removeprefix(begun)
        shorter = plain.removesuffix("_link")
        return shorter or plain

    # --- Tips -------------------------------------------------------------------------------------

    def _add_tips(self) -> None:
        chosen = [*self.effectors]
        for link in chosen:
            if link not in self.robot.links:
                near = nearest(link, list(self.robot.links))
                hint = "" if near is None else f"; did you mean `{near}`?"
                raise UsageFault(f"--effector {link}: there is no link `{link}`{hint}")
        for link in chosen or self._usual_tips():
            part = next(each for each in self.made if link in each.links)
            part.tips[link] = Placement(part.links[link])

    def _usual_tips(self) -> list[str]:
        """The farthest end link that is only a frame; if there is none, all last links."""
        bare = [
            (part.depth, order, link)
            for part in self.made
            for order, link in enumerate(part.links)
            if part.moves and not self.robot.below[link] and part.is_bare(link)
        ]
        if bare:
            deepest = max(depth for depth, _, _ in bare)
            ends = [link for depth, _, link in bare if depth == deepest]
            chosen = min(ends, key=lambda link: (_rank(link), ends.index(link)))
            if len(ends) > 1:
                others = ", ".join(f"`{visible(link)}`" for link in ends if link != chosen)
                self.remarks.append(
                    f"the effector is at `{visible(chosen)}`; also {others} could be meant: "
                    "--effector LINK"
                )
            return [chosen]
        ends = [next(reversed(part.links)) for part in self.made if not part.outputs]
        return ends

    def _tips(self, part: RigidPart) -> Iterator[Module]:
        for link in part.tips:
            alone = sum(len(each.tips) for each in self.made) == 1
            name = "Tip" if alone else f"{self._short(link)}_tip"
            port = Port("in", self._type("link", link))
            yield Module(
                self.names.name(f"{self.prefix}_{_camel(name)}"),
                "effector",
                [port],
                effectors=[Placement("in")],
                comments=[f"The frame of link {visible(link)}."],
                named="" if link == next(iter(part.links)) else self._called(link),
            )

    # --- From parts to modules --------------------------------------------------------------------

    def _module(self, part: RigidPart) -> Module:
        ports = list[Port]()
        role: Role = "joint" if part.dofs else "base"
        if part.joint is not None:
            ports.append(Port("in", self._type("joint", part.joint)))
        leads = [("joint", *each) for each in part.outputs.items()]
        leads += [("link", *each) for each in part.tips.items()]
        for kind, lead, place in leads:
            name = "out" if len(leads) == 1 else part.names.name(f"to_{_snake(lead, kind)}")
            ports.append(Port(name, self._type(kind, lead)))
            part.named.append(Frame(name, place))
        part.inline({port.name for port in ports})
        links = ", ".join(part.called())
        many = "links" if len(part.links) > 1 else "link"
        said = f"{many} {links}"
        joint = "" if part.joint is None else f"joint {visible(part.joint)}; "
        said = f"{joint}{said}"
        return Module(
            part.name,
            role,
            ports,
            part.named,
            part.dofs,
            part.bodies,
            part.shapes,
            comments=[f"{said[0].upper()}{said[1:]}."],
            named=self._called(next(iter(part.links))),
        )

    def _called(self, link: str) -> str:
        """The name of a link as the part's name in exports."""
        if link == "world":  # in exports this is the frame in which all stand
            return ""
        if not in_quotes(link):
            self.remarks.append(f"link `{visible(link)}` cannot have this name in exports")
        return link

    def _type(self, kind: str, lead: str) -> str:
        """The type of the ports at a joint, or at the tip of a link; each has its own type."""
        key = (kind, lead)
        if key not in self.types:
            wanted = f"{self.prefix}_{_camel(_snake(lead, kind).removesuffix('_joint'))}"
            self.types[key] = self.type_names.name(wanted)
        return self.types[key]

    def _check_masses(self) -> None:
        """Reject a joint that moves no mass: it has no inertia, and needs no effort at all."""
        heavy = set[str]()
        for part in reversed(self.made):
            if part.name in heavy or any(body.mass > 0 for body in part.bodies):
                heavy.add(part.name)
                if part.parent is not None:
                    heavy.add(part.parent.name)
        for part in self.made:
            if part.joint is not None and part.name not in heavy:
                message = f"joint `{visible(part.joint)}` moves links without any mass"
                hint = f"give them one, use --density, or hold the joint: --fix {part.joint}"
                raise self.robot.fault("joint", part.joint, message, hint)


_LIKELY = ("tool0", "tcp", "tool", "grasp", "ee", "tip", "flange")


def _rank(link: str) -> int:
    """How unlikely an effector is at a link of this name, from 0."""
    words = re.split(r"[^a-z0-9]+", link.lower())
    return next((rank for rank, word in enumerate(_LIKELY) if word in words), len(_LIKELY))


def _snake(name: str, otherwise: str) -> str:
    return re.sub("_+", "_", legible(name, otherwise)) or "_"


def _camel(name: str) -> str:
    return "".join(word[:1].upper() + word[1:] for word in name.split("_")) or "Part"
