"""Random kits of modules with ports, and each written by hand without ports as well.

The second text has nothing of the first but its numbers: a nonterminal for what may stand at an
output, a production for every module there, and in it every frame and body spelt out over an
inherited attribute.  Frames that several things read are synthesized attributes, which the other
productions of the nonterminal define as something useless.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field

AXES = ("x", "y", "z")
OTHER = {"": "", "male": "female", "female": "male"}


@dataclass
class Part:
    """A module: what it declares, steps of its frames, its bodies, its ports.

    ``frames`` are a name, the frame before, and steps with names that ``%s`` puts an owner before;
    ``ports`` are outputs as name, type and gender.
    """

    name: str
    role: str
    input: tuple[str, str] | None
    declared: list[str] = field(default_factory=list)
    frames: list[tuple[str, str, str]] = field(default_factory=list)
    bodies: list[str] = field(default_factory=list)
    ports: list[tuple[str, str, str]] = field(default_factory=list)


class RandomKit:
    """A kit of a base, some modules and one ending for each output; ``text`` and ``by_hand``."""

    def __init__(self, seed: int) -> None:
        self.choose = random.Random(seed)
        self.plane = self.choose.random() < 0.4
        kinds = [f"T{i}" for i in range(self.choose.randint(1, 2))]
        self.sorts = [(t, g) for t in kinds for g in self.choose.sample(["", "male", "female"], 2)]
        self.parts = [self.part("Base", "base", None)]
        for number in range(self.choose.randint(2, 4)):
            role = self.choose.choice(["joint", "link"])
            self.parts.append(self.part(f"M{number}", role, self.choose.choice(self.sorts)))
        for number, sort in enumerate(self.sorts):
            role = "effector" if number == 0 or self.choose.random() < 0.5 else "link"
            self.parts.append(self.part(f"End{number}", role, sort))

    def axis(self, *, turn: bool) -> str:
        if self.plane:
            return "z" if turn else self.choose.choice("xy")
        return self.choose.choice(AXES)

    def step(self) -> str:
        if self.choose.random() < 0.4:
            return f"rot({self.axis(turn=True)}, {self.choose.randint(-9, 9) * 10} deg)"
        return f"move({self.axis(turn=False)}, {self.choose.randint(1, 9)} cm)"

    def part(self, name: str, role: str, sort: tuple[str, str] | None) -> Part:
        """A module of a role; ``sort`` is the type and gender of its input."""
        choose = self.choose
        part = Part(name, role, sort)
        steps = [self.step() for _ in range(choose.randint(0, 2))]
        if choose.random() < 0.6:
            part.declared.append("param length in [0.2, 0.6] m;")
            steps.append(f"move({self.axis(turn=False)}, %slength)")
        if role == "joint":
            axis = self.axis(turn=True)
            part.declared.append(f"dof q: revolute {axis} in [-90, 90] deg;")
            steps.insert(choose.randint(0, len(steps)), f"rot({axis}, %sq)")
        if choose.random() < 0.5:
            part.declared.append("const mass = 1.5 kg;")
            part.bodies.append("point(frame: @in, mass: %smass);")
        before = "in"
        for number, step in enumerate(steps):
            part.frames.append((f"f{number}", before, step))
            before = f"f{number}"
        if any("length" in each for each in part.declared):
            part.bodies.append(
                f"rod(frame: @{before}, axis: x, length: %slength, density: 2 kg/m);"
            )
        if role == "effector":
            part.bodies.append(f"effector(frame: @{before});")
        if not name.startswith("End"):
            for number in range(choose.choice([1, 1, 2])):
                part.frames.append((f"out{number}", before, self.step()))
                kind, gender = choose.choice(self.sorts)
                part.ports.append((f"out{number}", kind, OTHER[gender]))
        return part

    # --- with ports --------------------------------------------------------------------------

    def module(self, part: Part) -> str:
        own = list(part.declared)
        if part.input is not None:
            own.append(f"port in: {part.input[0]} {part.input[1]};")
        own += [
            f"frame {n} = {before} * {step.replace('%s', '')};" for n, before, step in part.frames
        ]
        own += [f"port {name}: {kind} {gender};" for name, kind, gender in part.ports]
        own += [body.replace("@", "").replace("%s", "") for body in part.bodies]
        return f"module {part.name} {{ role {part.role}; {' '.join(own)} }}"

    @property
    def text(self) -> str:
        """The kit with a grammar from ports."""
        names = ", ".join(part.name for part in self.parts[1:])
        modules = map(self.module, self.parts)
        return "\n".join([*modules, f"grammar G from ports {{ start Base; with {names}; }}"])

    # --- by hand -----------------------------------------------------------------------------

    def nonterminal(self, kind: str, gender: str) -> str:
        return f"At_{kind}_{gender or 'plain'}"

    def production(self, part: Part, shared: Sequence[str]) -> tuple[str, str]:
        """A production and its block; ``shared`` are the attributes of its nonterminal."""
        left = "S" if part.input is None else self.nonterminal(part.input[0], OTHER[part.input[1]])
        names = [
            f"c{k}:{self.nonterminal(kind, gender)}"
            for k, (_, kind, gender) in enumerate(part.ports)
        ]
        own = {name for name, _, _ in part.frames}
        called = {"in": "this.pose" if part.input else "world", **{n: f"this.{n}" for n in own}}
        rules = []
        for name, before, step in part.frames:
            rules.append(f"this.{name} = {called[before]} * {step.replace('%s', f'{part.name}.')};")
        rules += [f"this.{name} = world;" for name in shared if name not in own]
        rules += [f"c{k}.pose = this.{name};" for k, (name, _, _) in enumerate(part.ports)]
        for body in part.bodies:
            at = body[body.index("@") + 1 :].replace(")", ",").split(",")[0].split(";")[0]
            rules.append(body.replace(f"@{at}", called[at]).replace("%s", f"{part.name}."))
        return (
            f"p{part.name}: {left} -> {' '.join([part.name, *names])};",
            f"p{part.name} {{ {' '.join(rules)} }}",
        )

    def carried(self) -> list[Part]:
        """The modules that some output leads to from the base."""
        found, due = [self.parts[0]], list(self.parts[0].ports)
        for _, kind, gender in due:
            for part in self.parts[1:]:
                if part.input == (kind, OTHER[gender]) and part not in found:
                    found.append(part)
                    due += part.ports
        return [part for part in self.parts if part in found]

    @property
    def by_hand(self) -> str:
        """The kit without ports."""
        modules = [
            f"module {p.name} {{ role {p.role}; {' '.join(p.declared)} }}" for p in self.parts
        ]
        shared: dict[object, set[str]] = {}
        for part in self.carried():
            left = None if part.input is None else (part.input[0], OTHER[part.input[1]])
            shared.setdefault(left, set()).update(name for name, _, _ in part.frames)
        made = []
        for part in self.carried():
            left = None if part.input is None else (part.input[0], OTHER[part.input[1]])
            made.append(self.production(part, sorted(shared[left])))
        rules = " ".join(rule for rule, _ in made)
        blocks = "\n".join(block for _, block in made)
        return "\n".join(
            [*modules, f"grammar G {{ start S; {rules} }}", f"semantics G {{ {blocks} }}"]
        )
