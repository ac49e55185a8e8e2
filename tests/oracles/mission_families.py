"""Random small families with a mission whose verdict and least cost brute force and algebra say.

Families that have an arm at the border of what it can do are drawn again, and those whose mission
is not of the class that its seed asks for.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import cos, pi, sin

from tests.oracles.mission_answers import Answer, Wanted, answer, is_wanted
from tests.oracles.mission_arms import Arm, Box, Post, Task, Unclear
from tests.oracles.mission_grammars import (
    Grammar,
    Kinds,
    Word,
    above,
    below,
    branches,
    conditions,
    finite,
    once,
)
from tests.oracles.mission_intervals import Continuous
from tests.oracles.mission_robots import Prices, Robot

STYLES = (
    "chain", "choices", "interval", "bases", "branch", "choices", "drives", "joints", "interval",
    "from",
)  # fmt: skip
CLASSES: tuple[Wanted, ...] = ("impossible", "changes", "shared", "any", "shared")
CHOSEN = "choices", "interval", "from"
"""Styles with parameters, whose values tasks may have to share; others are to have changes."""
DRAWS = 500
PRICES = [("1", "1"), ("2", "1"), ("0.75", "0.25"), ("3", "0.1"), ("0", "1"), ("1/3", "0.5")]
WISHES = [
    ("sum(price)",), ("modules", "sum(price)"), ("sum(price)", "modules"),
    ("sum(price) within 20 %", "modules"),
]  # fmt: skip


@dataclass(frozen=True)
class Kind:
    """A module; its length is one of ``lengths``, or from the first to the last ``between``."""

    name: str
    role: str
    price: Fraction
    mass: Fraction = Fraction(0)
    lengths: tuple[Fraction, ...] = ()
    between: bool = False
    place: tuple[int, int] = (0, 0)

    @property
    def is_chosen(self) -> bool:
        """Whether its length is a parameter."""
        return len(self.lengths) > 1


@dataclass
class MissionFamily:
    """A family with its mission; ``text`` is the specification, ``answer`` what is true of it."""

    seed: int
    style: str = field(init=False)
    wanted: Wanted = field(init=False)
    is_wanted: bool = field(init=False)

    def __post_init__(self) -> None:
        self.choose = random.Random(f"missions {self.seed}")
        self.style = STYLES[self.seed % 10]
        self.one_robot = self.seed // 10 % 2 == 0 and self.style != "from"
        self.wanted = CLASSES[self.seed // 20 % 5]
        if self.wanted == "shared" and self.style not in CHOSEN:
            self.wanted = "changes"
        for draw in range(2 * DRAWS):
            self._draw()
            try:
                self.answer = self._answer()
            except Unclear:
                continue
            self.is_wanted = is_wanted(self.answer, self.wanted)
            if self.is_wanted or draw >= DRAWS:
                return
        raise AssertionError(f"nothing was drawn for seed {self.seed}")

    # --- what is drawn ---------------------------------------------------------------------------

    def _draw(self) -> None:
        choose = self.choose
        self.kinds = {kind.name: kind for kind in self._kinds()}
        names = {
            role: tuple(k.name for k in self.kinds.values() if k.role == role)
            for role in ("base", "joint", "link")
        }
        most = 2 if self.style == "interval" else choose.choice([2, 3, 3, 4])
        own = Kinds(names["base"], names["joint"], names["link"], most)
        if self.style == "branch":
            own = Kinds(own.bases, own.joints, own.links, choose.choice([1, 2]))
        self.grammar = self._grammar(own)
        longest = max(map(len, self.grammar.words))
        self.bounded = self.form != "finite"
        count = choose.choice([2, 2, 2, 3, 4])
        self.halls = choose.choice([1, 1, 2])
        self.tasks = [self._task("ABCD"[n], longest) for n in range(count)]
        self.prices = self._prices()
        self.most: Fraction | None = None
        self.wishes = choose.choice(WISHES)
        self.existing = self._existing()

    def _kinds(self) -> Iterator[Kind]:
        choose, style = self.choose, self.style
        for n in range(2 if style == "bases" else 1):
            place = (choose.randint(-40, 40), choose.randint(-40, 40))
            if n:
                place = (choose.choice([-120, 120]), choose.randint(-60, 60))
            yield Kind(f"Base{n}" if n else "Base", "base", self._price(), place=place)
        for n in range(2 if style in ("chain", "joints") and choose.random() < 0.5 else 1):
            yield Kind(f"J{n}" if n else "J", "joint", self._price(), Fraction(1, 10))
        for name in "LKM"[: 2 if style == "interval" else choose.choice([2, 3])]:
            mass = Fraction(choose.randint(5, 40), 100)
            if style == "drives":
                mass *= choose.choice([1, 10])
            yield Kind(name, "link", self._price(), mass, *self._lengths(name))
        yield Kind("Hand", "effector", self._price())

    def _price(self) -> Fraction:
        return Fraction(self.choose.choice([0, 50, 100, 125, 200, 333, 1000]), 100)

    def _lengths(self, name: str) -> tuple[tuple[Fraction, ...], bool]:
        choose = self.choose
        if self.style in ("choices", "from") and (name == "L" or choose.random() < 0.5):
            some = sorted(choose.sample(range(20, 100, 5), choose.choice([2, 3])))
            return tuple(Fraction(length, 100) for length in some), False
        if self.style == "interval" and (name == "L" or choose.random() < 0.4):
            low = choose.randrange(20, 60, 5)
            return (Fraction(low, 100), Fraction(low + choose.choice([20, 40, 60]), 100)), True
        return (Fraction(choose.randrange(20, 100), 100),), False

    def _grammar(self, own: Kinds) -> Grammar:
        choose = self.choose
        condition = choose.choice(conditions(own))
        forms = {"branch": ["branches"], "joints": ["pairs"], "from": ["once"]}
        self.form = choose.choice(forms.get(self.style, ["below", "above", "finite"]))
        blocks = [*self._blocks()]
        match self.form:
            case "branches":
                found = branches(own, condition, blocks)
            case "pairs":
                found = below(own, condition, blocks, 2)
            case "once":
                found = once(own, blocks)
            case "below":
                found = below(own, condition, blocks)
            case "above":
                found = above(own, condition, blocks)
            case _:
                found = finite(own, blocks)
        return found if found.words else self._grammar(own)

    def _task(self, name: str, longest: int) -> Task:
        choose = self.choose
        robot = choose.choice(list(self.robots_of(choose.choice(self.grammar.words))))
        arm = choose.choice(self.arms(robot))
        far = sum(arm.lengths)
        if len(arm.joints) > 1:
            far *= choose.uniform(0.6, 1)
        base, angle = arm.base, choose.uniform(-pi, pi)
        turn = choose.choice([-1, 1]) * choose.uniform(0.7, 1.9)
        half = choose.randint(4, 10)
        places = [
            Box(
                round(100 * (base[0] + far * cos(way))), round(100 * (base[1] + far * sin(way))),
                half,
            )
            for way in (angle, angle + turn)
        ]  # fmt: skip
        task = {"name": name, "hall": choose.randrange(self.halls)}
        modules = None
        if self.bounded:
            modules = longest - (choose.random() < 0.25 and longest > 5)
        post = None
        if self.style == "bases" and choose.random() < 0.7:
            middle = choose.uniform(0.4, 0.6) * far
            x, y = base[0] + middle * cos(angle), base[1] + middle * sin(angle)
            post = Post(Box(round(100 * x), round(100 * y), choose.randint(12, 16)))
        effort, payload, steps = 50, Fraction(0), 10
        if self.style == "drives":
            effort, steps = choose.choice([1, 2, 4]), 10
            payload = Fraction(choose.choice([0, 0, 1, 4]), 2)
        return Task(
            **task, home=places[0], shelf=places[1], effort=effort, payload=payload, steps=steps,
            modules=modules, post=post,
        )  # fmt: skip

    def _prices(self) -> Prices:
        choose = self.choose
        add, remove = (Fraction(each) for each in choose.choice(PRICES))
        free = frozenset[str]()
        chosen = [kind.name for kind in self.kinds.values() if kind.is_chosen]
        if chosen and choose.random() < 0.5:
            free = frozenset(choose.sample(chosen, choose.randint(1, len(chosen))))
        change = Fraction(choose.choice(["0", "0.5", "0.3", "2"])) if free else Fraction(0)
        return Prices(add, remove, change, free)

    def _existing(self) -> Robot | None:
        """A robot that there is, some of whose lengths are known."""
        choose = self.choose
        if self.one_robot or (self.style != "from" and choose.random() < 0.8):
            return None
        word = choose.choice(self.grammar.words)
        robot = list[tuple[str, Fraction | None]]()
        for name in word:
            kind = self.kinds[name]
            known = self.style == "from" and kind.is_chosen and choose.random() < 0.5
            robot.append((name, choose.choice(kind.lengths) if known else None))
        return tuple(robot)

    # --- robots ----------------------------------------------------------------------------------

    def robots_of(self, word: Word) -> Iterator[Robot]:
        """The robots of a word, of lengths in intervals the ends."""
        choices = [
            [(name, length) for length in self.kinds[name].lengths]
            if self.kinds[name].is_chosen
            else [(name, None)]
            for name in word
        ]
        yield from product(*choices)

    def arms(self, robot: Robot) -> list[Arm]:
        """The arms of a robot, each on its own."""
        base = self.kinds[robot[0][0]]
        found, joints, lengths, masses = list[Arm](), list[int](), list[float](), list[float]()
        for name, value in robot[1:]:
            kind = self.kinds[name]
            if kind.role == "joint":
                joints.append(0)
            elif kind.role == "link":
                joints[-1] += 1
                lengths.append(float(kind.lengths[0] if value is None else value))
                masses.append(float(kind.mass))
            else:
                place = base.place[0] / 100, base.place[1] / 100
                found.append(Arm(place, tuple(joints), tuple(lengths), tuple(masses)))
                joints, lengths, masses = [], [], []
        return found

    def does(self, robot: Robot, task: Task) -> bool:
        """Whether a robot does a task."""
        return any(arm.does(task) for arm in self.arms(robot))

    def layer(self, task: Task) -> list[Word]:
        """The words of as many modules as a task allows."""
        words = self.grammar.words
        return [w for w in words if task.modules is None or len(w) <= task.modules]

    def able(self, number: int) -> list[Robot]:
        """The robots that do a task; before the first one lengths that are known are kept."""
        task = self.tasks[number]
        fixed = {} if number or self.existing is None else dict(self.existing)
        return [
            robot
            for word in self.layer(task)
            for robot in self.robots_of(word)
            if all(fixed.get(name) in (None, value) for name, value in robot)
            and self.does(robot, task)
        ]

    @cached_property
    def robots(self) -> int:
        """How many structures there are in all layers."""
        return sum(len(self.layer(task)) for task in self.tasks)

    def price(self, robot: Robot) -> Fraction:
        """The sum of the prices of its modules."""
        return sum((self.kinds[name].price for name, _ in robot), Fraction(0))

    def continuous(self) -> Continuous:
        """The same with lengths from intervals."""
        base = self.kinds["Base"].place
        spans = {
            kind.name: (float(kind.lengths[0]), float(kind.lengths[-1]))
            for kind in self.kinds.values()
            if kind.role == "link"
        }
        rings = [
            tuple(box.distances((base[0] / 100, base[1] / 100)) for box in task.regions)
            for task in self.tasks
        ]
        needed = [(max(near for near, _ in each), min(far for _, far in each)) for each in rings]
        return Continuous(
            tuple(map(tuple, map(self.layer, self.tasks))), tuple(needed), spans,
            frozenset(kind.name for kind in self.kinds.values() if kind.is_chosen), self.prices,
            self.existing,
        )  # fmt: skip

    def _answer(self) -> Answer:
        """What is true, and a bound on changes chosen by it."""
        found = answer(self)
        bounded = self.choose.random() < 0.4 or self.wanted == "impossible"
        if self.one_robot or found.least is None or not bounded:
            return found
        way = self.choice_of_bound()
        if way == "below":
            if not found.least[0]:
                return found
            self.most = found.least[0] * Fraction(9, 10)
            return Answer("impossible", None, found.blind, found.alone)
        self.most = found.least[0] + (1 if way == "above" else 0)
        return found

    def choice_of_bound(self) -> str:
        """Whether the bound on changes is below the least, at it, or above it."""
        if self.wanted == "impossible":
            return "below"
        return self.choose.choice(["at", "above"])

    # --- the specification -----------------------------------------------------------------------

    def _blocks(self) -> Iterator[str]:
        """The semantics of the productions."""
        grown = self.form in ("below", "pairs", "once")
        bases = [kind for kind in self.kinds.values() if kind.role == "base"]
        for n, base in enumerate(bases):
            x, y = (Fraction(c, 100) for c in base.place)
            frame = f"world * move(x, {float(x)} m) * move(y, {float(y)} m)"
            under = "left.at = {0}; right.at = {0};" if self.form == "branches" else "A.at = {0};"
            yield f"b{n} {{ {(f'this.frame = {frame};' if grown else under.format(frame))} }}"
        for kind in self.kinds.values():
            if kind.role != "base":
                yield from self._block(kind, grown=grown)

    def _block(self, kind: Kind, *, grown: bool) -> Iterator[str]:
        name, start = kind.name, "Arm.frame" if grown else "this.at"
        if kind.role == "effector":
            label, kept = ("pHand", "this.frame = Arm.frame; ") if grown else ("hand", "")
            yield f"{label} {{ {kept}effector(frame: {start}); }}"
            return
        turn = f"rot(z, {name}.q)" if kind.role == "joint" else f"move(x, {name}.length)"
        end = f"{start} * {turn}"
        body = f"point(frame: {end if kind.role == 'link' else start}, mass: {name}.weight);"
        if kind.role == "link" and self.style == "bases":
            body = f"rod(frame: {start}, axis: x, length: {name}.length, density: 0.3 kg/m);"
        if grown:
            yield f"p{name} {{ this.frame = {end}; {body} }}"
            return
        yield f"p{name} {{ {self._under(kind)}.at = {end}; {body} }}"
        if kind.role == "link":
            yield f"q{name} {{ H.at = {end}; {body} }}"
        if kind.role == "link" and self.form == "finite":
            yield f"r{name} {{ H.at = {end}; {body} }}"

    def _under(self, kind: Kind) -> str:
        return "T" if kind.role == "link" and self.form == "finite" else "S"

    @property
    def text(self) -> str:
        """The family, its tasks and the mission."""
        from tests.oracles.mission_text import family_text

        return family_text(self)
