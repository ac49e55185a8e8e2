"""The conditions of ``carry`` clauses on a motion, or on all disturbed motions.

The inputs state the sample at which a load is taken up and the one at which it is put down. The
effector has to be in the source region at the first and in the target region at the second, with
all joint rates below a bound. The rates do not jump at these samples: taking up or putting down a
load changes no rate.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from flint import arb

from compiler.tasks.carrying import transfer_of
from grammar_lang import ir
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.end_conditions import final_rates, known_at, slow_at
from solvers.verifier.proofs.point_map import PointMap
from solvers.verifier.proofs.scene import Motion, Scene
from solvers.verifier.proofs.tube_checks import Inside, Status, rows_of
from solvers.verifier.proofs.zonotope import Zonotope


def load_name(task: ir.Task, number: int) -> str:
    """The name of a load, numbered from 0; if there are several, it contains the effector."""
    return "load" if len(task.carries) == 1 else f"load {task.carries[number].effector or 1}"


def transfer_names(task: ir.Task) -> frozenset[str]:
    """The names of all conditions on the samples at which loads are taken up and put down."""
    pairs = [_names(task, number, taken=taken) for number, taken in _events(task)]
    return frozenset(name for pair in pairs for name in pair)


def _events(task: ir.Task) -> list[tuple[int, bool]]:
    return [(number, taken) for number in range(len(task.carries)) for taken in (True, False)]


def _names(task: ir.Task, number: int, *, taken: bool) -> tuple[str, str]:
    """The names of the conditions on the place and on the rates."""
    carry, name = task.carries[number], load_name(task, number)
    what = f"{name} taken up" if taken else f"{name} put down"
    return f"{what} in {carry.source if taken else carry.target}", f"rates, {what}"


def transfers(motion: Motion, task: ir.Task) -> list[tuple[int, int] | None]:
    """For each load, the samples at which it is taken up and put down; None for invalid inputs.

    The loads are the last inputs.
    """
    first = len(motion.inputs[0]) - len(task.carries)
    columns = zip(*(row[first:] for row in motion.inputs), strict=True)
    return [transfer_of(column) for column in columns]


def load_conditions(scene: Scene, motion: Motion) -> list[CheckedCondition]:
    """A failing condition for each load that the inputs do not carry between two fixed samples.

    The inputs of a load must not depend on measurements either.
    """
    found, law, task = list[CheckedCondition](), motion.law, scene.task
    first = len(motion.inputs[0]) - len(task.carries)
    for number, samples in enumerate(transfers(motion, task)):
        steered = False
        if law is not None:
            place = first + number
            steered = any(any(gain[place]) for gain in law.gains)
            steered |= any(law.rounding[place : place + 1])
        if samples is None or steered:
            name = f"{load_name(task, number)} carried from a sample to a later one"
            found.append(CheckedCondition(name, Status.FAILS, 0.0, ""))
    return found


@dataclass(slots=True)
class TransferConditions:
    """The ``carry`` clauses along a tube; ``sets`` holds the states at the samples that matter."""

    scene: Scene
    motion: Motion
    sets: dict[int, Zonotope] = field(default_factory=dict[int, Zonotope])
    _samples: frozenset[int] = field(init=False)

    def __post_init__(self) -> None:
        found = transfers(self.motion, self.scene.task)
        self._samples = frozenset(sample for each in found if each is not None for sample in each)

    def add(self, sample: int, states: Zonotope | None) -> None:
        """Keep the states at a sample if they matter."""
        if states is not None and sample in self._samples:
            self.sets[sample] = states

    def conditions(
        self, point_map: PointMap, samples: Sequence[Sequence[arb]]
    ) -> Iterator[CheckedCondition]:
        """The conditions for a complete tube; ``samples`` are boxes of states at all samples."""
        task, workspace = self.scene.task, self.scene.workspace
        for number, transfer in enumerate(transfers(self.motion, task)):
            carry = task.carries[number]
            for taken in (True, False):
                names = _names(task, number, taken=taken)
                if transfer is None:
                    yield from (CheckedCondition(n, Status.FAILS, -NO_MARGIN, "") for n in names)
                    continue
                sample = transfer[0] if taken else transfer[1]
                region = workspace.region(carry.source if taken else carry.target)
                rows = rows_of(self.scene.polytope(region))
                place = Inside(names[0], ((carry.effector or 1) - 1,), rows=rows)
                rates = replace(final_rates(self.scene.graph, carry.rates), name=names[1])
                known = samples[sample], self.sets.get(sample), float(task.step * sample)
                yield known_at(point_map, place, *known)
                yield slow_at(rates, *known)
