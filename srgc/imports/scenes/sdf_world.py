"""Worlds and models of SDF (Gazebo): links, collisions, nested models and includes.

Source: the SDFormat specification 1.11 (sdformat.org/spec).  What collides is carried over; what has
no bounds or no shape is listed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

from srgc.faults import UsageFault
from srgc.imports.limited_files import FileTree, Xml, limited_xml
from srgc.imports.scenes.scene import (
    Pose,
    Scene,
    SceneObject,
    angle_pose,
    quaternion_pose,
)
from srgc.imports.scenes.sdf_geometry import Geometries

SHAPELESS = frozenset(
    "light physics gui scene gravity magnetic_field atmosphere spherical_coordinates wind audio "
    "state population material model_state actor road".split()
)
"""Elements of a world that are listed together."""
PASSED = frozenset(
    "pose static link model include frame name joint plugin self_collide enable_wind kinematic "
    "allow_auto_disable uri placement_frame gripper".split()
)
MOST_INCLUDES, DEEPEST = 1000, 20


@dataclass(slots=True)
class _Place:
    """Where a model stands, and the poses in the world of the frames of its scope."""

    prefix: str
    pose: Pose
    frames: dict[str, Pose] = field(default_factory=dict)


class _Reader:
    def __init__(self, scene: Scene, tree: FileTree, path: Path) -> None:
        self.scene, self.tree, self.path = scene, tree, path
        self.geometries = Geometries(scene, tree)
        self.includes = 0

    def fault(self, said: str) -> UsageFault:
        return UsageFault(f"{self.path}: {said}")

    def world(self, world: Xml) -> None:
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

    def models(self, parent: Xml, place: _Place, depth: int) -> None:
        """The models and includes of a world or model; frames first, since these refer to them."""
        if depth > DEEPEST:
            raise self.fault(f"models are nested more than {DEEPEST} deep")
        for frame in parent.findall("frame"):
            place.frames[frame.get("name", "")] = self.placed(frame, place, "attached_to")
        for model in parent.findall("model"):
            self.model(model, place, self.placed(model, place), depth)
        for include in parent.findall("include"):
            self.include(include, place, depth)

    def model(self, model: Xml, outer: _Place, pose: Pose, depth: int, called: str = "") -> None:
        name = called or model.get("name") or "model"
        whole = f"{outer.prefix}{name}"
        place = _Place(f"{whole}_", pose, {"__model__": pose})
        outer.frames[name] = pose
        self.listed(model, whole, depth)
        links = model.findall("link")
        for link in links:
            place.frames[link.get("name", "")] = self.placed(link, place)
        for frame in model.findall("frame"):
            place.frames[frame.get("name", "")] = self.placed(frame, place, "attached_to")
        # A pose may refer to what stands further down.
        for link in links:
            place.frames[link.get("name", "")] = self.placed(link, place)
        for link in links:
            self.link(link, place, whole, alone=len(links) == 1)
        self.models(model, place, depth + 1)

    def listed(self, model: Xml, whole: str, depth: int) -> None:
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

    def link(self, link: Xml, place: _Place, whole: str, *, alone: bool) -> None:
        base = place.frames[link.get("name", "")]
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
            inner = _Place(place.prefix, base, place.frames)
            pose = self.placed(collision, inner)
            for shape, shift, note in self.geometries.of(collision.find("geometry"), name, pose):
                self.scene.objects.append(SceneObject(name, shape, pose.then(shift), note))

    def include(self, include: Xml, place: _Place, depth: int) -> None:
        uri = (include.findtext("uri") or "").strip()
        self.includes += 1
        if self.includes > MOST_INCLUDES:
            raise self.fault(f"there are more than {MOST_INCLUDES} includes")
        try:
            path = self.tree.found(uri if Path(uri).suffix else f"{uri.rstrip('/')}/model.sdf")
        except UsageFault as fault:
            self.scene.dropped.append(f"include {uri or '(without an address)'}: {fault}")
            return
        model = limited_xml(path).find("model")
        if model is None:
            self.scene.dropped.append(f"include {uri}: {path.name} has no model")
            return
        within = place if include.find("pose") is not None else None
        pose = self.placed(include, place) if within else self.placed(model, place)
        called = (include.findtext("name") or "").strip()
        outer = self.geometries.folder
        self.geometries.folder = path.parent
        self.model(model, place, pose, depth + 1, called)
        self.geometries.folder = outer

    def placed(self, element: Xml, place: _Place, attribute: str = "") -> Pose:
        """The pose in the world of an element of a scope."""
        pose = element.find("pose")
        base = place.pose
        relative = (element.get(attribute) if attribute else None) or ""
        if pose is not None:
            relative = pose.get("relative_to") or pose.get("frame") or relative
        if relative and relative != "world":
            name = relative.replace("::", "_")
            if name not in place.frames:
                self.scene.dropped.append(
                    f"{place.prefix}{element.get('name', '')}: its pose is relative to "
                    f"`{relative}`, which is not known here; it is taken as one of its parent"
                )
            base = place.frames.get(name, base)
        elif relative == "world":
            base = Pose()
        return base if pose is None else base.then(self.pose(pose, element))

    def pose(self, pose: Xml, element: Xml) -> Pose:
        what = f"{self.path}: {_tag(element)} `{element.get('name', '')}`"
        try:
            numbers = [float(word) for word in (pose.text or "").split()]
        except ValueError:
            raise UsageFault(f"{what}: its pose is no list of numbers") from None
        if not numbers:
            return Pose()
        if pose.get("rotation_format") == "quat_xyzw" and len(numbers) == 7:
            return quaternion_pose(numbers[:3], numbers[3:], what)
        if len(numbers) != 6:
            raise UsageFault(f"{what}: its pose has {len(numbers)} numbers, and 6 are due")
        angles = numbers[3:]
        if (pose.get("degrees") or "").strip().lower() in {"true", "1"}:
            angles = [math.radians(angle) for angle in angles]
        return angle_pose(numbers[:3], angles, what)


def _tag(element: Xml) -> str:
    return element.tag if isinstance(element.tag, str) else ""


def sdf_scene(path: Path, tree: FileTree) -> Scene:
    """What collides in the first world of a file, or in its models.

    Raises:
        UsageFault: it is no SDF file, or a number or a mesh of it cannot be read.
    """
    root = limited_xml(path)
    if root.tag != "sdf":
        raise UsageFault(f"{path} is no SDF file: its root is `{root.tag}`")
    worlds = root.findall("world")
    scene = Scene((worlds[0].get("name") if worlds else None) or path.stem)
    reader = _Reader(scene, tree, path)
    for other in worlds[1:]:
        scene.dropped.append(f"world {other.get('name', '')}: a file is one scene, of its first")
    if worlds:
        reader.world(worlds[0])
    else:
        reader.models(root, _Place("", Pose()), 0)
    return scene
