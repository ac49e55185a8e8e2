"""Refuse SDF elements that have a part twice of which only one can count."""

from __future__ import annotations

from srgc.imports.xml_source import XmlFile

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


def refuse_second(file: XmlFile) -> None:
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
