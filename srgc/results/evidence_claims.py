"""The claims of a certificate about structures and lemmas, and the files of their evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from compiler.expressions.exact_numbers import exact_decimal, exact_text
from solvers.conclusion import StructureRecord
from solvers.lemma import Lemma, VariantLemma, WeightsLemma
from solvers.search.objective_result import Optimality
from solvers.search.robustness_bound import RobustnessBound
from solvers.search.time_bound import TimeBound
from solvers.verifier.claims.bound_claims import BoundClaim
from solvers.verifier.claims.lemma_claims import LemmaClaim
from solvers.verifier.claims.objective_claims import ObjectivesClaim, ObjectiveValue, TimeClaim
from solvers.verifier.claims.structure_claims import StructureClaim

PROOFS, BOUND, LEAST, TIME = "proofs", "proofs/bound", "proofs/least", "proofs/time"
"""The folders of evidence that refutes structures.

In order: in the task itself, with narrower bounds on the inputs, for structures that may have less
of an objective, and in less time.
"""


@dataclass(frozen=True, slots=True)
class Evidence:
    """Structures and lemmas, with their evidence in files of one ``folder``."""

    records: Sequence[StructureRecord]
    lemmas: Sequence[Lemma]
    folder: str = PROOFS

    def files(self) -> dict[str, str]:
        """Maps the names of files to the evidence in them."""
        found: dict[str, str] = {}
        for index, record in enumerate(self.records):
            if record.script is not None:
                found[self.script_name(index)] = record.script
            if record.boxes is not None:
                found[self.boxes_name(index)] = record.boxes
        for lemma in self.lemmas:
            if isinstance(lemma, WeightsLemma):
                found[self.weights_name(self._places[lemma.labels])] = lemma.boxes
        return found

    def script_name(self, index: int) -> str:
        """The file of the script that refutes the structure with that index."""
        return f"{self.folder}/{index:04d}.smt2"

    def boxes_name(self, index: int) -> str:
        """The file of the covering that refutes the structure with that index."""
        return f"{self.folder}/{index:04d}.boxes"

    def weights_name(self, index: int) -> str:
        """The file of the covering for the structure with that index and all weights possible."""
        return f"{self.folder}/{index:04d}.weights.boxes"

    @property
    def _places(self) -> dict[tuple[str, ...], int]:
        """Maps each derivation to the index of its structure."""
        return {record.derivation: i for i, record in enumerate(self.records)}

    def lemma_claims(self) -> tuple[LemmaClaim, ...]:
        """The lemmas; those about variants of a robot have the evidence of that robot."""
        places = self._places
        found: list[LemmaClaim] = []
        for lemma in self.lemmas:
            if isinstance(lemma, VariantLemma):
                script, _, boxes = self.of(places[lemma.labels])
                found.append(lemma.claim(script, boxes))
            elif isinstance(lemma, WeightsLemma):
                found.append(lemma.claim(self.weights_name(places[lemma.labels])))
            else:
                found.append(lemma.claim())
        return tuple(found)

    def structure_claims(self) -> tuple[StructureClaim, ...]:
        """The structures that no lemma covers; duplicates refer to their index in this tuple."""
        alone = [i for i, record in enumerate(self.records) if record.lemma is None]
        place = {index: number for number, index in enumerate(alone)}
        found: list[StructureClaim] = []
        for index in alone:
            script, same, boxes = self.of(index)
            record = self.records[index]
            first = None if same is None else place[same]
            found.append(StructureClaim(record.word, record.derivation, script, first, boxes))
        return tuple(found)

    def of(self, index: int) -> tuple[str | None, int | None, str | None]:
        """The script of a structure, the structure whose robot it repeats, and its covering."""
        record = self.records[index]
        first = index if record.same_robot_as is None else record.same_robot_as
        judged = self.records[first]
        script = self.script_name(first) if judged.script is not None else None
        boxes = self.boxes_name(first) if judged.boxes is not None else None
        return script, record.same_robot_as, boxes


def bound_evidence(bound: RobustnessBound) -> Evidence:
    """The evidence of a bound."""
    return Evidence(bound.evidence.records, bound.evidence.lemmas, BOUND)


def bound_claim_of(bound: RobustnessBound) -> BoundClaim:
    """A bound as a certificate states it."""
    rests_on = bound_evidence(bound)
    return BoundClaim(
        exact_decimal(bound.share), bound.evidence.modules, rests_on.structure_claims(),
        rests_on.lemma_claims(),
    )  # fmt: skip


def least_evidence(found: Optimality) -> Evidence:
    """The evidence of the least values of all objectives except time."""
    return Evidence(found.records, found.lemmas, LEAST)


def time_evidence(bound: TimeBound) -> Evidence:
    """The evidence of a bound on the time."""
    return Evidence(bound.evidence.records, bound.evidence.lemmas, TIME)


def optimality_files(found: Optimality) -> dict[str, str]:
    """Maps the names of files to the evidence of all objectives."""
    timed = {} if found.time is None else time_evidence(found.time).files()
    return least_evidence(found).files() | timed


def objectives_claim_of(found: Optimality) -> ObjectivesClaim:
    """The objectives of a design as a certificate states them."""
    rests_on = least_evidence(found)
    values = tuple(
        ObjectiveValue(each.amount.text, exact_text(each.value), exact_text(each.least))
        for each in found.objectives
    )
    return ObjectivesClaim(
        values, found.modules, rests_on.structure_claims(), found.dearer, rests_on.lemma_claims(),
        None if found.time is None else _time_claim(found.time),
    )  # fmt: skip


def _time_claim(bound: TimeBound) -> TimeClaim:
    rests_on = time_evidence(bound)
    return TimeClaim(
        bound.steps, bound.evidence.modules, rests_on.structure_claims(), rests_on.lemma_claims()
    )
