"""Write modules and grammars in the language, as a person would."""

from __future__ import annotations

from collections.abc import Iterator

from srgc.imports.comment_lines import comment_lines, printable
from srgc.imports.module_set import (
    Body,
    Dof,
    Family,
    Frame,
    Module,
    Motion,
    Move,
    Placement,
    Port,
    Shape,
    Turn,
)
from srgc.imports.names import in_quotes
from srgc.imports.quantities import Quantities

_AXES = "xyz"


def module_text(module: Module, quantities: Quantities) -> str:
    """The block of a module with the comments above it, not yet in canonical form."""
    lines = [comment_lines(module.comments)] if module.comments else []
    lines.append(f"module {module.name} {{")
    lines += [f"  {line}" for line in _Writer(module, quantities).items()]
    lines.append("}")
    return "\n".join(lines)


def family_text(family: Family) -> str:
    """The block of a grammar from ports."""
    lines = [comment_lines(family.comments)] if family.comments else []
    lines.append(f"grammar {family.name} from ports {{")
    lines.append(f"  start {family.start};")
    if family.carried:
        lines.append(f"  with {', '.join(family.carried)};")
    if family.accept:
        lines.append(f"  accept {family.accept};")
    lines.append("}")
    return "\n".join(lines)


class _Writer:
    def __init__(self, module: Module, quantities: Quantities) -> None:
        self.module = module
        self.write = quantities
        self.motions = {dof.name: dof for dof in module.dofs}

    def items(self) -> Iterator[str]:
        module = self.module
        yield f"role {module.role};"
        if said := in_quotes(module.named):
            yield f"named {said};"
        for dof in module.dofs:
            yield from self.dof(dof)
        yield from map(self.port, module.ports)
        yield from map(self.frame, module.frames)
        yield from map(self.body, module.bodies)
        yield from map(self.shape, module.shapes)
        for place in module.effectors:
            yield f"effector(frame: {self.place(place)});"

    def dof(self, dof: Dof) -> Iterator[str]:
        turns = dof.kind == "revolute"
        unit = "rad" if turns else "m"
        parts = [f"dof {dof.name}: {dof.kind} {dof.axis}"]
        if dof.range is not None:
            written = self.write.angles if turns else self.write.interval
            parts.append(f"in {written(*dof.range)}")
        if dof.rate is not None:
            rate = self.write.number(dof.rate)
            parts.append(f"rate in [-{rate}, {rate}] {unit}/s")
        if dof.accel is not None:
            parts.append(f"accel <= {self.write.number(dof.accel)} {unit}/s^2")
        if dof.effort is not None:
            parts.append(f"effort <= {self.write.number(dof.effort)} {'N*m' if turns else 'N'}")
        if said := in_quotes(dof.named):
            parts.append(f"named {said}")
        yield f"{' '.join(parts)};{_behind(dof.comment)}"
        yield from self.drive(dof, turns=turns)
        if dof.passive:
            yield f"torque({dof.name}) = 0 {'N*m' if turns else 'N'};"

    def drive(self, dof: Dof, *, turns: bool) -> Iterator[str]:
        units = {
            "gear": "" if turns else " m^-1",
            "rotor": " kg*m^2",
            "viscous": " N*m*s" if turns else " N*s/m",
            "coulomb": " N*m" if turns else " N",
        }
        said = [
            f"{part} {self.write.number(value)}{unit}"
            for part, unit in units.items()
            if (value := getattr(dof.drive, part)) is not None
        ]
        if said:
            yield f"drive {dof.name}: {' '.join(said)};"

    def port(self, port: Port) -> str:
        gender = "" if port.gender is None else f" {port.gender}"
        return f"port {port.name}: {port.type}{gender};"

    def frame(self, frame: Frame) -> str:
        return f"frame {frame.name} = {self.place(frame.place)};"

    def body(self, body: Body) -> str:
        text = (
            f"solid(frame: {self.place(body.place)}, mass: {self.write.number(body.mass)} kg, "
            f"com: {self.write.centre(body.com)}, inertia: {self.write.inertia(body.inertia)});"
        )
        return f"{text}{_behind(body.comment)}"

    def shape(self, shape: Shape) -> str:
        frame = f"frame: {self.place(shape.place)}"
        size = shape.size
        match shape.kind:
            case "sphere":
                text = f"sphere({frame}, radius: {self.write.length(size[0])});"
            case "box":
                text = f"box({frame}, size: {self.write.vector(size)});"
            case "hull" | "visual":
                unit = f"scale: {self.write.length(size[0])}"
                text = f'{shape.kind}({frame}, file: "{shape.file}", {unit});'
            case _:
                radius, length = (self.write.length(value) for value in size)
                text = f"{shape.kind}({frame}, axis: z, length: {length}, radius: {radius});"
        return f"{text}{_behind(shape.comment)}"

    def place(self, place: Placement) -> str:
        """A frame as the product of its base and its steps; steps that do nothing are left out."""
        factors = [place.base]
        for step in place.steps:
            match step:
                case Move():
                    factors += self.move(step)
                case Turn():
                    angle = self.write.angle(step.angle)
                    factors += [] if angle == "0 rad" else [f"rot({step.axis}, {angle})"]
                case Motion():
                    dof = self.motions[step.dof]
                    verb = "rot" if dof.kind == "revolute" else "move"
                    factors.append(f"{verb}({dof.axis}, {dof.name})")
        return " * ".join(factors)

    def move(self, move: Move) -> Iterator[str]:
        texts, unit = self.write.lengths(move.by)
        moved = [number for number, text in enumerate(texts) if text != "0"]
        if len(moved) == 1:
            yield f"move({_AXES[moved[0]]}, {texts[moved[0]]} {unit})"
        elif moved:
            yield f"move(({', '.join(texts)}) {unit})"


def _behind(comment: str) -> str:
    return f"  // {printable(comment)}" if comment else ""
