"""A robot's mass matrix and effector positions as an SMT-LIB 2 script, to be continued."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.encodings.graph_terms import ONE, LinearTerm, TermEvaluator
from compiler.encodings.real_terms import RealScript, all_of, any_of, between
from compiler.expressions.evaluators.balls import closed_ball, working_precision
from compiler.expressions.rational_enclosure import rational_bounds
from compiler.expressions.scalars import evaluate_constant
from compiler.expressions.tape import tape
from compiler.robots.robot import RobotModel
from grammar_lang import ir

BITS = 128


def model_script(graph: RobotGraph) -> str:
    """Declarations, ranges, and the entries of M and of the effectors' positions as functions.

    With entries ``M_i_j`` (i <= j) and ``e_i_x``, indices from 1; coordinates are ``q1`` or
    ``cos_q1`` and ``sin_q1``, parameters ``theta1``.  Assertions of one's own can follow.
    """
    model, script = graph.model, RealScript(["(set-logic QF_NRA)"])
    with working_precision(BITS):
        evaluator = TermEvaluator(script)
        inputs = [*_coordinates(evaluator, model), *_parameters(evaluator, model)]
        inputs += [evaluate_constant(value, evaluator) for value in graph.constants]
        n, axes = len(model.dofs), "xyz"[: model.dimension]
        script.comment("The mass matrix.")
        mass = tape(graph.mass_matrix).evaluate(inputs, evaluator)
        for i in range(n):
            for j in range(i, n):
                _function(evaluator, f"M_{i + 1}_{j + 1}", mass[j * n + i])
        script.comment("The positions of the effectors, in m.")
        tips = tape(graph.effectors).evaluate(inputs, evaluator)
        names = [f"e_{i + 1}_{axis}" for i in range(len(model.effectors)) for axis in axes]
        for name, tip in zip(names, tips, strict=True):
            _function(evaluator, name, tip)
    return "\n".join(script.lines) + "\n"


def _function(evaluator: TermEvaluator, name: str, number: LinearTerm) -> None:
    text = evaluator.expression(number).text
    evaluator.script.lines.append(f"(define-fun {name} () Real {text})")


def _coordinates(evaluator: TermEvaluator, model: RobotModel) -> Iterator[LinearTerm]:
    """The coordinates, declared within their ranges."""
    for number, dof in enumerate(model.dofs, 1):
        name = f"q{number}"
        places = " and ".join(map(str, dof.symbols))
        evaluator.script.comment(f"{name}: {dof.kind} {dof.axis}, at {places} in the word.")
        if dof.kind == "prismatic" and dof.range is not None:
            yield _bounded(evaluator, name, dof.range)
            continue
        if dof.kind == "prismatic":
            evaluator.real(name)
        else:
            if dof.range is not None:
                ends = closed_ball(dof.range.lower), closed_ball(dof.range.upper)
                evaluator.ranges[name] = ends[0].union(ends[1])
            evaluator.unit_point(name)
        yield LinearTerm({name: ONE}, Fraction(0))


def _parameters(evaluator: TermEvaluator, model: RobotModel) -> Iterator[LinearTerm]:
    """The parameters, declared within their ranges."""
    for number, parameter in enumerate(model.parameters, 1):
        described = f"{parameter.name} of {parameter.module} at {parameter.symbol} in the word"
        evaluator.script.comment(f"theta{number}: {described}.")
        yield _bounded(evaluator, f"theta{number}", parameter.domain)


def _bounded(evaluator: TermEvaluator, name: str, domain: ir.Interval | ir.Choices) -> LinearTerm:
    """A real, declared within outer rational bounds."""
    ends = (domain.lower, domain.upper) if isinstance(domain, ir.Interval) else domain.values
    first, *others = (closed_ball(end) for end in ends)
    for other in others:
        first = first.union(other)
    script = evaluator.script
    evaluator.ranges[name] = first
    unknown = script.declare(name, first)
    bounds = [rational_bounds(end) for end in ends]
    if isinstance(domain, ir.Choices):
        evaluator.choices[name] = [closed_ball(end) for end in ends]
    if isinstance(domain, ir.Interval):
        script.assertion(*between((bounds[0][0], bounds[1][1]), unknown))
    else:
        script.assertion(any_of([all_of(between(each, unknown)) for each in bounds]))
    return evaluator.symbol(unknown)
