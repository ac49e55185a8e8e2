"""Read worlds and models of SDF (Gazebo): links, collisions, nested models and includes.

Source: the SDFormat specification 1.11 (sdformat.org/spec).  Collision geometry is carried over;
anything unbounded or without a shape is listed.
"""

from __future__ import annotations

from pathlib import Path

from srgc.imports.scenes.scene import Scene, SceneObject
from srgc.imports.scenes.sdf_frames import Scope, is_true
from srgc.imports.scenes.sdf_geometry import Geometries
from srgc.imports.source_fault import SourceFault
from srgc.imports.source_files import TEXT_LIMIT, SourceFiles, source_bytes
from srgc.imports.xml_source import Element, XmlFile, xml_file

PASSED = frozenset(
    {"pose", "static", "link", "model", "include", "frame", "name", "self_collide", "enable_wind"}
    | {"kinematic", "allow_auto_disable", "uri"}
)
"""Elements of a model that are carried over, or do not affect where it is."""
ONCE: dict[str, tuple[str, ...]] = {
    "model": ("pose", "static"),
    "include": ("pose", "uri", "name", "placement_frame"),
    "link": ("pose",),
    "joint": ("pose", "child"),
    "frame": ("pose",),
    "collision": ("pose", "geometry"),
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "cone": ("radius", "length"),
    "ellipsoid": ("radii",),
    "mesh": ("uri", "scale", "submesh"),
    "polyline": ("height",),
    "plane": ("normal",),
}
"""For each element the parts that it may have once (SDFormat 1.11: required ``0`` or ``1``)."""
MOST_INCLUDES, DEEPEST = 1000, 20


class _Reader:
    def __init__(self, scene: Scene, files: SourceFiles) -> None:
        self.scene, self.files = scene, files
        self.geometries = Geometries(scene, files)
        self.includes = 0

    def world(self, world: Element) -> None:
        """Record the parts of a world that are not models."""
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

    def beside(self, file: XmlFile, read: Element | None, has: str, why: str) -> None:
        """Record the elements of the root of a file other than the one that is read.

        If that is None, the models and includes of the root are.
        """
        for element in file.root:
            tag = _tag(element)
            taken = tag in {"model", "include"} if read is None else element is read
            if tag and not taken:
                name = element.get("name") or (element.findtext("uri") or "").strip()
                said = " ".join(filter(None, (has, tag, name)))
                self.scene.dropped.append(f"{said}; {why}" if why else said)

    def find_models(self, scope: Scope, depth: int = 0) -> None:
        """Find the models and includes of a world or model, before poses refer to them."""
        if depth > DEEPEST:
            raise scope.file.fault(scope.element, f"models are nested more than {DEEPEST} deep")
        for model in scope.element.findall("model"):
            name = model.get("name") or "model"
            scope.children.append(Scope(model, scope.file, scope.folder, name, scope))
        for include in scope.element.findall("include"):
            found = self.included(include, scope)
            if found is not None:
                scope.children.append(found)
        for child in scope.children:
            self.find_models(child, depth + 1)

    def included(self, include: Element, outer: Scope) -> Scope | None:
        """The included model; None with a note if it is not found."""
        uri = (include.findtext("uri") or "").strip()
        self.includes += 1
        if self.includes > MOST_INCLUDES:
            raise outer.file.fault(include, f"there are more than {MOST_INCLUDES} includes")
        try:
            path = self.files.path_of(uri if Path(uri).suffix else f"{uri.rstrip('/')}/model.sdf")
        except SourceFault as fault:
            said = "; ".join(filter(None, (fault.message, fault.hint)))
            outer.missing.append(f"include {uri or '(without an address)'}: {said}")
            self.scene.dropped.append(outer.missing[-1])
            return None
        file = xml_file(source_bytes(path, TEXT_LIMIT), path)
        _refuse_second(file)
        model = file.root.find("model")
        if model is None:
            outer.missing.append(f"include {uri}: {path.name} has no model")
            self.scene.dropped.append(outer.missing[-1])
            return None
        self.beside(file, model, f"include {uri}: {path.name} has", "an include is its first model")
        name = (include.findtext("name") or "").strip() or model.get("name") or "model"
        return Scope(model, file, path.parent, name, outer, include)

    def model(self, model: Scope) -> None:
        """Read the links of a model, and its nested models."""
        self.listed(model)
        links = model.element.findall("link")
        for link in links:
            self.geometries.folder = model.folder
            self.link(link, model, alone=len(links) == 1)
        for child in model.children:
            self.model(child)

    def listed(self, model: Scope) -> None:
        """Record the parts of a model that are not carried over."""
        whole = model.whole
        outermost = model.parent is not None and model.parent.parent is None
        static = is_true(model.element.findtext("static"))
        if not static and outermost and model.include is None:
            self.scene.dropped.append(f"{whole} may move: it is an obstacle where it stands")
        for element in model.element:
            tag = _tag(element)
            if tag in {"joint", "plugin", "gripper"}:
                self.scene.dropped.append(f"{whole}: {tag} {element.get('name', '')}".rstrip())
            elif tag not in PASSED:
                self.scene.dropped.append(f"{whole}: {tag}")

    def link(self, link: Element, model: Scope, *, alone: bool) -> None:
        base, origin = model.placed(link), model.in_world()
        called = model.whole if alone else f"{model.whole}_{link.get('name', 'link')}"
        collisions = link.findall("collision")
        if not collisions and link.find("visual") is not None:
            self.scene.dropped.append(f"{called}: it is seen and does not collide")
        for each in link:
            if _tag(each) in {"sensor", "light", "projector", "particle_emitter"}:
                self.scene.dropped.append(f"{called}: {_tag(each)} {each.get('name', '')}".rstrip())
        for collision in collisions:
            own = collision.get("name") or "collision"
            name = called if len(collisions) == 1 else f"{called}_{own}"
            pose = origin.then(model.inside(collision, base))
            shapes = self.geometries.of(collision.find("geometry"), name, pose, model.file)
            for shape, shift, note in shapes:
                self.scene.objects.append(SceneObject(name, shape, pose.then(shift), note))


def _tag(element: Element) -> str:
    return element.tag if isinstance(element.tag, str) else ""


def sdf_scene(files: SourceFiles) -> Scene:
    """The collision geometry of the first world in a file, or of its models.

    Raises:
        SourceFault: the file is not SDF, a number or a mesh in it cannot be read, or a pose is
            relative to an unknown frame or to itself.
    """
    file = xml_file(files.main_bytes(), files.main)
    root = file.root
    if root.tag != "sdf":
        raise file.fault(root, f"it is not an SDF file: its root is `{_tag(root)}`")
    worlds = root.findall("world")
    _refuse_second(file)
    scene = Scene((worlds[0].get("name") if worlds else None) or files.main.stem)
    reader = _Reader(scene, files)
    if worlds:
        reader.beside(file, worlds[0], "beside the world:", "a file is one scene, of its first")
        reader.world(worlds[0])
    else:
        reader.beside(file, None, "of the file:", "")
    outermost = Scope(worlds[0] if worlds else root, file, files.folder)
    reader.find_models(outermost)
    for model in outermost.children:
        reader.model(model)
    return scene


def _refuse_second(file: XmlFile) -> None:
    """Refuse a file in which an element has a second pose, geometry, size or address.

    Raises:
        SourceFault: it has; the fault names the second one.
    """
    for element in file.root.iter(*ONCE):
        for tag in ONCE[str(element.tag)]:
            found = element.findall(tag)
            if len(found) > 1:
                said = f"a second <{tag}> in one <{element.tag}>"
                raise file.fault(found[1], said, "remove one")
