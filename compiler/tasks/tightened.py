"""A task with narrower bounds on its inputs, or with less time: a design has to do with less."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from compiler.expressions.exact_numbers import rational_bounds
from grammar_lang import ir


def tightened(program: ir.Program, task: ir.Task, share: Fraction) -> tuple[ir.Program, ir.Task]:
    """The program and its task in which inputs have only the part ``1 - share`` of their bounds.

    The efforts that the task or a joint bounds are bounded by so much less, and the ranges of
    declared inputs are drawn together about their middles; all else is as it was.  So a motion does
    this task if and only if it does the given one and its inputs keep the ``share`` of what they
    can keep from their bounds at most (``robustness_share``).  Bounds are those of
    ``input_bounds``, exactly.

    Args:
        program: the program, without maps.
        task: one of its tasks, without maps.
        share: at least 0 and less than 1.
    """
    part = 1 - share
    modules: Mapping[str, ir.Module] = {
        name: _module(module, part) for name, module in program.modules.items()
    }
    effort = tuple(replace(each, bound=part * each.bound) for each in task.effort)
    return replace(program, modules=modules), replace(task, effort=effort)


def _module(module: ir.Module, part: Fraction) -> ir.Module:
    return replace(
        module,
        dofs=tuple(_dof(dof, part) for dof in module.dofs),
        inputs=tuple(replace(each, domain=_drawn(each.domain, part)) for each in module.inputs),
    )


def _dof(dof: ir.Dof, part: Fraction) -> ir.Dof:
    if dof.effort is None:
        return dof
    return replace(dof, effort=ir.Num(part * rational_bounds(dof.effort)[0]))


def _drawn(domain: ir.Interval, part: Fraction) -> ir.Interval:
    """An interval about the same middle."""
    lower, upper = rational_bounds(domain.lower)[1], rational_bounds(domain.upper)[0]
    middle, half = (lower + upper) / 2, part * (upper - lower) / 2
    return ir.Interval(ir.Num(middle - half), ir.Num(middle + half))


def shortened(task: ir.Task, steps: int) -> ir.Task:
    """The task of motions of at most so many steps, whatever it minimizes."""
    return replace(task, steps=steps, at_most=True, minimize=())
