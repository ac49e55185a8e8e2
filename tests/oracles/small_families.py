"""Random small families that are told twice: as a specification, and as words with steps to sample.

A robot may stand still in any pose: nothing weighs, no obstacle is there, the task starts anywhere
around its target, and every joint has a mass of its own off its axis.  So a pose with an effector
in the target shows that the task is possible, and sums of lengths may show that it is not.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array

CLEAR = 1e-3
"""Metres within which nothing is concluded."""
MOST = 30
"""Robots of a family."""
AXES = "xyz"
Accepts = Callable[[Sequence[str]], bool]


@dataclass(frozen=True)
class Step:
    """A turn about an axis or a move along it, by what ``text`` says, from ``low`` to ``high``."""

    turn: bool
    axis: str
    low: float
    high: float
    text: str

    def __str__(self) -> str:
        return f"{'rot' if self.turn else 'move'}({self.axis}, {self.text})"

    def frames(self, values: Array) -> Array:
        """Homogeneous matrices."""
        found = np.tile(np.eye(4), (len(values), 1, 1))
        i = AXES.index(self.axis)
        if not self.turn:
            found[:, i, 3] = values
            return found
        j, k = (i + 1) % 3, (i + 2) % 3
        found[:, j, j] = found[:, k, k] = np.cos(values)
        found[:, k, j] = np.sin(values)
        found[:, j, k] = -found[:, k, j]
        return found


@dataclass(frozen=True)
class Part:
    """A module, what it declares, its steps, and its body: @ is the frame before them, $ after."""

    name: str
    declared: str
    steps: tuple[Step, ...]
    body: str


Chain = tuple[Part, ...]


@dataclass(frozen=True)
class Robot:
    """A word's modules in order, and the parts from the base to each effector."""

    names: tuple[str, ...]
    effectors: tuple[Chain, ...]


@dataclass(frozen=True)
class Slab:
    """Points whose product with ``normal`` is within ``half`` of ``middle``."""

    normal: tuple[float, ...]
    middle: float
    half: float


def _bent_by(axis: str, degrees: int) -> Step:
    angle = float(np.radians(degrees))
    return Step(True, axis, angle, angle, f"{degrees} deg")


BASE = Part("Base", "role base;", (), "")
TOOL = Part("E", "role effector;", (), "effector(frame: @);")
REST = Part("Rest", "role link;", (), "point(frame: @, mass: 500 g);")


