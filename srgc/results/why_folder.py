"""Reads a result folder for an explanation.

The folder makes no claim about what was tried: it is asked again.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from compiler.robots.normal_form import family_of
from compiler.words.derivation import BadDerivation
from grammar_lang import ir
from solvers.explanation.explanation import Nearest, Tried
from solvers.explanation.learnt_lines import learnt, robots_of_lemmas
from solvers.explanation.posed_task import PosedTask
from solvers.run_context import EVALUATIONS, PATHS, RunContext
from solvers.verdict import NotFound
from solvers.verifier.claims.certificate import CertificateError
from solvers.verifier.claims.lemma_claims import LemmaClaim, lemma_claim
from solvers.verifier.claims.spec_copy import bounded_bytes, bounded_text, read_copy
from srgc.paths import no_folder
from srgc.results.folder_writer import refuse_links
from srgc.results.lost_file import no_design
from srgc.results.mission_refusal import refuse_mission
from srgc.search_options import named_search, named_solver
from srgc.session import UsageFault


@dataclass(frozen=True, slots=True)
class TriedFolder:
    """The content of a result folder; ``tried`` is None if the folder has a design."""

    posed: PosedTask
    seed: int
    search: str | None
    solver: str | None
    paths: int
    evaluations: int
    tried: Tried | None
    lemmas: tuple[LemmaClaim, ...] = ()

    def context(self, out_of_time: Callable[[], bool]) -> RunContext:
        """The settings of the folder's synthesis, with another time limit."""
        return RunContext(
            seed=self.seed,
            search=self.search,
            solver=self.solver,
            paths=self.paths,
            evaluations=self.evaluations,
            out_of_time=out_of_time,
        )


def tried_folder(folder: Path) -> TriedFolder:
    """What was tried, according to a result folder.

    Raises:
        UsageFault: there are no results, they or the spec have been altered, or they name a
            solver or a search that is not available.
    """
    if not folder.is_dir():
        raise no_folder(folder)
    refuse_links(folder)
    refuse_mission(folder)
    path = folder / "design.json"
    if not path.exists():
        raise no_design(folder)
    try:
        content = json.loads(bounded_bytes(path))
        program, _ = read_copy(folder / "spec", content["spec"], content["spec_sha256"])
        return _read(folder, content, program)
    except OSError as error:
        raise UsageFault(f"{folder}: the results cannot be read: {error.strerror}") from None
    except CertificateError as error:
        raise UsageFault(f"{folder}: {error}".replace("the certificate", "design.json")) from None
    except (
        ArithmeticError, ValueError, LookupError, TypeError, AttributeError, RecursionError,
        csv.Error, BadDerivation,
    ):  # fmt: skip
        raise UsageFault(f"{path} is not what `srgc synth` writes") from None


def _read(folder: Path, content: Mapping[str, Any], program: ir.Program) -> TriedFolder:
    task = program.tasks[content["task"]]
    posed = PosedTask(program, task)
    claims = _lemmas(content)
    tried = None
    if content["verdict"] != "found":
        structures = content["structures_tried"]
        if any(one["verdict"] == "found" for one in structures):
            raise ValueError(content["verdict"])
        refuted = _refuted(posed, structures)
        tried = Tried(
            _verdict(content["verdict"]),
            _text(content["reason"]),
            (*refuted, *robots_of_lemmas(posed, claims, refuted)),
            _nearest(folder, structures),
            learnt(posed, claims),
            {tuple(one["word"]): str(one["reason"]) for one in structures if one.get("reason")},
        )
    seed = int(content["seed"])
    if seed < 0:
        raise ValueError(seed)
    search, solver = named_search(content["search"]), named_solver(content["solver"])
    paths, evaluations = (
        _budget(content, "paths", PATHS),
        _budget(content, "evaluations", EVALUATIONS),
    )
    return TriedFolder(posed, seed, search, solver, paths, evaluations, tried, claims)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError(value)
    return value


def _lemmas(content: Mapping[str, Any]) -> tuple[LemmaClaim, ...]:
    """The lemmas of a folder, in order."""
    items = [dict(item) for item in content.get("lemmas", [])]
    for item in items:
        del item["reason"]
    return tuple(lemma_claim(item | {"kind": "lemma"}) for item in items)


def _budget(content: Mapping[str, Any], name: str, usual: int) -> int:
    """A budget of a run; folders from before budgets existed have the default."""
    found = content.get(name)
    if found is None:
        return usual
    if not isinstance(found, int) or found < 1:
        raise ValueError(found)
    return found


def _verdict(text: str) -> NotFound:
    if text == "impossible":
        return "impossible"
    if text == "unknown":
        return "unknown"
    raise ValueError(text)


def _refuted(
    posed: PosedTask, structures: Sequence[Mapping[str, Any]]
) -> tuple[tuple[str, ...], ...]:
    """The derivations of the refuted structures, one for each distinct robot."""
    family = family_of(posed.program, posed.task)
    found = [
        tuple(one["derivation"])
        for one in structures
        if one["verdict"] == "refuted" and one["same_robot_as"] is None
    ]
    for labels in found:
        family.replay(labels)
    return tuple(found)


def _nearest(folder: Path, structures: Sequence[Mapping[str, Any]]) -> Nearest | None:
    """The unresolved structure with the best robustness; without evaluations, the first one."""
    best = _robustness(folder / "evaluations.csv")
    open_ones = [
        (number, one)
        for number, one in enumerate(structures)
        if one["verdict"] == "unresolved" and one["same_robot_as"] is None
    ]
    if not open_ones:
        return None
    number, one = max(open_ones, key=lambda item: (best.get(item[0], float("-inf")), -item[0]))
    return Nearest(tuple(one["word"]), best.get(number), str(one["evidence"]))


def _robustness(path: Path) -> dict[int, float]:
    """Maps the number of each structure to the best robustness that was evaluated."""
    if not path.exists():
        return {}
    best: dict[int, float] = {}
    for row in csv.DictReader(io.StringIO(bounded_text(path))):
        number, value = int(row["structure"]), float(row["rho"])
        best[number] = max(value, best.get(number, value))
    return best
