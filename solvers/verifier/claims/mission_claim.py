"""The claim of ``mission.json``: designs for all tasks and their cost, or that no designs exist.

The designs are results of their own, below ``tasks``. Evidence about robots that cannot do a task
is stored with the task: structures and lemmas as in a certificate of *impossible*, and boxes of the
parameters of single structures.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal, TypeAlias

from solvers.verdict import Claimed
from solvers.verifier.claims.certificate import (
    CertificateError,
    ParameterClaim,
    SeparationClaim,
    checked_object,
    digest_of,
    separation_claim,
)
from solvers.verifier.claims.further_claims import claim_content
from solvers.verifier.claims.json_fields import expect_keys, number, objects, text, texts
from solvers.verifier.claims.lemma_claims import LemmaClaim, lemma_claim
from solvers.verifier.claims.structure_claims import StructureClaim, structure_claims

FORMAT = 1
MOST_DEPTH = 100
"""The most cuts in turn of a box; walking through a deeper tree would need too much stack."""


@dataclass(frozen=True, slots=True)
class ExistingClaim:
    """The robot that exists before the first task, with the parameters that are known of it.

    ``source`` says where it comes from: ``from`` of the first task, or a result folder.
    """

    word: tuple[str, ...]
    parameters: tuple[ParameterClaim, ...]
    source: str


@dataclass(frozen=True, slots=True)
class PosedClaim:
    """One step from an existing robot: the prices of changes, the free parameters, the price limit.

    ``free`` holds names of modules and of their parameters.
    """

    add: str
    remove: str
    change: str
    free: tuple[tuple[str, str], ...]
    most: str | None


@dataclass(frozen=True, slots=True)
class LeafClaim:
    """Boxes (a file) refute the robots of a leaf in the task with this number, from 0."""

    task: int
    boxes: str


@dataclass(frozen=True, slots=True)
class CutClaim:
    """A cut of a box: an interval at the decimal ``at``, or choices after the first ``at``."""

    parameter: int
    at: str | int
    parts: tuple[TreeClaim, TreeClaim]


TreeClaim: TypeAlias = "LeafClaim | CutClaim | None"
"""None stands for a leaf whose robots are not refuted."""


@dataclass(frozen=True, slots=True)
class BoxesClaim:
    """The boxes of a structure's parameters, for the task ``task``, or (None) for all tasks."""

    task: int | None
    word: tuple[str, ...]
    derivation: tuple[str, ...]
    tree: TreeClaim


@dataclass(frozen=True, slots=True)
class TaskClaim:
    """What is refuted in a task for all parameters; the files are below ``proofs/TASK``."""

    task: str
    structures: tuple[StructureClaim, ...]
    lemmas: tuple[LemmaClaim, ...]
    separation: SeparationClaim | None


@dataclass(frozen=True, slots=True)
class LeastClaim:
    """An objective as written, the robot's value of it, and the lower bound for all robots."""

    objective: str
    value: str
    least: str


@dataclass(frozen=True, slots=True)
class MissionClaim:
    """The claim about a ``mission`` of the spec, or about one task for which a step is ``posed``.

    ``cost`` is the price of all changes, ``least`` the lower bound of it for any robots. Both are
    None if one robot does all tasks. ``modules`` bounds the robots that the claim is about; None:
    the whole family.
    """

    kind: Claimed
    mission: str
    spec: str
    spec_sha256: str
    posed: PosedClaim | None
    modules: int | None
    existing: ExistingClaim | None
    cost: str | None
    least: str | None
    objectives: tuple[LeastClaim, ...]
    tasks: tuple[TaskClaim, ...]
    boxes: tuple[BoxesClaim, ...]


def mission_text(claim: MissionClaim) -> str:
    """The file of a claim."""
    content: dict[str, Any] = {"format": FORMAT, **asdict(claim)}
    content["tasks"] = [
        asdict(task) | {"lemmas": [claim_content(lemma) for lemma in task.lemmas]}
        for task in claim.tasks
    ]
    content["boxes"] = [asdict(each) | {"tree": _content(each.tree)} for each in claim.boxes]
    content["digest"] = digest_of(content)
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _content(tree: TreeClaim) -> dict[str, Any] | None:
    if isinstance(tree, CutClaim):
        parts = [_content(part) for part in tree.parts]
        return {"parameter": tree.parameter, "at": tree.at, "parts": parts}
    return None if tree is None else asdict(tree)


