"""Make one module from a URDF: its links are frames, and named links are its ports."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, cast

from grammar_lang.diagnostics.wording import nearest
from grammar_lang.files.file_tree import visible
from grammar_lang.parsing.tables import RESERVED
from srgc.faults import UsageFault
from srgc.imports.module_set import Frame, Module, ModuleSet, Motion, Placement, Port, Role
from srgc.imports.names import Names, is_legible, legible
from srgc.imports.urdf.joint_motion import JointMotion, JointMotions
from srgc.imports.urdf.link_parts import LinkParts
from srgc.imports.urdf.rigid_part import MEMBERS, RigidPart
from srgc.imports.urdf.robot_model import UrdfRobot

FORM = "write NAME=LINK:TYPE, as in in=base_link:Flange:male"
USUAL = "Flange"
"""The default type of ports."""

Gender = Literal["male", "female"]
_PORT = re.compile(r"([A-Za-z_]\w*)=([^:]+):([A-Za-z_]\w*)(?::(male|female))?", re.ASCII)


@dataclass(frozen=True, slots=True)
class _Said:
    """A port as given on the command line."""

    name: str
    link: str
    type: str
    gender: Gender | None


@dataclass(slots=True)
class SingleModule:
    """Makes one module from a URDF.

    Without ``ports`` the root link is ``in``, and every end link that is only a frame is an output;
    all have the type :data:`USUAL`.
    """

    robot: UrdfRobot
    parts: LinkParts
    motions: JointMotions
    name: str
    remarks: list[str]
    ports: Sequence[str] = ()
    names: Names = field(default_factory=lambda: Names(MEMBERS))

    def module_set(self) -> ModuleSet:
        """The module, without a grammar.

        Raises:
            UsageFault: a port is malformed or names no link, or ``in`` is not at the root.
        """
        said = [_port(text, self.robot) for text in self.ports]
        self._check_ports(said)
        part = RigidPart(self.name, None, names=self.names)
        self._collect(part, {each.link: each.name for each in said if each.name != "in"})
        if said and all(each.name != "in" for each in said):
            self._without_input(said, moves=bool(part.dofs))
        said = said or list(self._usual(part))
        part.named += [
            Frame(each.name, Placement(part.links[each.link]))
            for each in said
            if each.name != "in" and part.links[each.link] != each.name
        ]
        last = next(reversed(part.links.values()))
        part.inline({last, *(each.name for each in said)})
        inside = any(each.name == "in" for each in said)
        outputs = any(each.name != "in" for each in said)
        role: Role = "joint" if part.dofs else "link" if inside else "base"
        module = Module(
            self.name,
            role if outputs or part.dofs or not inside else "effector",
            [Port(each.name, each.type, each.gender) for each in said],
            part.named,
            part.dofs,
            part.bodies,
            part.shapes,
            effectors=[] if outputs else [Placement(last)],
            comments=[f"Links {', '.join(part.called())}."],
        )
        return ModuleSet(modules=[module], remarks=self.remarks)

    def _check_ports(self, said: Sequence[_Said]) -> None:
        for number, each in enumerate(said):
            if any(each.name == other.name for other in said[:number]):
                raise UsageFault(f"--port {each.name}: there are two ports of that name")
            if each.name == "in" and each.link != self.robot.root:
                raise UsageFault(
                    f"--port in={each.link}: `in` is where a module stands, and that is its root "
                    f"link `{self.robot.root}`"
                )

    def _without_input(self, said: Sequence[_Said], *, moves: bool) -> None:
        """Add a remark that a module without a port ``in`` is a base, which stands on the ground.

        Raises:
            UsageFault: the module has joints, so it cannot be a base.
        """
        root = self.robot.root
        if not moves:
            self.remarks.append(
                f"no port is called `in`: this is a base, which no module carries; "
                f"--port in={visible(root)}:TYPE makes it one that is carried"
            )
            return
        there = next((each for each in said if each.link == root), None)
        message = "--port: none is called `in`, by which a module with joints is carried"
        if there is not None:
            raise UsageFault(f"{message}; `{there.name}` is at the root link: call it `in`")
        raise UsageFault(f"{message}; add --port in={visible(root)}:{USUAL}")

    def _usual(self, part: RigidPart) -> Iterator[_Said]:
        """Default ports: the root, and end links that are only frames."""
        yield _Said("in", self.robot.root, USUAL, None)
        ends = [
            link
            for link in part.links
            if link != self.robot.root and not self.robot.below[link] and part.is_bare(link)
        ]
        for link in ends:
            frame = part.links[link]
            wanted = "out" if len(ends) == 1 else _word(link, "link")
            name = frame if frame == wanted != "in" else self.names.name(wanted)
            yield _Said(name, link, USUAL, None)
        if not ends:
            self.remarks.append(
                "no link is nothing but a frame, which would be an output: --port out=LINK:TYPE"
            )

    def _collect(self, part: RigidPart, outputs: dict[str, str]) -> None:
        """Add all links, beginning with the root; degrees of freedom get unique names."""
        for output in outputs.values():
            self.names.take(output)
        due = [(self.robot.root, "in")]
        while due:
            link, frame = due.pop(0)
            part.take(link, frame, self.parts)
            for joint in self.robot.below[link]:
                child = self.robot.joints[joint].child
                origin = self.robot.steps(self.robot.elements["joint", joint])
                motion = self._named(self.motions.of(joint), joint)
                part.dofs += motion.dofs
                place = Placement(frame, (*origin, *motion.steps))
                if child in outputs:
                    part.named.append(Frame(outputs[child], place))
                    due.append((child, outputs[child]))
                else:
                    due.append((child, part.frame(_word(child, "link"), place)))

    def _named(self, motion: JointMotion, joint: str) -> JointMotion:
        """The motion with degrees of freedom named after their joint, if several joints move."""
        moving = sum(each.type not in ("fixed", "floating") for each in self.robot.joints.values())
        if moving <= 1:
            return motion
        short = _word(joint, "joint").removesuffix("_joint")
        names = {
            dof.name: self.names.name(short if len(motion.dofs) == 1 else f"{short}_{dof.name}")
            for dof in motion.dofs
        }
        steps = tuple(
            Motion(names[step.dof]) if isinstance(step, Motion) else step for step in motion.steps
        )
        comment = "" if is_legible(joint) else f"joint {visible(joint)}"
        return JointMotion(
            tuple(replace(dof, name=names[dof.name], comment=comment) for dof in motion.dofs), steps
        )


def _port(text: str, robot: UrdfRobot) -> _Said:
    """Parse a port ``NAME=LINK:TYPE`` or ``NAME=LINK:TYPE:GENDER``."""
    known = _PORT.fullmatch(text)
    if known is None:
        raise UsageFault(f"--port {text}: {FORM}")
    name, link, kind, gender = known.groups()
    for word in (name, kind):
        if word in RESERVED:
            raise UsageFault(f"--port {text}: `{word}` is a word of the language")
    if link not in robot.links:
        near = nearest(link, list(robot.links))
        hint = "" if near is None else f"; did you mean `{near}`?"
        raise UsageFault(f"--port {text}: there is no link `{link}`{hint}")
    return _Said(name, link, kind, cast("Gender | None", gender))


def _word(name: str, otherwise: str) -> str:
    return re.sub("_+", "_", legible(name, otherwise)) or "_"