@dataclass
class SmallFamily:
    """A family with its task; ``text`` is the specification."""

    seed: int
    choose: random.Random = field(init=False)

    def __post_init__(self) -> None:
        self.choose = choose = random.Random(f"small families {self.seed}")
        self.plane = choose.random() < 0.6
        self.style = choose.choice(["below", "below", "above", "above", "branches"])
        self.modules = choose.choice([4, 5] if self.style == "branches" else [3, 4, 4, 5])
        self.long = round(choose.uniform(0.8, 2.5), 2)
        makers = [self._joint, self._slide, self._short, self._long, self._bend]
        kinds = {self._joint, choose.choice([self._short, self._long]), choose.choice(makers)}
        if choose.random() < 0.3:
            kinds |= {self._short, self._long}
        self.parts = [make() for make in makers if make in kinds]
        self.twin = choose.random() < 0.25
        """Whether the last part may be put on bent as well: words with several derivations."""
        self.accept, self.accepts = self._accept()
        while sum(1 for _ in self.robots()) > MOST:
            self.modules -= 1
        self.slabs = self._target()

    # --- modules -----------------------------------------------------------------------------

    def _turning(self) -> str:
        return "z" if self.plane else self.choose.choice("zzyx")

    def _joint(self) -> Part:
        half = self.choose.choice([20, 60, 120, 180])
        axis = self._turning()
        other = {"z": "x", "x": "y", "y": "z"}[axis]
        turn = Step(True, axis, -np.radians(half), np.radians(half), "J.q")
        return Part(
            "J", f"role joint; dof q: revolute {axis} in [-{half}, {half}] deg;", (turn,),
            f"point(frame: $ * move({other}, 5 cm), mass: 1 kg);",
        )  # fmt: skip

    def _slide(self) -> Part:
        stroke = round(self.choose.uniform(0.1, 0.6), 2)
        axis = self.choose.choice("xy" if self.plane else "xz")
        move = Step(False, axis, 0.0, stroke, "P.d")
        return Part(
            "P", f"role joint; dof d: prismatic {axis} in [0, {stroke}] m;", (move,),
            "point(frame: $, mass: 1 kg);",
        )  # fmt: skip

    def _link(self, name: str, low: float, high: float) -> Part:
        low, high = round(low, 2), round(high, 2)
        return Part(
            name, f"role link; param length in [{low}, {high}] m;",
            (Step(False, "x", low, high, f"{name}.length"),),
            f"rod(frame: @, axis: x, length: {name}.length, density: 1 kg/m);",
        )  # fmt: skip

    def _short(self) -> Part:
        low = self.choose.uniform(0.2, 0.5)
        return self._link("L", low, low + self.choose.choice([0.0, 0.1, 0.4]))

    def _long(self) -> Part:
        return self._link("K", self.long, self.long + self.choose.choice([0.0, 0.0, 0.3]))

    def _bend(self) -> Part:
        degrees = self.choose.choice([-90, -45, 30, 90])
        turn = _bent_by(self._turning(), degrees)
        move = Step(False, "x", 0.1, 0.1, "10 cm")
        return Part("W", "role link;", (turn, move), "point(frame: $, mass: 500 g);")

    def _bent(self) -> Part:
        last, turn = self.parts[-1], _bent_by("z", 40)
        body = last.body.replace("@", f"@ * {turn}")
        return Part(last.name, "", (turn, *last.steps), body)

    # --- which words -------------------------------------------------------------------------

    def _accept(self) -> tuple[str, Accepts]:
        """A condition, and the same as a function of the modules of a word."""
        has = [part.name for part in self.parts]
        one, other = self.choose.choice(has), self.choose.choice(has)
        most = self.choose.randint(0, 2)
        joints = self.choose.randint(1, 2)
        options: list[tuple[str, Accepts]] = [
            ("contains E", lambda w: "E" in w),
            (f"contains E and count({one}) <= {most}",
             lambda w: "E" in w and w.count(one) <= most),
            (f"count(J) >= {joints} and (count({one}) == 1 or count({other}) >= 2)",
             lambda w: w.count("J") >= joints and (w.count(one) == 1 or w.count(other) >= 2)),
            (f"contains E and not (count({one}) == {most} and count(J) <= 1)",
             lambda w: "E" in w and not (w.count(one) == most and w.count("J") <= 1)),
        ]  # fmt: skip
        if self.style != "branches":
            options += [
                ("starts with Base eps J and contains E",
                 lambda w: w[:2] == ("Base", "J") and "E" in w),
                (f"count({one}) >= {joints} and ends with E",
                 lambda w: w.count(one) >= joints and w[-1] == "E"),
                (f"matches Base (eps J)? (eps {one} | eps {other})* eps E",
                 lambda w: bool(re.fullmatch(f"Base( J)?( {one}| {other})* E", " ".join(w)))),
            ]  # fmt: skip
        return self.choose.choice(options)

    def robots(self) -> Iterator[Robot]:
        """All words with at most so many modules, one robot for each derivation."""
        grown = {"below": self._below, "above": self._above, "branches": self._branches}
        for robot in grown[self.style]():
            if self.accepts(robot.names):
                yield robot

    def _some(self) -> Iterator[Part]:
        yield from self.parts
        if self.twin:
            yield self._bent()

    def _below(self) -> Iterator[Robot]:
        grown = [Robot(("Base",), ())]
        chains: list[Chain] = [()]
        for _ in range(self.modules):
            yield from grown
            pairs = [(r, c, p) for r, c in zip(grown, chains, strict=True)
                     for p in (*self._some(), TOOL)]  # fmt: skip
            grown = [Robot((*r.names, p.name), r.effectors + ((c,) if p is TOOL else ()))
                     for r, c, p in pairs]  # fmt: skip
            chains = [c if p is TOOL else (*c, p) for _, c, p in pairs]

    def _above(self) -> Iterator[Robot]:
        for names, effectors in self._arms((), self.modules - 1):
            yield Robot(("Base", *names), effectors)

    def _branches(self) -> Iterator[Robot]:
        for first, one in self._arms((), self.modules - 2):
            for second, two in self._arms((), self.modules - 1 - len(first)):
                yield Robot(("Base", *first, *second), one + two)

    def _arms(self, chain: Chain, most: int) -> Iterator[tuple[tuple[str, ...], tuple[Chain, ...]]]:
        """What the nonterminal ``A`` derives behind a chain, of at most so many modules."""
        if most < 1:
            return
        yield ("E",), (chain,)
        if self.style == "branches":
            yield ("Rest",), ()
        else:
            for names, effectors in self._arms(chain, most - 1):
                yield ("E", *names), (chain, *effectors)
        for part in self._some():
            for names, effectors in self._arms((*chain, part), most - 1):
                yield (part.name, *names), effectors

    # --- where to ----------------------------------------------------------------------------

    def _target(self) -> tuple[Slab, ...]:
        """A box, tilted about z or not, around a pose, at an end of reach, or anywhere."""
        choose, size = self.choose, 2 if self.plane else 3
        half = choose.choice([0.05, 0.1, 0.2, 0.4])
        chains = [chain for robot in self.robots() for chain in robot.effectors]
        longer = [chain for chain in chains if len(chain) > 1]
        if longer and choose.random() < 0.5:
            rng = np.random.default_rng(self.seed)
            middle = [round(float(x), 3) for x in tips(choose.choice(longer), 1, rng)[0, :size]]
        else:
            ends = [distance for chain in longer for distance in distances(chain)]
            somewhere = [0.1 * self.long, 0.6 * self.long, 1.4 * self.long]
            about = choose.choice(ends) if ends and choose.random() < 0.6 else None
            reach = choose.choice(somewhere) if about is None else about
            middle = self._somewhere(size, abs(reach + choose.uniform(-1.2, 1.2) * half))
        normals = [[float(i == j) for j in range(size)] for i in range(size)]
        if choose.random() < 0.5:
            normals[0][:2], normals[1][:2] = [1.0, 2.0], [2.0, -1.0]
        return tuple(
            Slab(tuple(n), sum(a * m for a, m in zip(n, middle, strict=True)), half)
            for n in normals
        )

    def _somewhere(self, size: int, distance: float) -> list[float]:
        """A point so far from the base, rather ahead of it than behind."""
        towards = [self.choose.gauss(float(axis == 0), 1) for axis in range(size)]
        if not self.plane and self.choose.random() < 0.6:
            towards[2] = 0.0
        norm = sum(t * t for t in towards) ** 0.5
        return [round(distance * t / norm, 3) for t in towards]

    @property
    def text(self) -> str:
        """The specification."""
        parts = [BASE, *self.parts, TOOL, *([REST] if self.style == "branches" else [])]
        modules = [f"module {part.name} {{ {part.declared.strip()} }}" for part in parts]
        rules, blocks = self._below_rules() if self.style == "below" else self._above_rules()
        far = 8 * self.long + 8
        size = 2 if self.plane else 3
        box = [" x ".join([f"[-{w:.1f}, {w:.1f}]"] * size) for w in (far, far / 2)]
        return "\n".join([
            *modules,
            "edge eps, open, close;",
            f"grammar G {{ start {'N' if self.style == 'below' else 'R'}; {' '.join(rules)}",
            f"  accept {self.accept}; }}",
            f"semantics G {{\n  {chr(10).join(blocks)} }}",
            f"workspace W {{ {'plane xy' if self.plane else 'space xyz'}; bounds box {box[0]} m;",
            f"  region S box {box[1]} m; target T polytope {{ {self._rows()} }} m; }}",
            "task Go { robot G; workspace W; start in S at rest; reach T; effort <= 100 N*m;",
            f"  effort <= 100 N; modules <= {self.modules}; horizon 5 steps of 0.1 s; }}",
            "",
        ])  # fmt: skip

    def _rows(self) -> str:
        rows = []
        for slab in self.slabs:
            terms = [f"{a:+.0f}*{x}" for a, x in zip(slab.normal, AXES, strict=False) if a]
            left = " ".join(f"{t[0]} {t[1:]}" for t in terms).removeprefix("+ ")
            rows.append(f"{left} <= {slab.middle + slab.half:.4f};")
            rows.append(f"{left} >= {slab.middle - slab.half:.4f};")
        return " ".join(rows)

    def _below_rules(self) -> tuple[list[str], list[str]]:
        rules, blocks = ["base: N -> Base;"], ["base { this.frame = world; }"]
        for name, part in self._named():
            rules.append(f"{name}: N -> N eps {part.name};")
            steps = "".join(f" * {step}" for step in part.steps)
            body = part.body.replace("@", "N.frame").replace("$", "this.frame")
            blocks.append(f"{name} {{ this.frame = N.frame{steps}; {body} }}")
        return rules, blocks

    def _above_rules(self) -> tuple[list[str], list[str]]:
        if self.style == "above":
            rules, blocks = ["base: R -> Base eps A;"], ["base { A.at = world; }"]
        else:
            rules = ["base: R -> Base open left:A close open right:A close;"]
            blocks = ["base { left.at = world; right.at = world; }"]
        for name, part in self._named():
            steps = "".join(f" * {step}" for step in part.steps)
            body = part.body.replace("@", "this.at").replace("$", "A.at")
            if part is not TOOL or self.style == "above":
                rules.append(f"{name}: A -> {part.name} eps A;")
                blocks.append(f"{name} {{ A.at = this.at{steps}; {body} }}")
        ends = [TOOL, *([REST] if self.style == "branches" else [])]
        for part in ends:
            rules.append(f"last_{part.name}: A -> {part.name};")
            blocks.append(f"last_{part.name} {{ {part.body.replace('@', 'this.at')} }}")
        return rules, blocks

    def _named(self) -> Iterator[tuple[str, Part]]:
        for part in (*self.parts, TOOL):
            yield f"put_{part.name}", part
        if self.twin:
            yield "bent", self._bent()


