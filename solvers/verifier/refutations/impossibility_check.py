"""The check of ``impossible``: every structure up to the bound, each refuted by a script of ours.

The structures are enumerated again and every script is made again from the spec, byte for byte;
what is left to believe is the solver's ``unsat``, unless it is run again in a process of its own.
Where places are cut off from each other, the cells are computed again, and no solver is believed.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from compiler.candidates.candidate import candidates
from compiler.encodings.refutation_scripts import refutation_scripts
from compiler.geometry.abstraction import abstract
from compiler.languages.structures import InfiniteAmbiguityError
from compiler.robots.robot_key import robot_key
from compiler.semantics.family import RobotFamily, family_of
from grammar_lang import ir
from solvers.verifier.claims.certificate import ImpossibleClaim, SeparationClaim, StructureClaim
from solvers.verifier.refutations.separation_check import misstated_separation
from solvers.verifier.refutations.z3_process import run_z3_subprocess
from solvers.verifier.verdict import Fails


class FalseClaim(Exception):
    """The claim is false, or its evidence is not what it says."""


def check_impossible(
    folder: Path, claim: ImpossibleClaim, program: ir.Program, task: ir.Task, trust: str | None
) -> tuple[str | None, bool]:
    """The reason why the claim is refused, or None; and whether no script is left to believe.

    ``task`` is one of ``program``, both without maps.
    """
    if claim.separation is not None:
        return _separation(claim, claim.separation, program, task), True
    family = family_of(program, task)
    try:
        bound = _bound(claim, family, task)
        _structures(folder, claim, family, task, bound, trust)
    except (FalseClaim, InfiniteAmbiguityError) as error:
        return str(error), False
    return None, trust == "z3" or not claim.structures


def _separation(
    claim: ImpossibleClaim, separation: SeparationClaim, program: ir.Program, task: ir.Task
) -> str | None:
    """Why a separation does not prove the claim, or None."""
    if claim.structures or claim.modules is not None:
        return "the claim has a separation, which is about all robots, and structures or a bound"
    cells = abstract(program.workspaces[task.workspace])
    return misstated_separation(program, task, cells, separation)


def _bound(claim: ImpossibleClaim, family: RobotFamily, task: ir.Task) -> int:
    """The number of modules up to which structures have to be refuted."""
    if claim.modules != task.modules:
        raise FalseClaim("the bound on modules is not the task's")
    if claim.modules is not None:
        if not family.language.is_finite(max_modules=claim.modules):
            raise FalseClaim("there are infinitely many words within the bound")
        return claim.modules
    if not family.language.is_finite():
        raise FalseClaim("the language is infinite and the task has no bound on modules")
    return len(family.language.count_words()) - 1


def _structures(
    folder: Path,
    claim: ImpossibleClaim,
    family: RobotFamily,
    task: ir.Task,
    bound: int,
    trust: str | None,
) -> None:
    workspace = family.program.workspaces[task.workspace]
    keys: list[str] = []
    number = -1
    for candidate in candidates(family, bound, task.origin):
        number, derivation = candidate.number, candidate.derivation
        if number >= len(claim.structures):
            raise FalseClaim(f"structure {number} is missing: {' '.join(derivation.word)}")
        claimed = claim.structures[number]
        if (claimed.word, claimed.derivation) != (derivation.word, derivation.labels):
            raise FalseClaim(f"structure {number} is not {' '.join(derivation.word)}")
        model = candidate.model
        if model is None:
            raise FalseClaim(f"structure {number} is no robot: {candidate.fault}")
        keys.append(robot_key(model))
        if claimed.same_robot_as is not None:
            _same(number, claimed, keys)
            continue
        _evidence(folder, number, claimed, refutation_scripts(model, workspace, task), trust)
    if number + 1 != len(claim.structures):
        raise FalseClaim("the claim lists structures that the family does not have")


def _same(number: int, claimed: StructureClaim, keys: list[str]) -> None:
    first = claimed.same_robot_as
    if first is None or not 0 <= first < number or keys[first] != keys[number]:
        raise FalseClaim(f"structure {number} is not the same robot as structure {first}")


def _evidence(
    folder: Path, number: int, claimed: StructureClaim, scripts: Iterable[str], trust: str | None
) -> None:
    """The evidence is a script of this spec, and a solver process answers ``unsat`` if asked."""
    if claimed.evidence is None:
        raise FalseClaim(f"structure {number} has no evidence")
    path = folder / claimed.evidence
    if not path.resolve().is_relative_to(folder.resolve()) or not path.is_file():
        raise FalseClaim(f"the evidence {claimed.evidence} is missing")
    content = path.read_bytes()
    script = next((script for script in scripts if script.encode() == content), None)
    if script is None:
        raise FalseClaim(f"{claimed.evidence} is not the script of structure {number}")
    if trust == "z3" and not isinstance(run_z3_subprocess(script), Fails):
        raise FalseClaim(f"z3 does not refute structure {number}")
