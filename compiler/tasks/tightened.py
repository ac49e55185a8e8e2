"""A task with narrower bounds on its inputs, or less time, which a design must still meet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from compiler.expressions.exact_numbers import rational_bounds
from grammar_lang import ir


def tightened(program: ir.Program, task: ir.Task, share: Fraction) -> tuple[ir.Program, ir.Task]:
    """The program and its task in which inputs have only ``1 - share`` of their bounds.

    Efforts bounded by the task or a joint are bounded by this fraction, and the ranges of declared
    inputs shrink about their middles; everything else is unchanged. So a motion does this task if
    and only if it does the given one and its inputs keep the ``share`` of the largest possible
    margin to their bounds (``robustness_share``). The bounds are exactly those of ``input_bounds``.

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
    """The interval with the same middle and ``part`` of the width."""
    lower, upper = rational_bounds(domain.lower)[1], rational_bounds(domain.upper)[0]
    middle, half = (lower + upper) / 2, part * (upper - lower) / 2
    return ir.Interval(ir.Num(middle - half), ir.Num(middle + half))


def shortened(task: ir.Task, steps: int) -> ir.Task:
    """The task for motions of at most ``steps`` steps, without its objectives."""
    return replace(task, steps=steps, at_most=True, minimize=())
