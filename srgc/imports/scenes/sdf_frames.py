"""Resolve the poses of SDF frames: models, links, joints and frames, by their names.

Source: the SDFormat specification 1.11, *Pose frame semantics*.  A name is valid within its model;
`A::b` is `b` in the model `A`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from srgc.imports.plain_numbers import plain_number
from srgc.imports.scenes.scene import Pose, angle_pose, quaternion_pose
from srgc.imports.source_fault import SourceFault
from srgc.imports.xml_source import Element, XmlFile

LONGEST = 100
"""The longest chain of poses that are relative to one another."""


@dataclass(slots=True, eq=False)
class Scope:
    """A world, a model or the root of a file, with the frames that poses in it can name.

    ``include`` is the element that included a model; ``missing`` lists includes that were not
    found.  ``begun`` lists the poses being resolved, and is shared by all scopes.
    """

    element: Element
    file: XmlFile
    folder: Path
    name: str = ""
    parent: Scope | None = None
    include: Element | None = None
    children: list[Scope] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    begun: list[tuple[Element, str]] = field(default_factory=list)
    _named: dict[str, Element | Scope] | None = None
    _poses: dict[Element, Pose] = field(default_factory=dict)
    _place: Pose | None = None

    def __post_init__(self) -> None:
        if self.parent is not None:
            self.begun = self.parent.begun

    @property
    def whole(self) -> str:
        """The names of the enclosing models and its own, joined."""
        outer = "" if self.parent is None else self.parent.whole
        return "_".join(filter(None, (outer, self.name)))

    @property
    def merged(self) -> bool:
        """Whether its contents count as part of the model that includes it."""
        return self.include is not None and is_true(self.include.get("merge"))

    def in_world(self) -> Pose:
        """The pose of the origin in the world.

        Raises:
            SourceFault: a pose names an unknown frame, or depends on itself.
        """
        return Pose() if self.parent is None else self.parent.in_world().then(self.place())

    def place(self) -> Pose:
        """The pose of the origin in the enclosing scope; the file may place another frame instead.

        Raises:
            SourceFault: see :meth:`in_world`.
        """
        if self._place is None:
            self._place = Pose() if self.parent is None else self._placed_in(self.parent)
        return self._place

    def of(self, name: str) -> Pose | None:
        """The pose in this scope of a named frame; None if there is no frame of this name.

        Raises:
            SourceFault: see :meth:`in_world`.
        """
        if name in {"", "__model__"}:
            return Pose()
        if name == "world":
            return self.in_world().inverse()
        found = self._known().get(name)
        if isinstance(found, Scope):
            return found.place()
        return self._within(name) if found is None else self.placed(found)

    def placed(self, element: Element) -> Pose:
        """The pose in this scope of one of its links, joints or frames.

        Raises:
            SourceFault: see :meth:`in_world`.
        """
        if element not in self._poses:
            self._begin(element, self.file, element.get("name", ""))
            self._poses[element] = self._posed(element, self.file)
            self.begun.pop()
        return self._poses[element]

    def inside(self, element: Element, base: Pose) -> Pose:
        """The pose in this scope of a part of a link whose pose is ``base``.

        Raises:
            SourceFault: see :meth:`in_world`.
        """
        pose = element.find("pose")
        if pose is None:
            return base
        relative = _relative(pose)
        if relative:
            base = self._named_by(relative, pose, self.file)
        return base.then(_pose(pose, self.file))

    def _placed_in(self, outer: Scope) -> Pose:
        frame = (self.element.get("placement_frame") or "").strip()
        by, file = self.element, self.file
        if self.include is not None and self.include.find("pose") is not None:
            by, file = self.include, outer.file
        own = None if self.include is None else self.include.find("placement_frame")
        if own is not None:
            if by is not self.include:
                raise outer.file.fault(
                    own, "a placement frame is expected with a pose, which places it"
                )
            frame = (own.text or "").strip()
        self._begin(by, file, self.name)
        given = outer._posed(by, file)
        if frame:
            at = self.of(frame)
            if at is None:
                said = f"its placement frame `{frame}` is not a frame of the model `{self.name}`"
                raise file.fault(by if own is None else own, said, self._hint())
            given = given.then(at.inverse())
        self.begun.pop()
        return given

    def _posed(self, element: Element, file: XmlFile) -> Pose:
        pose = element.find("pose")
        relative, by = ("", element) if pose is None else (_relative(pose), pose)
        if not relative:
            relative, by = _default(element, file), element
        base = self._named_by(relative, by, file)
        return base if pose is None else base.then(_pose(pose, file))

    def _named_by(self, name: str, by: Element, file: XmlFile) -> Pose:
        found = self.of(name)
        if found is None:
            raise file.fault(by, f"`{name}` is not a known frame", self._hint())
        return found

    def _hint(self) -> str | None:
        return "; ".join(self.missing[:3]) or None

    def _known(self) -> dict[str, Element | Scope]:
        """The parts by name; links take precedence over models, these over frames, then joints."""
        if self._named is None:
            self._named = {}
            for tag in ("joint", "frame"):
                self._named |= {each.get("name", ""): each for each in self.element.findall(tag)}
            self._named |= {each.name: each for each in self.children}
            self._named |= {each.get("name", ""): each for each in self.element.findall("link")}
        return self._named

    def _within(self, name: str) -> Pose | None:
        """The pose of a frame in a model nested in this one or merged into it."""
        model, _, rest = name.partition("::")
        child = self._known().get(model)
        tried = [(child, rest)] if isinstance(child, Scope) and rest else []
        tried += [(each, name) for each in self.children if each.merged]
        for each, called in tried:
            inner = each.of(called)
            if inner is not None:
                return each.place().then(inner)
        return None

    def _begin(self, element: Element, file: XmlFile, name: str) -> None:
        """Record that a pose is being resolved, to detect one that depends on itself.

        Raises:
            SourceFault: it does, or it depends on too many others.
        """
        before = [each for each, _ in self.begun]
        if element in before:
            names = [each for _, each in self.begun[before.index(element) :]]
            shown = ", ".join(f"`{each}`" for each in (*names[:10], name))
            raise file.fault(element, f"poses are relative to one another in a circle: {shown}")
        if len(before) >= LONGEST:
            raise file.fault(element, f"more than {LONGEST} poses are relative one to the next")
        self.begun.append((element, name))


def is_true(text: str | None) -> bool:
    """Whether a text means true in SDF."""
    return (text or "").strip().lower() in {"true", "1"}


def _relative(pose: Element) -> str:
    return (pose.get("relative_to") or pose.get("frame") or "").strip()


def _default(element: Element, file: XmlFile) -> str:
    """The frame that a pose without ``relative_to`` is relative to.

    Raises:
        SourceFault: a joint has no child.
    """
    if element.tag == "frame":
        return (element.get("attached_to") or "").strip()
    if element.tag != "joint":
        return ""
    child = (element.findtext("child") or "").strip()
    if not child:
        raise file.fault(element, "a joint that others are relative to has no child link")
    return child


def _pose(pose: Element, file: XmlFile) -> Pose:
    fault = partial(_pose_fault, file, pose)
    try:
        words = (pose.text or "").split()
        numbers = [plain_number(word) for word in words]
    except ValueError:
        raise fault("its pose is not a list of numbers") from None
    if not numbers:
        return Pose()
    if pose.get("rotation_format") == "quat_xyzw" and len(numbers) == 7:
        return quaternion_pose(numbers[:3], numbers[3:], fault, words[:3])
    if len(numbers) != 6:
        raise fault(f"its pose has {len(numbers)} numbers, and 6 are expected")
    angles = numbers[3:]
    if is_true(pose.get("degrees")):
        angles = [math.radians(angle) for angle in angles]
    return angle_pose(numbers[:3], angles, fault, words[:3])


def _pose_fault(file: XmlFile, pose: Element, said: str) -> SourceFault:
    return file.fault(pose, said)