def mission_from_text(content: str) -> MissionClaim:
    """Read a claim.

    Raises:
        CertificateError: the text is not a claim of this format, or was altered since it was
            written.
    """
    found = checked_object(content)
    if found.get("format") != FORMAT or isinstance(found.get("format"), bool):
        raise CertificateError(f"the claim of the mission is not of format {FORMAT}")
    items = {key: value for key, value in found.items() if key not in ("format", "digest")}
    try:
        return _mission(items)
    except (TypeError, KeyError, ValueError, RecursionError) as error:
        why = error.args[0] if error.args else "nested too deeply"
        raise CertificateError(f"the claim of the mission is malformed: {why}") from None


def _mission(items: dict[str, Any]) -> MissionClaim:
    expect_keys(items, MissionClaim)
    kind: Literal["found", "impossible"]
    kind = "found" if items["kind"] == "found" else "impossible"
    if items["kind"] != kind:
        raise ValueError(f"it is of an unknown kind: {items['kind']!r}")
    for name in ("mission", "spec", "spec_sha256"):
        text(items[name])
    return MissionClaim(
        kind,
        items["mission"],
        items["spec"],
        items["spec_sha256"],
        _posed(items["posed"]),
        None if items["modules"] is None else number(items["modules"]),
        _existing(items["existing"]),
        _optional(items["cost"]),
        _optional(items["least"]),
        tuple(
            LeastClaim(text(each["objective"]), text(each["value"]), text(each["least"]))
            for each in objects(items["objectives"], LeastClaim)
        ),
        tuple(map(_task, objects(items["tasks"], TaskClaim))),
        tuple(map(_boxes, objects(items["boxes"], BoxesClaim))),
    )


def _optional(value: object) -> str | None:
    return None if value is None else text(value)


def _posed(content: object) -> PosedClaim | None:
    if content is None:
        return None
    (item,) = objects([content], PosedClaim)
    free = tuple((names[0], names[1]) for names in map(texts, item["free"]) if len(names) == 2)
    if len(free) != len(item["free"]):
        raise TypeError("a free parameter has two names")
    prices = text(item["add"]), text(item["remove"]), text(item["change"])
    return PosedClaim(*prices, free, _optional(item["most"]))


def _existing(content: object) -> ExistingClaim | None:
    if content is None:
        return None
    (item,) = objects([content], ExistingClaim)
    parameters = tuple(
        ParameterClaim(number(p["symbol"]), text(p["name"]), text(p["value"]))
        for p in objects(item["parameters"], ParameterClaim)
    )
    return ExistingClaim(texts(item["word"]), parameters, text(item["source"]))


def _task(item: Mapping[str, Any]) -> TaskClaim:
    lemmas = item["lemmas"]
    if not isinstance(lemmas, list) or not all(isinstance(each, dict) for each in lemmas):
        raise TypeError("a list of lemmas is expected")
    return TaskClaim(
        text(item["task"]),
        structure_claims(item["structures"]),
        tuple(map(lemma_claim, lemmas)),
        separation_claim(item["separation"]),
    )


def _boxes(item: Mapping[str, Any]) -> BoxesClaim:
    return BoxesClaim(
        None if item["task"] is None else number(item["task"]),
        texts(item["word"]),
        texts(item["derivation"]),
        _tree(item["tree"]),
    )


def _tree(content: object, depth: int = 0) -> TreeClaim:
    if depth > MOST_DEPTH:
        raise ValueError(f"a box is cut more than {MOST_DEPTH} times in turn")
    if content is None:
        return None
    if not isinstance(content, dict):
        raise TypeError("a box is an object, or null")
    if content.keys() == {item.name for item in fields(LeafClaim)}:
        return LeafClaim(number(content["task"]), text(content["boxes"]))
    expect_keys(content, CutClaim)
    at, parts = content["at"], content["parts"]
    if not isinstance(parts, list) or len(parts) != 2:
        raise TypeError("a box is cut in two parts")
    where = number(at) if isinstance(at, int) else text(at)
    halves = _tree(parts[0], depth + 1), _tree(parts[1], depth + 1)
    return CutClaim(number(content["parameter"]), where, halves)
