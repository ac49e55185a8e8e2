"""Links that move as one body: their bodies and shapes, with named frames."""

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
"""Names that modules use for things other than links."""
MOVED = ("turned", "moved")
"""Names of the frames of links that a joint moves."""


@dataclass(slots=True)
class RigidPart:
    """A module under construction.

    Attributes:
        name: the name of the module.
        parent: the part that carries it; None for the base.
        joint: the joint by which it is carried.
        links: maps each link to the name of its frame.
        places: maps each moving joint that leaves the part to the place where it begins.
        outputs: the places of the joints that lead to other parts.
        tips: maps links to the places of their effectors.
        named: its frames, in order; a frame may build on those before it.
        bodies, shapes: those of all links.
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
        """The number of degrees of freedom between the ground and the part."""
        return len(self.dofs) + (0 if self.parent is None else self.parent.depth)

    @property
    def moves(self) -> bool:
        """Whether a degree of freedom moves the part."""
        return self.depth > 0

    def is_bare(self, link: str) -> bool:
        """Whether a link is only a frame, without bodies and shapes."""
        return link not in self.full

    def place_of(self, joint: str) -> Placement:
        """The place where a joint that leaves the part begins."""
        return self.places[joint]

    def called(self) -> Iterator[str]:
        """The links by their names in the file, with their frames if these are not recognisable."""
        named = {frame.name for frame in self.named}
        for link, frame in self.links.items():
            shown = frame in named and frame not in MOVED and not is_legible(link)
            yield f"{visible(link)} (`{frame}`)" if shown else visible(link)

    def frame(self, wanted: str, place: Placement) -> str:
        """Add a frame and return its name; if it equals its base, return the name of the base."""
        if not any(map(acts, place.steps)):
            return place.base
        name = self.names.name(wanted)
        self.named.append(Frame(name, place))
        return name

    def take(self, link: str, frame: str, parts: LinkParts) -> None:
        """Add a link with its bodies and shapes."""
        self.links[link] = frame
        bodies, shapes = [*parts.bodies(link, frame)], [*parts.shapes(link, frame)]
        if bodies or shapes:
            self.full.add(link)
        self.bodies += bodies
        self.shapes += shapes

    # --- Frames used only once need no name -------------------------------------------------------

    def inline(self, ports: Collection[str]) -> None:
        """Inline frames that are used once and remove unused ones, but keep those of ``ports``."""
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
        """Whether a frame can do without a name; one with a motion keeps it, for legibility."""
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
