"""The claims of a certificate of *found* about the objectives of its task.

Each objective has a value and a lower bound: no robot that keeps the limits set by the objectives
before it has less. The evidence is that all structures that might have less are refuted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from compiler.expressions.exact_numbers import exact_number
from solvers.verifier.claims.json_fields import number, objects, text, texts
from solvers.verifier.claims.lemma_claims import LemmaClaim, lemma_claim
from solvers.verifier.claims.structure_claims import StructureClaim, structure_claims


@dataclass(frozen=True, slots=True)
class ObjectiveValue:
    """The design's value of an ``objective``, written as in the task, and the ``least`` of robots.

    Both are exact numbers in SI units; for ``effort`` they are shares.
    """

    objective: str
    value: str
    least: str


@dataclass(frozen=True, slots=True)
class TimeClaim:
    """No robot with at most ``modules`` modules does the task in ``steps`` steps or fewer.

    ``structures`` and ``lemmas`` are as in an ``ImpossibleClaim``, about the task with at most this
    many steps; all structures are refuted by coverings.
    """

    steps: int
    modules: int | None
    structures: tuple[StructureClaim, ...]
    lemmas: tuple[LemmaClaim, ...]


@dataclass(frozen=True, slots=True)
class ObjectivesClaim:
    """The objectives of a task, in order, and the evidence for their least values.

    It is about robots with at most ``modules`` modules; None: any number. ``structures`` and
    ``lemmas`` are as in an ``ImpossibleClaim``, all with coverings; robots of the ``dearer`` words
    do not have less for any parameters. The least ``time`` has evidence of its own.
    """

    values: tuple[ObjectiveValue, ...]
    modules: int | None
    structures: tuple[StructureClaim, ...]
    dearer: tuple[tuple[str, ...], ...]
    lemmas: tuple[LemmaClaim, ...]
    time: TimeClaim | None = None
    kind: str = "objectives"


def objectives_claim(item: dict[str, Any]) -> ObjectivesClaim:
    """The objectives of a JSON object.

    Raises:
        TypeError, KeyError, ValueError: the object is malformed.
    """
    (fields,) = objects([item], ObjectivesClaim)
    dearer, time = fields["dearer"], fields["time"]
    if not isinstance(dearer, list):
        raise TypeError("a list of words is expected")
    return ObjectivesClaim(
        tuple(_value(each) for each in objects(fields["values"], ObjectiveValue)),
        None if fields["modules"] is None else number(fields["modules"]),
        structure_claims(fields["structures"]),
        tuple(texts(word) for word in dearer),
        _lemmas(fields["lemmas"]),
        None if time is None else _time(time),
    )


def _time(content: object) -> TimeClaim:
    (fields,) = objects([content], TimeClaim)
    return TimeClaim(
        number(fields["steps"]),
        None if fields["modules"] is None else number(fields["modules"]),
        structure_claims(fields["structures"]),
        _lemmas(fields["lemmas"]),
    )


def _lemmas(items: object) -> tuple[LemmaClaim, ...]:
    if not isinstance(items, list) or not all(isinstance(each, dict) for each in items):
        raise TypeError("a list of lemmas is expected")
    return tuple(lemma_claim(each) for each in items)


def _value(fields: dict[str, Any]) -> ObjectiveValue:
    found = ObjectiveValue(*(text(fields[key]) for key in ("objective", "value", "least")))
    if exact_number(found.least) > exact_number(found.value):
        raise ValueError(f"the least of `{found.objective}` is more than its value")
    return found


def objective_entries(
    values: Sequence[ObjectiveValue], units: Sequence[str]
) -> list[dict[str, Any]]:
    """The entries of ``design.json`` for objectives whose values have these units."""
    return [
        {
            "objective": each.objective,
            "value": float(exact_number(each.value)),
            "least": float(exact_number(each.least)),
            "unit": unit,
        }
        for each, unit in zip(values, units, strict=True)
    ]
