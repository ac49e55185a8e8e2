"""A robot with additional point masses, wherever a derivation may have such parts.

If the drives of a robot are too weak, a heavier robot may still do the task, thanks to a
counterweight. So a refutation for one mass says nothing about another. Instead all masses are
covered at once: the masses of parts that change no pose are parameters, from zero up to the largest
possible total, at every frame at which the derivation may have such a part.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from compiler.expressions.exact_numbers import rational_bounds
from compiler.expressions.scalars import Constant, ParameterLeaf, ScalarTable
from compiler.lemmas.neutral_productions import neutral_productions
from compiler.neutral_modules.neutral_parameters import inlined
from compiler.robots.normal_form import RobotFamily, normalise
from compiler.robots.robot import Body, PointBody, RobotModel, RobotParameter
from compiler.words.derivation import Derivation
from grammar_lang import ir


def weights(family: RobotFamily, task: ir.Task) -> Mapping[str, str]:
    """The productions that add point masses and nothing else, by label, with their one module.

    Empty in tasks that name coordinates, kept values or loads, and in tasks whose bodies must avoid
    something: a weight is a point of the body.
    """
    plain = (
        not isinstance(task.start, ir.StartAt) and task.origin is None and not task.carries
        and task.avoid_self is None and not task.bounds_body
        and all(clause.subject == "effector" for clause in task.avoid)
    )  # fmt: skip
    if not plain:
        return {}
    found: dict[str, str] = {}
    for number in sorted(neutral_productions(family.program, family.grammar).transparent):
        production = family.grammar.productions[number]
        modules = [symbol.name for symbol in production.right if symbol.kind == "module"]
        block = inlined((family.grammar.semantics or {})[production.label])
        light = all(
            isinstance(each, ir.PointMass) and isinstance(each.frame, ir.AttributeOf)
            for each in block.emissions
        )
        module = family.program.modules[modules[0]] if len(modules) == 1 else None
        if (
            module is not None
            and light
            and block.emissions
            and not module.dofs
            and not _own(module)
        ):
            found[production.label] = module.name
    return found


def _own(module: ir.Module) -> bool:
    """Whether a module has dynamics of its own."""
    return bool(module.states or module.inputs or module.torques)


def weighted_robot(
    family: RobotFamily, task: ir.Task, base: Derivation, most: int
) -> RobotModel | None:
    """The robot of a derivation with up to ``most`` weights of each kind, anywhere.

    Every robot of a derivation that results from ``base`` by inserting weights, at most ``most`` of
    each module, is this robot for some values of its parameters. None if this cannot be shown.

    Args:
        family: the family of the task.
        task: the task.
        base: a derivation without weights.
        most: the largest number of each module.
    """
    kinds = weights(family, task)
    owners = {production.label: production.left for production in family.grammar.productions}
    if not kinds or any(label in kinds for label in base.labels):
        return None
    labels: list[str] = []
    for label in base.labels:
        labels += [kind for kind in kinds if owners[kind] == owners[label]]
        labels.append(label)
    built = family.built(family.replay(tuple(labels)))
    freed = _with_free_masses(built, frozenset(kinds.values()), most)
    if freed is None:
        return None
    found = normalise(freed)
    return found if len(found.dofs) == len(family.robot(base).dofs) else None


def _with_free_masses(model: RobotModel, modules: frozenset[str], most: int) -> RobotModel | None:
    """The model with a parameter for each mass that these modules emit; None if that fails."""
    table = ScalarTable()
    for node in model.scalars:
        table.add(node)
    parameters, bodies = list(model.parameters), list[Body]()
    for body, owner in zip(model.bodies, model.owners, strict=True):
        if owner is None or owner.module not in modules:
            bodies.append(body)
            continue
        largest = _largest(model, body)
        if largest is None:
            return None
        domain = ir.Interval(ir.Num(Fraction(0)), ir.Num(most * largest))
        name = f"weight{len(parameters)}"
        number = table.parameter(len(parameters))
        parameters.append(RobotParameter(owner.symbol, owner.module, name, domain, "kg"))
        bodies.append(replace(body, mass=number) if isinstance(body, PointBody) else body)
    return replace(
        model,
        scalars=tuple(table.nodes),
        parameters=tuple(parameters),
        bodies=tuple(bodies),
    )


def _largest(model: RobotModel, body: Body) -> Fraction | None:
    """The largest mass of a body in kg, if it is known and not negative; else None."""
    if not isinstance(body, PointBody):
        return None
    bounds: Sequence[Fraction] | None = None
    match model.scalars[body.mass]:
        case Constant(value):
            bounds = (value, value)
        case ParameterLeaf(index):
            domain = model.parameters[index].domain
            ends = domain.values if isinstance(domain, ir.Choices) else (domain.lower, domain.upper)
            bounds = [bound for end in ends for bound in rational_bounds(end)]
        case _:
            return None
    return max(bounds) if min(bounds) >= 0 else None
