"""Read the gears of joints from transmissions, in the robot itself or within ``ros2_control``.

In a simple transmission the joint turns by the angle of its motor divided by the reduction.
Sources: wiki.ros.org/urdf/XML/Transmission; control.ros.org, "transmission_interface".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from grammar_lang.diagnostics.wording import nearest
from grammar_lang.files.file_tree import visible
from srgc.imports.source_warning import SourceWarning
from srgc.imports.urdf.written_numbers import check_text
from srgc.imports.xml_source import Element, XmlFile

SIMPLE = "SimpleTransmission"
TAGS = ("mechanicalReduction", "mechanical_reduction")
OF_ACTUATORS = (*TAGS, "hardwareInterface", "offset", "command_interface", "state_interface")
"""Parts of an actuator that are read, or that do not affect how a joint moves."""


@dataclass(slots=True)
class Gears:
    """Reads transmissions; ``joints`` maps names to the elements of the robot's joints.

    ``ratios`` maps joints to the motion of the motor per motion of the joint (1, rad/m), if not 1.
    """

    file: XmlFile
    joints: Mapping[str, Element]
    ratios: dict[str, float] = field(default_factory=dict[str, float])
    warnings: list[SourceWarning] = field(default_factory=list[SourceWarning])
    _seen: dict[str, tuple[float, Element]] = field(
        default_factory=dict[str, tuple[float, Element]]
    )

    def read(self) -> None:
        """Read all transmissions.

        Raises:
            SourceFault: a reduction is not a number.
        """
        for transmission in self.file.root.iter("transmission"):
            self._tell_of_others(transmission)
            stated = list(self._stated(transmission))
            joint = self._joint(transmission)
            if joint is None or not stated:
                continue
            (value, element), *others = stated
            for other, place in others:
                if other != value:
                    said = f"another reduction of joint `{visible(joint)}`, {other:g}, is left out"
                    self._tell(place, f"{said}: {value:g} is taken")
            self._keep(joint, value, element)

    def _stated(self, transmission: Element) -> Iterator[tuple[float, Element]]:
        """The reductions of a transmission, beginning with the one that ROS reads.

        That is the actuator's, or the joint's in ``ros2_control``.
        """
        first = "joint" if _parent(transmission) == "ros2_control" else "actuator"
        found = list(transmission.iter(*TAGS))
        for element in sorted(found, key=lambda each: _parent(each) != first):
            text = element.text or ""
            check_text(self.file, element, str(element.tag), text, 1)
            yield float(text), element

    def _tell_of_others(self, transmission: Element) -> None:
        """Warn of each other part of an actuator, such as the rotor inertia that Drake reads."""
        for part in transmission.iterfind("actuator/*"):
            tag = str(part.tag).rpartition("}")[2]
            if tag not in OF_ACTUATORS:
                called = visible(f"{part.prefix}:{tag}" if part.prefix else tag)
                self._tell(part, f"<{called}> in <actuator> is left out")

    def _joint(self, transmission: Element) -> str | None:
        """The only joint of a transmission; otherwise None, with a warning."""
        names = [str(joint.get("name")) for joint in transmission.findall("joint")]
        kind, called = _kind(transmission), visible(transmission.get("name") or "transmission")
        listed = ", ".join(f"`{visible(name)}`" for name in names) or "none"
        if len(names) != 1 or kind != SIMPLE:
            what = "" if kind == SIMPLE else f" ({visible(kind)})"
            said = f"transmission `{called}`{what} is not the gear of one joint: it is left out"
            self._tell(transmission, f"{said}; its joints: {listed}")
            return None
        if names[0] in self.joints:
            return names[0]
        near = nearest(names[0], list(self.joints))
        hint = None if near is None else f"did you mean `{near}`?"
        said = f"transmission `{called}` is left out: there is no joint {listed}"
        self._tell(transmission, said, hint)
        return None

    def _keep(self, joint: str, value: float, element: Element) -> None:
        if joint in self._seen and self._seen[joint][0] != value:
            before, place = self._seen[joint]
            said = f"joint `{visible(joint)}` has a reduction already, {before:g} in line"
            self._tell(element, f"{said} {self.file.line(place)}: {value:g} is left out")
            return
        if joint in self._seen:
            return
        self._seen[joint] = value, element
        if value == 0:
            self._tell(element, f"the reduction of joint `{visible(joint)}` is 0: it is left out")
            return
        if value < 0:
            said = f"the motor of joint `{visible(joint)}` turns against it"
            self._tell(
                element,
                f"{said}: the gear is {-value:g}",
                "angles, rates and efforts are those of the joint; negate them for the motor",
            )
        if abs(value) != 1:
            self.ratios[joint] = abs(value)

    def _tell(self, element: Element, message: str, hint: str | None = None) -> None:
        self.warnings.append(self.file.warning(element, message, hint))


def _parent(element: Element) -> str:
    above = element.getparent()
    return "" if above is None else str(above.tag)


def _kind(transmission: Element) -> str:
    """The class of a transmission without its package; by default the simple one."""
    texts = [transmission.findtext("type"), transmission.findtext("plugin")]
    said = next(filter(None, (*texts, transmission.get("type"))), SIMPLE)
    return said.strip().replace("::", "/").rpartition("/")[2] or SIMPLE
