"""Tasks and programs built directly from the intermediate representation."""

from __future__ import annotations

from fractions import Fraction

from grammar_lang.ir import Avoid, Effort, Program, Reach, StartIn, Task
from grammar_lang.source import Span

START, REACH = Span(100, 110), Span(120, 130)


def avoid(*regions, subject="effector", margin=Fraction(0)):
    return Avoid(regions, subject, margin)


def task(*avoids, start="S", reach="T", workspace="W", name="Do"):
    """``start`` is the name of a region or a start clause."""
    given = StartIn(start, None, Fraction(0), START) if isinstance(start, str) else start
    return Task(
        name=name,
        grammar="G",
        workspace=workspace,
        start=given,
        reach=Reach(reach, None, None, REACH),
        avoid=avoids,
        effort=(Effort("revolute", Fraction(10), False),),
        steps=10,
        step=Fraction(1, 8),
        slack=Fraction(1, 10**6),
        gravity=(Fraction(0), Fraction(0)),
        modules=None,
        bounds_body=False,
    )


def program(workspaces, tasks):
    return Program(
        modules={},
        terminals=(),
        grammars={},
        workspaces={workspace.name: workspace for workspace in workspaces},
        tasks={one.name: one for one in tasks},
        sources=(),
    )
