"""A design as a scene: the shapes of its links, their motion, and the regions around them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.rigid_links.link_shape import Geometry
from compiler.rigid_links.rigid_tree import FLAT
from compiler.tasks.obstacle_pieces import expanded
from compiler.workspaces.map_header import MapFault
from srgc.exports.exported_robot import ExportedRobot, exported_robot
from srgc.exports.scenes.fine_instants import FineInstants, fine_instants
from srgc.exports.scenes.link_motion import LinkMotion, Poses, link_motion, plain_pose
from srgc.exports.scenes.seen_meshes import SeenMesh, seen_meshes
from srgc.exports.scenes.triangles import Triangles, hull_triangles, shape_triangles
from srgc.faults import UsageFault
from srgc.render.workspace_drawing import WorkspaceShape, workspace_shapes
from srgc.results.found_design import FoundDesign

Colour: TypeAlias = tuple[int, int, int]
LINKS: tuple[Colour, ...] = ((70, 110, 170), (150, 170, 195))
"""The colours of links, used in turn."""
REGIONS: dict[str, Colour] = {
    "region": (70, 130, 180), "obstacle": (190, 70, 60), "target": (60, 150, 80),
}  # fmt: skip
SEEN_THROUGH = 0.35
"""The opacity of regions."""
FEW = 24
"""The number of instants at which the extent of shapes is computed."""
BENEATH = float(FLAT)
"""How far planar regions are below the robot, and how thick they are (m)."""


@dataclass(frozen=True, slots=True, eq=False)
class LinkShape:
    """A shape fixed to the link with this number, and its pose there."""

    link: int
    shape: Geometry
    pose: Poses

    @property
    def surface(self) -> Triangles:
        """The shape in the frame of its link."""
        found = shape_triangles(self.shape)
        return Triangles(self.pose.points(found.corners), found.faces)

    @property
    def outline(self) -> Array:
        """Points (m, 3) in the frame of the link whose hull contains the surface."""
        return self.surface.corners


@dataclass(frozen=True, slots=True, eq=False)
class SceneRegion:
    """A region, obstacle or target with its surface in the world; edges are pairs of corners."""

    kind: str
    name: str
    surface: Triangles
    corners: Array
    edges: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True, eq=False)
class DesignScene:
    """A moving robot among the regions of its task, in three dimensions.

    ``robot`` has the names of links, joints and effectors as in URDF.  ``shapes`` are the
    appearance of links without visuals, and ``bodies`` their collision shapes.  ``meshes`` are the
    visuals, except those that ``notes`` report as missing.
    """

    design: FoundDesign
    robot: ExportedRobot
    shapes: tuple[LinkShape, ...]
    bodies: tuple[LinkShape, ...]
    meshes: tuple[SeenMesh, ...]
    notes: tuple[str, ...]
    regions: tuple[SceneRegion, ...]
    instants: FineInstants
    motion: LinkMotion

    @property
    def times(self) -> tuple[Fraction, ...]:
        """The instants in seconds."""
        return self.instants.times

    @property
    def drawn(self) -> tuple[LinkShape | SeenMesh, ...]:
        """What is drawn: the visuals of links, or the shapes of links without visuals."""
        others = self.with_visuals
        return (*(shape for shape in self.shapes if shape.link not in others), *self.meshes)

    @property
    def with_visuals(self) -> frozenset[int]:
        """The links that are drawn by their visuals."""
        return frozenset(mesh.link for mesh in self.meshes)

    @property
    def bounds(self) -> Array:
        """The lower and upper corner (2, 3) of a box around the regions and the motion.

        The bounds of the workspace are ignored.  Shapes are evaluated at a few instants, frames at
        all.
        """
        links = self.motion.links
        points = [links.origins, self.motion.effectors.origins]
        points += [region.corners for region in self.regions]
        few = np.unique(np.linspace(0, len(self.times) - 1, FEW).astype(int))
        for each in self.drawn:
            placed = Poses(links.turns[few, each.link], links.origins[few, each.link])
            points.append(placed.points(each.outline))
        every = np.concatenate([each.reshape(-1, 3) for each in points])
        return np.stack([every.min(axis=0), every.max(axis=0)])


def design_scene(design: FoundDesign, frequency: int, *, visuals: bool = True) -> DesignScene:
    """The scene of a design.

    Args:
        design: the design.
        frequency: the least number of instants per second.
        visuals: whether to read its visuals.

    Raises:
        UsageFault: numbers are too large.
    """
    try:
        robot = exported_robot(design)
        links = robot.tree.links
        shapes = _placed(link.looks for link in links)
        bodies = _placed(link.collisions for link in links)
        seen = seen_meshes(robot.visuals if visuals else ())
    except ValueError as error:
        raise UsageFault(f"the robot cannot be shown: {error}") from None
    instants = fine_instants(design, frequency)
    motion = link_motion(robot.tree, instants.q)
    return DesignScene(
        design, robot, shapes, bodies, seen.meshes, seen.notes, scene_regions(design), instants,
        motion,
    )  # fmt: skip


def _placed(shapes: Iterable[Sequence[Geometry]]) -> tuple[LinkShape, ...]:
    """The shapes of links, given in one sequence for each link."""
    return tuple(
        LinkShape(number, shape, plain_pose(shape.pose))
        for number, of_link in enumerate(shapes)
        for shape in of_link
    )


def scene_regions(design: FoundDesign) -> tuple[SceneRegion, ...]:
    """The regions of a design's task except its bounds, with obstacles of maps as boxes.

    Raises:
        UsageFault: a map cannot be read.
    """
    try:
        program, task = expanded(design.program, design.task)
    except (MapFault, ValueError) as error:
        raise UsageFault(str(error)) from None
    shapes = workspace_shapes(program.workspaces[task.workspace], ())
    return tuple(_region(shape) for shape in shapes if shape.kind != "bounds")


def _region(shape: WorkspaceShape) -> SceneRegion:
    corners, edges = shape.corners, list(shape.edges)
    if corners.shape[1] == 2:
        corners, edges = _thick(corners, edges)
    return SceneRegion(shape.kind, shape.name, hull_triangles(corners), corners, tuple(edges))


def _thick(corners: Array, edges: list[tuple[int, int]]) -> tuple[Array, list[tuple[int, int]]]:
    """A planar region as a flat prism below the plane."""
    count = len(corners)
    layers = [np.column_stack([corners, np.full(count, z)]) for z in (-2 * BENEATH, -BENEATH)]
    upper = [(a + count, b + count) for a, b in edges]
    return np.concatenate(layers), [*edges, *upper, *((i, i + count) for i in range(count))]