# --- What is true of them -------------------------------------------------------------------------


def distances(chain: Chain) -> tuple[float, float]:
    """Between which an effector keeps from the base, by the triangle inequality."""
    moves = [step for part in chain for step in part.steps if not step.turn]
    farthest = sum(step.high for step in moves)
    nearest = max((step.low - (farthest - step.high) for step in moves), default=0.0)
    return max(nearest, 0.0), farthest


def target_distances(family: SmallFamily) -> tuple[float, float]:
    """Of the nearest and of the farthest point of the target from the base."""
    near = far = 0.0
    for slab in family.slabs:
        length = sum(a * a for a in slab.normal) ** 0.5
        low, high = (slab.middle - slab.half) / length, (slab.middle + slab.half) / length
        near += max(low, -high, 0.0) ** 2
        far += max(abs(low), abs(high)) ** 2
    return near**0.5, far**0.5


def is_beyond(family: SmallFamily) -> bool:
    """Whether every effector of every word is too far from the target, or too near the base."""
    near, far = target_distances(family)
    chains = {chain for robot in family.robots() for chain in robot.effectors}
    return all(
        farthest < near - CLEAR or nearest > far + CLEAR
        for nearest, farthest in map(distances, chains)
    )


def is_reached(family: SmallFamily, poses: int, seed: int) -> bool:
    """Whether random poses have an effector well within the target."""
    rng = np.random.default_rng(seed)
    chains = dict.fromkeys(chain for robot in family.robots() for chain in robot.effectors)
    return any(_hits(family.slabs, chain, poses, rng) for chain in chains)


def tips(chain: Chain, poses: int, rng: np.random.Generator) -> Array:
    """Where the effector at the end of a chain is, in poses and with lengths at random."""
    frames = np.tile(np.eye(4), (poses, 1, 1))
    for part in chain:
        for step in part.steps:
            frames = frames @ step.frames(rng.uniform(step.low, step.high, poses))
    return frames[:, :3, 3]


def _hits(slabs: Sequence[Slab], chain: Chain, poses: int, rng: np.random.Generator) -> bool:
    reached = tips(chain, poses, rng)
    inside = np.ones(poses, dtype=bool)
    for slab in slabs:
        across = reached[:, : len(slab.normal)] @ np.array(slab.normal)
        inside &= np.abs(across - slab.middle) < slab.half - CLEAR
    return bool(inside.any())
