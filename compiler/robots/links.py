"""The links of a robot: the sets of frames between which there is no joint.

Two links may touch if one joint connects them, or if their joints sit at one frame of a third link.
Links without bodies, such as those between the axes of a wrist, are skipped.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from compiler.robots.robot import WORLD, FrameNode, Joint, Step


@dataclass(frozen=True, slots=True)
class Links:
    """The links of a robot, each named by its first frame.

    ``of`` maps each frame to its link.
    """

    frames: Sequence[FrameNode]
    of: Sequence[int]

    def touching(self, carrying: set[int]) -> set[tuple[int, int]]:
        """The pairs of links ``carrying`` bodies that may touch, the smaller number first.

        The path down from each link is followed through links without bodies to the first one that
        has some.
        """
        found = set[tuple[int, int]]()
        mounted: dict[tuple[int, tuple[Step, ...]], list[tuple[int, int]]] = {}
        for link in sorted(carrying - {WORLD}):
            above = below = link
            while below == link or (below not in carrying and below != WORLD):
                above, below = below, self.of[self.frames[below].parent]
                # The links on other joints at the same frame.
                beside = mounted.setdefault((below, self._mount(above)), [])
                found |= {(other, link) for joint, other in beside if joint != above}
                beside.append((above, link))
            if below in carrying:
                found.add((below, link))
        return found

    def _mount(self, link: int) -> tuple[Step, ...]:
        """Where the joint of a link sits in the link below it: the rigid steps to its frame."""
        steps, frame = list[Step](), self.frames[link].parent
        while frame != self.of[frame]:
            step = self.frames[frame].step
            if step is not None:
                steps.append(step)
            frame = self.frames[frame].parent
        return tuple(steps)


def links_of(frames: Sequence[FrameNode]) -> Links:
    """The links of a robot with these frames."""
    of = list[int]()
    for number, node in enumerate(frames):
        own = number == WORLD or isinstance(node.step, Joint)
        of.append(number if own else of[node.parent])
    return Links(frames, of)
