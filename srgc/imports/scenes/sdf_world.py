"""Worlds and models of SDF (Gazebo): links, collisions, nested models and includes.

Source: the SDFormat specification 1.11 (sdformat.org/spec).  What collides is carried over; what
has no bounds or no shape is listed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from srgc.imports.scenes.scene import (
    Pose,
    Scene,
    SceneObject,
    angle_pose,
    quaternion_pose,
)
from srgc.imports.scenes.sdf_geometry import Geometries
from srgc.imports.source_fault import SourceFault
from srgc.imports.source_files import SourceFiles, source_bytes
from srgc.imports.xml_source import Element, XmlFile, xml_file

PASSED = frozenset(
    {"pose", "static", "link", "model", "include", "frame", "name", "self_collide", "enable_wind"}
    | {"kinematic", "allow_auto_disable", "uri", "placement_frame"}
)
"""Elements of a model that are carried over, or say nothing about where it is."""
MOST_INCLUDES, DEEPEST = 1000, 20


@dataclass(slots=True)
class _Place:
    """A scope: where it stands, the poses of its frames in the world, and those not yet known."""

    prefix: str
    pose: Pose
    frames: dict[str, Pose] = field(default_factory=dict)
    pending: dict[str, tuple[Element, str]] = field(default_factory=dict)

    def declare(self, elements: Sequence[Element], attribute: str = "") -> None:
        """Elements that poses may be relative to, before or behind them."""
        self.pending.update({each.get("name", ""): (each, attribute) for each in elements})


class _Reader:
    def __init__(self, scene: Scene, files: SourceFiles, file: XmlFile) -> None:
        self.scene, self.files, self.file = scene, files, file
        self.geometries = Geometries(scene, files)
        self.includes = 0

    def world(self, world: Element) -> None:
        place = _Place("", Pose())
        shapeless = dict[str, int]()
        for element in world:
            tag = _tag(element)
            if tag in {"model", "include", "frame"}:
                continue
            if tag in {"plugin", "joint"}:
                self.scene.dropped.append(f"{tag} {element.get('name', '')}".strip())
            else:
                shapeless[tag] = shapeless.get(tag, 0) + 1
        if shapeless:
            self.scene.dropped.append(f"of the world: {', '.join(shapeless)}")
        self.models(world, place, 0)

    def models(self, parent: Element, place: _Place, depth: int) -> None:
        """The models and includes of a world or model; frames first, since these refer to them."""
        if depth > DEEPEST:
            raise self.file.fault(parent, f"models are nested more than {DEEPEST} deep")
        models = parent.findall("model")
        place.declare(parent.findall("frame"), "attached_to")
        place.declare(models)
        for model in models:
            pose = self.frame(model.get("name", ""), place) or place.pose
            self.model(model, place, pose, depth)
        for include in parent.findall("include"):
            self.include(include, place, depth)

    def model(
        self, model: Element, outer: _Place, pose: Pose, depth: int, called: str = ""
    ) -> None:
        name = called or model.get("name") or "model"
        whole = f"{outer.prefix}{name}"
        place = _Place(f"{whole}_", pose, {"__model__": pose})
        self.listed(model, whole, depth)
        links = model.findall("link")
        place.declare(links)
        place.declare(model.findall("frame"), "attached_to")
        place.declare(model.findall("model"))
        for link in links:
            self.link(link, place, whole, alone=len(links) == 1)
        self.models(model, place, depth + 1)

    def listed(self, model: Element, whole: str, depth: int) -> None:
        """What of a model is not carried over."""
        static = (model.findtext("static") or "false").strip().lower() in {"true", "1"}
        if not static and depth == 0:
            self.scene.dropped.append(f"{whole} may move: it is an obstacle where it stands")
        for element in model:
            tag = _tag(element)
            if tag in {"joint", "plugin", "gripper"}:
                self.scene.dropped.append(f"{whole}: {tag} {element.get('name', '')}".rstrip())
            elif tag not in PASSED:
                self.scene.dropped.append(f"{whole}: {tag}")

    def link(self, link: Element, place: _Place, whole: str, *, alone: bool) -> None:
        base = self.frame(link.get("name", ""), place) or place.pose
        called = whole if alone else f"{place.prefix}{link.get('name', 'link')}"
        collisions = link.findall("collision")
        if not collisions and link.find("visual") is not None:
            self.scene.dropped.append(f"{called}: it is seen and does not collide")
        for each in link:
            if _tag(each) in {"sensor", "light", "projector", "particle_emitter"}:
                self.scene.dropped.append(f"{called}: {_tag(each)} {each.get('name', '')}".rstrip())
        for collision in collisions:
            own = collision.get("name") or "collision"
            name = called if len(collisions) == 1 else f"{called}_{own}"
            inner = _Place(place.prefix, base, place.frames, place.pending)
            pose = self.placed(collision, inner)
            shapes = self.geometries.of(collision.find("geometry"), name, pose, self.file)
            for shape, shift, note in shapes:
                self.scene.objects.append(SceneObject(name, shape, pose.then(shift), note))

    def include(self, include: Element, place: _Place, depth: int) -> None:
        uri = (include.findtext("uri") or "").strip()
        self.includes += 1
        if self.includes > MOST_INCLUDES:
            raise self.file.fault(include, f"there are more than {MOST_INCLUDES} includes")
        try:
            path = self.files.path_of(uri if Path(uri).suffix else f"{uri.rstrip('/')}/model.sdf")
        except SourceFault as fault:
            said = "; ".join(filter(None, (fault.message, fault.hint)))
            self.scene.dropped.append(f"include {uri or '(without an address)'}: {said}")
            return
        file = xml_file(source_bytes(path), path)
        model = file.root.find("model")
        if model is None:
            self.scene.dropped.append(f"include {uri}: {path.name} has no model")
            return
        within = place if include.find("pose") is not None else None
        pose = self.placed(include, place) if within else None
        called = (include.findtext("name") or "").strip()
        outer = self.geometries.folder, self.file
        self.geometries.folder, self.file = path.parent, file
        pose = self.placed(model, place) if pose is None else pose
        self.model(model, place, pose, depth + 1, called)
        self.geometries.folder, self.file = outer

    def placed(self, element: Element, place: _Place, attribute: str = "") -> Pose:
        """The pose in the world of an element of a scope."""
        pose = element.find("pose")
        base = place.pose
        relative = (element.get(attribute) if attribute else None) or ""
        if pose is not None:
            relative = pose.get("relative_to") or pose.get("frame") or relative
        if relative and relative != "world":
            found = self.frame(relative, place)
            if found is None:
                self.scene.dropped.append(
                    f"{place.prefix}{element.get('name', '')}: its pose is relative to "
                    f"`{relative}`, which is not known here; it is taken as one of its parent"
                )
            base = found or base
        elif relative == "world":
            base = Pose()
        return base if pose is None else base.then(self.pose(pose))

    def frame(self, name: str, place: _Place) -> Pose | None:
        """The pose in the world of a frame of a scope; None where there is none, or a circle."""
        if name not in place.frames and name in place.pending:
            element, attribute = place.pending.pop(name)
            place.frames[name] = self.placed(element, place, attribute)
        return place.frames.get(name)

    def pose(self, pose: Element) -> Pose:
        fault = partial(self.file.fault, pose)
        try:
            numbers = [float(word) for word in (pose.text or "").split()]
        except ValueError:
            raise fault("its pose is no list of numbers") from None
        if not numbers:
            return Pose()
        if pose.get("rotation_format") == "quat_xyzw" and len(numbers) == 7:
            return quaternion_pose(numbers[:3], numbers[3:], fault)
        if len(numbers) != 6:
            raise fault(f"its pose has {len(numbers)} numbers, and 6 are due")
        angles = numbers[3:]
        if (pose.get("degrees") or "").strip().lower() in {"true", "1"}:
            angles = [math.radians(angle) for angle in angles]
        return angle_pose(numbers[:3], angles, fault)


def _tag(element: Element) -> str:
    return element.tag if isinstance(element.tag, str) else ""


def sdf_scene(files: SourceFiles) -> Scene:
    """What collides in the first world of a file, or in its models.

    Raises:
        SourceFault: it is no SDF file, or a number or a mesh of it cannot be read.
    """
    file = xml_file(files.main_bytes(), files.main)
    root = file.root
    if root.tag != "sdf":
        raise file.fault(root, f"it is no SDF file: its root is `{_tag(root)}`")
    worlds = root.findall("world")
    scene = Scene((worlds[0].get("name") if worlds else None) or files.main.stem)
    reader = _Reader(scene, files, file)
    for other in worlds[1:]:
        scene.dropped.append(f"world {other.get('name', '')}: a file is one scene, of its first")
    if worlds:
        reader.world(worlds[0])
    else:
        reader.models(root, _Place("", Pose()), 0)
    return scene
