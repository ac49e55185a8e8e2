"""What claims about missions are true, and what their evidence shows, by algebra and brute force.

Families here have finitely many robots.  A structure or a box that is said to be refuted has to be
without robots that do the task; the bound has to follow from what is said to be refuted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

from tests.oracles.mission_families import MissionFamily
from tests.oracles.mission_robots import Robot, cheapest, rebuilding
from tests.oracles.result_files import read

Content = dict[str, Any]


class ClaimError(Exception):
    """A claim is false, or its evidence does not show it."""


@dataclass(frozen=True)
class Judge:
    """A family, and the claim of its result as it was written; lemmas are in none of them."""

    family: MissionFamily
    original: Content

    @cached_property
    def able(self) -> list[set[Robot]]:
        """The robots that do each task."""
        return [set(self.family.able(k)) for k in range(len(self.family.tasks))]

    @cached_property
    def every(self) -> list[list[Robot]]:
        """All robots of each layer; before the first task lengths that are known are kept."""
        family = self.family
        fixed = dict(family.existing or ())
        return [
            [
                robot
                for word in family.layer(task)
                for robot in family.robots_of(word)
                if number or all(fixed.get(name) in (None, value) for name, value in robot)
            ]
            for number, task in enumerate(family.tasks)
        ]

    def accepted(self, folder: Path) -> bool | None:
        """Whether a claim has to be accepted or refused; None: both are right."""
        claim = read(folder, "mission.json")
        try:
            designs = [] if claim["kind"] == "impossible" else self._designs(folder)
            self._check_found(claim, designs) if designs else self._check_none(claim)
        except ClaimError:
            return False
        same = all(claim[key] == self.original[key] for key in ("tasks", "boxes", "existing"))
        return True if same else None

    # --- designs ---------------------------------------------------------------------------------

    def _designs(self, folder: Path) -> list[Robot]:
        return [
            self._design(folder / "tasks" / task.name, k)
            for k, task in enumerate(self.family.tasks)
        ]

    def _design(self, folder: Path, number: int) -> Robot:
        found = read(folder)
        values = {p["symbol"]: Fraction(p["value"]) for p in found["parameters"]}
        robot = tuple(
            (name, values.get(index))
            for index, name in enumerate(found["word"])
            if name in self.family.kinds
        )
        if found["task"] != self.family.tasks[number].name or robot not in self.able[number]:
            raise ClaimError
        return robot

    def _check_found(self, claim: Content, designs: list[Robot]) -> None:
        family, true = self.family, self.family.answer.least
        assert true is not None
        if family.one_robot:
            if len(set(designs)) > 1 or claim["cost"] is not None:
                raise ClaimError
            stated = [(Fraction(v["value"]), Fraction(v["least"])) for v in claim["objectives"]]
            words = {tuple(name for name, _ in designs[0])}
            has = self._values(next(iter(words)))
            if [value for value, _ in stated] != has:
                raise ClaimError
            if any(least > most for (_, least), most in zip(stated, true, strict=True)):
                raise ClaimError
            if any(least > 0 for _, least in stated):
                self._check_one(claim, stated)
            return
        cost, least = Fraction(claim["cost"]), Fraction(claim["least"])
        chain = [*([family.existing] if family.existing else []), *designs]
        steps = pairwise(chain)
        if cost != sum(rebuilding(a, b, family.prices) for a, b in steps):
            raise ClaimError
        if least > true[0] or (least > 0 and self._bound(claim) < least):
            raise ClaimError

    def _values(self, word: tuple[str, ...]) -> list[Fraction]:
        price = self.family.price(tuple((name, None) for name in word))
        return [price if w.startswith("sum") else Fraction(len(word)) for w in self.family.wishes]

    def _check_one(self, claim: Content, stated: list[tuple[Fraction, Fraction]]) -> None:
        """No robot that is left in all tasks has less, within what is first."""
        for robot in self._common(claim):
            values = self._values(tuple(name for name, _ in robot))
            for k, (_, least) in enumerate(stated):
                within = all(v <= s for v, (s, _) in zip(values[:k], stated, strict=False))
                if within and values[k] < least:
                    raise ClaimError

    def _check_none(self, claim: Content) -> None:
        if (
            self.family.answer.verdict == "found"
            or claim["cost"] is not None
            or claim["objectives"]
        ):
            raise ClaimError
        if self.family.one_robot:
            if self._common(claim):
                raise ClaimError
            return
        most = self.family.most
        bound = self._bound(claim)
        if bound < 10**9 and (most is None or bound <= most):
            raise ClaimError

    # --- evidence --------------------------------------------------------------------------------

    def _common(self, claim: Content) -> set[Robot]:
        layers = [set(layer) for layer in self._open(claim)]
        return layers[0].intersection(*layers[1:])

    def _bound(self, claim: Content) -> Fraction:
        """What chains of robots that are left cost at least."""
        layers = self._open(claim)
        family = self.family
        found = cheapest(layers, lambda a, b: rebuilding(a, b, family.prices), family.existing)
        return Fraction(10**9) if found is None else found

    def _open(self, claim: Content) -> list[list[Robot]]:
        """The robots of each task that nothing is said to refute.

        Raises:
            ClaimError: one that does the task is said to be refuted, or evidence is of nothing.
        """
        names = [task.name for task in self.family.tasks]
        if [each["task"] for each in claim["tasks"]] != names:
            raise ClaimError
        refuted = [set[Robot]() for _ in names]
        for k, each in enumerate(claim["tasks"]):
            assert not each["lemmas"]
            for structure in each["structures"]:
                word = self._word(structure["word"])
                some = {r for r in self.every[k] if tuple(n for n, _ in r) == word}
                if some & self.able[k]:
                    raise ClaimError
                refuted[k] |= some
        for boxes in claim["boxes"]:
            for k, robot in self._refuted_boxes(boxes):
                for j in range(len(names)) if boxes["task"] is None else [k]:
                    refuted[j].add(robot)
                if robot in self.able[k]:
                    raise ClaimError
        return [
            [robot for robot in layer if robot not in gone]
            for layer, gone in zip(self.every, refuted, strict=True)
        ]

    def _word(self, symbols: list[str]) -> tuple[str, ...]:
        return tuple(name for name in symbols if name in self.family.kinds)

    def _refuted_boxes(self, boxes: Content) -> Iterator[tuple[int, Robot]]:
        """The robots in boxes that are said to be refuted, with the numbers of the tasks."""
        word, first = self._word(boxes["word"]), boxes["task"] or 0
        if not 0 <= first < len(self.every):
            raise ClaimError
        for robot in self.every[first]:
            if tuple(name for name, _ in robot) == word:
                for leaf in self._leaves(boxes["tree"], robot, first):
                    task = leaf["task"]
                    if not 0 <= task < len(self.every) or boxes["task"] not in (None, task):
                        raise ClaimError
                    yield task, robot

    def _leaves(self, tree: Content | None, robot: Robot, layer: int) -> Iterator[Content]:
        """The leaf that a robot is in, if that is said to be refuted."""
        choices = [self._domain(name, layer) for name, value in robot if value is not None]
        values = [value for _, value in robot if value is not None]
        while tree is not None and "parts" in tree:
            place, at = tree["parameter"], tree["at"]
            if not 0 <= place < len(values) or not isinstance(at, int) or len(tree["parts"]) != 2:
                raise ClaimError
            if not 0 < at < len(choices[place]):
                raise ClaimError
            above = choices[place].index(values[place]) >= at
            choices[place] = choices[place][at:] if above else choices[place][:at]
            tree = tree["parts"][above]
        if tree is not None:
            yield tree

    def _domain(self, name: str, layer: int) -> tuple[Fraction, ...]:
        fixed = {} if layer else dict(self.family.existing or ())
        value = fixed.get(name)
        return self.family.kinds[name].lengths if value is None else (value,)
