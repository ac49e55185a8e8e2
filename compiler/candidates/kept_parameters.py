"""The robot of a structure in a task: what the task fixes of a module that is kept is one value."""

from __future__ import annotations

from dataclasses import replace

from compiler.candidates.alignment import alignment
from compiler.grammars.derivation import Derivation
from compiler.robots.robot import RobotModel
from compiler.semantics.family import RobotFamily
from grammar_lang import ir


def robot_in_task(
    family: RobotFamily, origin: ir.Origin | None, derivation: Derivation
) -> RobotModel:
    """The robot of a derivation; every fixed parameter of a kept module has its one value only.

    Args:
        family: the family of the task.
        origin: the existing robot of the task, None without one.
        derivation: the structure.

    Raises:
        SemanticsError: the derivation defines no robot.
    """
    model = family.robot(derivation)
    if origin is None or not origin.fixed:
        return model
    kept = dict(alignment(origin.word, derivation.word, family.language.srg.modules).kept)
    values = {(kept[f.symbol], f.name): f.value for f in origin.fixed if f.symbol in kept}
    parameters = (
        replace(p, domain=ir.Choices((values[p.symbol, p.name],)))
        if (p.symbol, p.name) in values
        else p
        for p in model.parameters
    )
    return replace(model, parameters=tuple(parameters))
