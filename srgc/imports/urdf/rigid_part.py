"""Links that move as one body: what they have, in frames with names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace

from grammar_lang.files.file_tree import visible
from srgc.imports.module_set import (
    Body,
    Dof,
    Frame,
    Motion,
    Placement,
    Shape,
    acts,
    joined,
)
from srgc.imports.names import Names, is_legible
from srgc.imports.urdf.link_parts import LinkParts

MEMBERS = ("in", "out", "q", "s", "sx", "sy")
"""Names that modules have for other things than links."""
MOVED = ("turned", "moved")
"""Frames of links that joints carry."""


@dataclass(slots=True)
class RigidPart:
    """A module that is being made.

    Attributes:
        name: of the module.
        parent: the part that carries it, None of the base.
        joint: the joint by which it is carried.
        links: by link the name of its frame.
        places: where joints that leave it begin.
        outputs: those that lead to other parts.
        tips: where effectors are, by link.
        named: its frames, in order; others build on those before them.
        bodies, shapes: of all links.
    """

    name: str
    parent: RigidPart | None
    joint: str | None = None
    dofs: list[Dof] = field(default_factory=list)
    links: dict[str, str] = field(default_factory=dict)
    places: dict[str, Placement] = field(default_factory=dict)
    outputs: dict[str, Placement] = field(default_factory=dict)
    tips: dict[str, Placement] = field(default_factory=dict)
    named: list[Frame] = field(default_factory=list)
    bodies: list[Body] = field(default_factory=list)
    shapes: list[Shape] = field(default_factory=list)
    full: set[str] = field(default_factory=set)
    names: Names = field(default_factory=lambda: Names(MEMBERS))

    @property
    def depth(self) -> int:
        """How many degrees of freedom lead to it."""
        return len(self.dofs) + (0 if self.parent is None else self.parent.depth)

    @property
    def moves(self) -> bool:
        """Whether anything moves it."""
        return self.depth > 0

    def is_bare(self, link: str) -> bool:
        """Whether a link is nothing but a frame."""
        return link not in self.full

    def place_of(self, joint: str) -> Placement:
        """Where a joint that leaves the part begins."""
        return self.places[joint]

    def called(self) -> Iterator[str]:
        """The links as the file calls them, with their frames where that is not plain to see."""
        named = {frame.name for frame in self.named}
        for link, frame in self.links.items():
            shown = frame in named and frame not in MOVED and not is_legible(link)
            yield f"{visible(link)} (`{frame}`)" if shown else visible(link)

    def frame(self, wanted: str, place: Placement) -> str:
        """The name of a frame; that of its base where it is the same frame."""
        if not any(map(acts, place.steps)):
            return place.base
        name = self.names.name(wanted)
        self.named.append(Frame(name, place))
        return name

    def take(self, link: str, frame: str, parts: LinkParts) -> None:
        """Take what a link has."""
        self.links[link] = frame
        bodies, shapes = [*parts.bodies(link, frame)], [*parts.shapes(link, frame)]
        if bodies or shapes:
            self.full.add(link)
        self.bodies += bodies
        self.shapes += shapes

    # --- Frames that are used once need no name ---------------------------------------------------

    def inline(self, ports: Collection[str]) -> None:
        """Write frames where they are used, those used once; leave out those never used.

        Those of ``ports`` are kept.
        """
        while True:
            uses = Counter(place.base for place in self._placements())
            once = next(
                (
                    frame
                    for frame in self.named
                    if frame.name not in ports and self._spare(frame, uses[frame.name])
                ),
                None,
            )
            if once is None:
                return
            self.named.remove(once)
            self._replace(once)

    @staticmethod
    def _spare(frame: Frame, uses: int) -> bool:
        """Whether a frame needs no name; one with a motion keeps it, as people write it."""
        moves = any(isinstance(step, Motion) for step in frame.place.steps)
        return uses <= 1 and not moves

    def _placements(self) -> Iterator[Placement]:
        yield from (frame.place for frame in self.named)
        yield from (body.place for body in self.bodies)
        yield from (shape.place for shape in self.shapes)

    def _replace(self, old: Frame) -> None:
        def put(place: Placement) -> Placement:
            if place.base != old.name:
                return place
            return Placement(old.place.base, joined(old.place.steps, place.steps))

        self.named = [Frame(frame.name, put(frame.place)) for frame in self.named]
        self.bodies = [replace(body, place=put(body.place)) for body in self.bodies]
        self.shapes = [replace(shape, place=put(shape.place)) for shape in self.shapes]
