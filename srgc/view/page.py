"""The page: designs as a viser scene, with a slider for the time and other controls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import sin
from threading import RLock
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from compiler.arrays import Array
from srgc.exports.scenes.design_scene import BENEATH, LINKS, REGIONS, SEEN_THROUGH, DesignScene
from srgc.exports.scenes.link_motion import LinkMotion, link_motion
from srgc.exports.scenes.triangles import Triangles, hull_triangles
from srgc.report.motion_scene import TubeBoxes
from srgc.view.shown_designs import ShownDesign

if TYPE_CHECKING:
    import viser

TICK = 0.001
"""The step of the slider, in seconds."""
SPEEDS = ("0.1x", "0.25x", "0.5x", "1x", "2x", "4x")
EFFECTOR, TRACE, TUBE, BODY = (225, 0, 120), (225, 120, 170), (240, 160, 30), (130, 80, 180)
DOT, LINE = 0.012, 2.0
"""The size of an effector as a share of the scene, and the width of lines in pixels."""
FIELD_OF_VIEW = 0.8
"""The vertical field of view of the camera, in radians."""
FROM_ABOVE, FROM_ASIDE = (0.0, 0.0, 1.0), (0.62, -0.62, 0.48)
SHOWN = ("Links", "Collision bodies", "Regions", "Tube", "Path", "Names")
HIDDEN = ("Collision bodies",)
"""Parts that are hidden until the user shows them."""


@dataclass
class ViewPage:
    """A page with designs on a server, at a time between 0 and ``end`` seconds.

    ``show`` sets the time; ``tick`` advances it while the page plays.
    """

    server: viser.ViserServer
    designs: Sequence[ShownDesign]
    time: float = 0.0
    frames: list[dict[str, Any]] = field(default_factory=list)
    parts: dict[str, list[Any]] = field(default_factory=lambda: {name: [] for name in SHOWN})
    lock: RLock = field(default_factory=RLock)

    def __post_init__(self) -> None:
        self.server.gui.configure_theme(show_logo=False, show_share_button=False)
        self.server.scene.set_up_direction("+y" if self.flat else "+z")
        low, high = self._bounds()
        self.extent = float(np.linalg.norm(high - low)) or 1.0
        for number, design in enumerate(self.designs):
            self._draw(number, design)
        self._controls()
        self._camera((low + high) / 2)
        self.show(0.0)

    @property
    def flat(self) -> bool:
        """Whether all designs move in the plane."""
        return all(shown.scene.robot.tree.dimension == 2 for shown in self.designs)

    @property
    def end(self) -> float:
        """The end of the longest motion, in seconds."""
        return max(float(shown.scene.times[-1]) for shown in self.designs)

    def show(self, time: float) -> None:
        """Show all designs at a time in seconds; those whose motion has ended stay at its end."""
        with self.lock, self.server.atomic():
            self.time = min(max(time, 0.0), self.end)
            lines = [f"**t = {self.time:.3f} s**"]
            for shown, frames in zip(self.designs, self.frames, strict=True):
                scene = shown.scene
                motion = link_motion(scene.robot.tree, scene.instants.at(self.time))
                _place(frames, scene, motion)
                lines += _readings(shown, motion, self.time)
            self.text.content = "\n\n".join(lines)

    def tick(self, seconds: float) -> None:
        """Advance by this much real time if the page plays; it stops at the end."""
        if not self.playing:
            return
        time = self.time + seconds * float(self.speed.value.rstrip("x"))
        if time >= self.end:
            self._play(playing=False)
        # The slider's value is rounded, and the page shows the time that it says.
        self.slider.value = round(min(time, self.end) / TICK) * TICK
        self.show(time)

    # --- Drawing --------------------------------------------------------------------------------

    def _bounds(self) -> Array:
        every = np.stack([shown.bounds for shown in self.designs])
        found: Array = np.stack([every[:, 0].min(axis=0), every[:, 1].max(axis=0)])
        return found

    def _draw(self, number: int, shown: ShownDesign) -> None:
        scene, root = shown.scene, f"/{number + 1} {_plain(shown.label)}"
        add = self.server.scene
        add.add_frame(root, show_axes=False, position=shown.offset)
        links = [
            add.add_frame(f"{root}/robot/{_plain(name)}", show_axes=False)
            for name in scene.robot.names.links
        ]
        self._links(f"{root}/robot", scene)
        self._regions(root, scene)
        if shown.tube is not None:
            self._tube(f"{root}/tube", shown.tube)
        tools = []
        for index, name in enumerate(scene.robot.names.effectors):
            place = f"{root}/effectors/{_plain(name)}"
            tools.append(add.add_frame(place, show_axes=False))
            add.add_point_cloud(
                f"{place}/dot", np.zeros((1, 3), dtype=np.float32), EFFECTOR,
                point_size=DOT * self.extent, point_shape="circle", point_shading="flat",
                precision="float32",
            )  # fmt: skip
            self._trace(f"{root}/path/{_plain(name)}", scene.motion.effectors.origins[:, index])
        self.frames.append({"links": links, "effectors": tools})
        if len(self.designs) > 1:
            low, high = scene.bounds
            above = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2]])
            label = add.add_label(f"{root}/name", shown.label, position=above)
            self.parts["Names"].append(label)

    def _links(self, root: str, scene: DesignScene) -> None:
        """Draw links, and for a robot with visuals its collision shapes."""
        for index, each in enumerate(scene.drawn):
            name = f"{root}/{_plain(scene.robot.names.links[each.link])}/{index}"
            # It is not known which side of a visual is outside.
            side: Literal["front", "double"] = (
                "double" if each.link in scene.with_visuals else "front"
            )
            self._mesh("Links", name, each.surface, LINKS[each.link % len(LINKS)], side=side)
        for index, body in enumerate(scene.bodies if scene.meshes else ()):
            name = f"{root}/{_plain(scene.robot.names.links[body.link])}/body_{index}"
            self._mesh("Collision bodies", name, body.surface, BODY, SEEN_THROUGH)

    def _mesh(
        self, part: str, name: str, surface: Triangles, colour: Any, opacity: float | None = None,
        side: Literal["front", "back", "double"] = "front",
    ) -> None:  # fmt: skip
        if not len(surface.faces):
            return
        # Transparent meshes are drawn from far to near, ordered by their positions.
        middle = surface.corners.mean(axis=0)
        handle = self.server.scene.add_mesh_simple(
            name, (surface.corners - middle).astype(np.float32), surface.faces.astype(np.uint32),
            color=colour, opacity=opacity, flat_shading=True, side=side,
            cast_shadow=opacity is None, position=middle, visible=part not in HIDDEN,
        )  # fmt: skip
        self.parts[part].append(handle)

    def _regions(self, root: str, scene: DesignScene) -> None:
        for index, region in enumerate(scene.regions):
            name = f"{root}/regions/{_plain(region.name)}_{index}"
            colour = REGIONS.get(region.kind, REGIONS["region"])
            # For sets that contain the robot draw only the far walls, or they would hide it.
            side: Literal["back", "double"] = "double" if region.kind == "obstacle" else "back"
            self._mesh("Regions", name, region.surface, colour, SEEN_THROUGH, side)
            if region.edges:
                self._lines("Regions", f"{name}_edges", region.corners[np.array(region.edges)],
                            colour, 1.0)  # fmt: skip

    def _tube(self, name: str, tube: TubeBoxes) -> None:
        """Draw all boxes, each as a translated and scaled cube."""
        boxes = tube.boxes.reshape(-1, *tube.boxes.shape[2:])
        if boxes.shape[1] == 2:
            beneath = np.broadcast_to(np.array([-BENEATH, BENEATH]) / 2, (len(boxes), 1, 2))
            boxes = np.concatenate([boxes, beneath], axis=1)
        cube = hull_triangles(np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5)
                                        for z in (-0.5, 0.5)]))  # fmt: skip
        turns = np.tile(np.array([1.0, 0.0, 0.0, 0.0]), (len(boxes), 1))
        handle = self.server.scene.add_batched_meshes_simple(
            name, cube.corners.astype(np.float32), cube.faces.astype(np.uint32), turns,
            boxes.mean(axis=2), batched_scales=boxes[..., 1] - boxes[..., 0],
            batched_colors=TUBE, opacity=SEEN_THROUGH, side="double", lod="off",
            cast_shadow=False,
        )  # fmt: skip
        self.parts["Tube"].append(handle)

    def _trace(self, name: str, points: Array) -> None:
        if len(points) > 1:
            self._lines("Path", name, np.stack([points[:-1], points[1:]], axis=1), TRACE, LINE)

    def _lines(self, part: str, name: str, ends: Array, colour: Any, width: float) -> None:
        handle = self.server.scene.add_line_segments(
            name, ends.astype(np.float32), colour, thickness=width, thickness_units="screen"
        )
        self.parts[part].append(handle)

    # --- Controls -------------------------------------------------------------------------------

    def _controls(self) -> None:
        gui = self.server.gui
        self.playing = False
        ticks = max(round(self.end / TICK), 1)
        self.slider: Any = gui.add_slider("Time (s)", 0.0, ticks * TICK, TICK, 0.0)
        self.slider.on_update(lambda _: self._seek())
        self.button = gui.add_button("Play")
        self.button.on_click(lambda _: self._play(playing=not self.playing))
        self.speed = gui.add_dropdown("Speed", SPEEDS, initial_value="1x")
        for part in SHOWN:
            if self.parts[part]:
                self._choice(part)
        self.text = gui.add_markdown("")

    def _choice(self, part: str) -> None:
        box = self.server.gui.add_checkbox(part, initial_value=part not in HIDDEN)
        box.on_update(lambda _: self._hide(part, visible=box.value))

    def _hide(self, part: str, *, visible: bool) -> None:
        for handle in self.parts[part]:
            handle.visible = visible

    def _seek(self) -> None:
        """Follow the slider if the user moved it, but not if playing moved it."""
        if abs(self.slider.value - self.time) > TICK:
            self.show(self.slider.value)

    def _play(self, *, playing: bool) -> None:
        if playing and self.time >= self.end:
            self.show(0.0)
        self.playing = playing
        self.button.label = "Pause" if playing else "Play"

    def _camera(self, centre: Array) -> None:
        """Set the initial camera to show everything, from above if all designs are planar."""
        way = np.array(FROM_ABOVE if self.flat else FROM_ASIDE)
        distance = self.extent / 2 / sin(FIELD_OF_VIEW / 2)
        first = self.server.initial_camera
        first.fov = FIELD_OF_VIEW
        first.up = (0.0, 1.0, 0.0) if self.flat else (0.0, 0.0, 1.0)
        first.look_at = tuple(centre.tolist())
        first.position = tuple((centre + distance * way / np.linalg.norm(way)).tolist())


def _place(frames: dict[str, Any], scene: DesignScene, motion: LinkMotion) -> None:
    for kind, poses in (("links", motion.links), ("effectors", motion.effectors)):
        turns = poses.quaternions()
        for number, frame in enumerate(frames[kind]):
            frame.wxyz, frame.position = turns[0, number], poses.origins[0, number]


def _readings(shown: ShownDesign, motion: LinkMotion, time: float) -> list[str]:
    """The positions of a design's effectors in its own coordinates."""
    scene, lines = shown.scene, list[str]()
    for number, name in enumerate(scene.robot.names.effectors):
        place = motion.effectors.origins[0, number, : scene.robot.tree.dimension]
        where = ", ".join(f"{value:.4f}" for value in place)
        lines.append(f"{shown.label}, `{name}`: ({where}) m")
    tube = shown.tube
    if tube is not None:
        at = int(np.argmin(np.abs(tube.instants - time)))
        lines.append(f"tube here: {2 * tube.half_widths[at].max():.2g} m wide")
    return lines


def _plain(name: str) -> str:
    """A name without the separator of levels in a scene."""
    return name.replace("/", "_")
