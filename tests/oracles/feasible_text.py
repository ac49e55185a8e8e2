"""How robots of one or two arms of rods, and places, are written in the language."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, log10

import numpy as np

from tests.oracles.rod_chains import Array, Block, RodChain


@dataclass(frozen=True)
class Frame:
    """How a robot is written: its plane or space, the size of a metre, and what drives it.

    ``free`` are the parts of a length within which it may be chosen; with ``gain`` (N*m/V) joints
    have motors, whose inputs are volts.
    """

    space: bool
    scale: float = 1.0
    free: tuple[float, float] = (0.85, 1.2)
    gain: float = 0.0

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return 3 if self.space else 2

    def number(self, value: float) -> str:
        """A length or place, with four digits of the size of the robot."""
        return plain(value, 4 - floor(log10(self.scale)))

    def point(self, at: Sequence[float]) -> str:
        """A place."""
        return f"({', '.join(self.number(x) for x in at[: self.dimension])})"

    def box(self, low: Array, high: Array) -> str:
        """A box."""
        sides = [f"[{self.number(a)}, {self.number(b)}]" for a, b in zip(low, high, strict=True)]
        return f"box {' x '.join(sides[: self.dimension])} m"

    def robot(self, arms: Sequence[RodChain], half: Sequence[Array]) -> str:
        """Modules, a grammar with one word, and semantics of one arm, or of two side by side."""
        modules, rules, words = list[str](), list[str](), list[str]()
        names: dict[tuple[object, ...], str] = {}
        for arm, ranges in zip(arms, half, strict=True):
            word = []
            for axis, length, limit in zip(arm.axes, arm.lengths, ranges, strict=True):
                key = axis, round(length, 9), round(float(limit), 9)
                if key not in names:
                    names[key] = f"P{len(names) + 1}"
                    modules.append(self._module(names[key], axis, length, float(limit), arm))
                    rules.append(self._rule(names[key], axis, length, arm))
                word.append(names[key])
            words.append(" ".join(word))
        payload = f"point(frame: this.at, mass: {plain(arms[0].payload, 6)} kg);"
        bases = [f"this.frame * move({self.point(arm.base)} m)" for arm in arms]
        parts = ["one", "two"][: len(arms)]
        based = " ".join(f"{part}.at = {at};" for part, at in zip(parts, bases, strict=True))
        brackets = " ".join(f"'[' {part}:A ']'" for part in parts)
        word = " ".join(f"'[' {each} Hand ']'" for each in words)
        grammar = "\n".join(f"  r{name}: A -> {name} A;" for name in names.values())
        return (
            "module Base { role base; }\nmodule Hand { role effector; }\n"
            f"{''.join(modules)}edge '[', ']';\n"
            f"grammar G {{\n  start R;\n  base: R -> Base {brackets};\n{grammar}\n"
            f"  hand: A -> Hand;\n  accept matches Base {word};\n}}\n"
            f"semantics G {{\n  base {{ {based} }}\n"
            f"  hand {{ {payload} effector(frame: this.at); }}\n{''.join(rules)}}}\n"
        )

    def _module(self, name: str, axis: str, length: float, limit: float, arm: RodChain) -> str:
        slides = axis.isupper()
        unit, size = ("m", self.number(limit)) if slides else ("deg", plain(np.degrees(limit), 3))
        kind = "prismatic" if slides else "revolute"
        dof = f"dof q: {kind} {axis.lower()} in [-{size}, {size}] {unit};"
        low, high = (self.number(part * length) for part in self.free)
        param = f" param length in [{low}, {high}] m;" if length else ""
        drive = ""
        if self.gain:
            friction = plain(float(np.max(arm.damping)), 4)
            drive = (
                f" input volts in [-{BOUND}, {BOUND}] V; const gain = {plain(self.gain, 4)} N*m/V;"
                f" torque(q) = gain * volts - {friction} N*m*s/rad * rate(q);"
            )
        return f"module {name} {{ role link; {dof}{param}{drive} }}\n"

    def _rule(self, name: str, axis: str, length: float, arm: RodChain) -> str:
        slides = axis.isupper()
        moved = "move" if slides else "rot"
        turned = f"this.at * {moved}({axis.lower()}, {name}.q)"
        parts = [f"A.at = {turned};"]
        if length:
            parts = [f"A.at = {turned} * move(x, {name}.length);"]
            density = f"density: {plain(arm.density, 6)} kg/m"
            parts.append(f"rod(frame: A.at, axis: -x, length: {name}.length, {density});")
        if slides:
            parts.append(f"point(frame: A.at, mass: {plain(arm.carriage, 6)} kg);")
        return f"  r{name} {{ {' '.join(parts)} }}\n"


BOUND = "{bound}"
"""Stands for the bound of inputs, which is known last."""


def plain(value: float, digits: int) -> str:
    """A number without an exponent."""
    text = f"{float(value):.{max(digits, 0)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def hull(frame: Frame, block: Block) -> str:
    """A block as the language has it."""
    corners = block.corners(frame.dimension)
    return f"hull {', '.join(frame.point(corner.tolist()) for corner in corners)} m"
