"""Compile modular-robot grammars to robots that are proved to do their task.

The public face; everything else may change between versions.  Heavy libraries are loaded by the
function that needs them.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from networkx import MultiDiGraph

    from grammar_lang.ir import Program
    from solvers.synthesis import Synthesis
    from solvers.verifier.verification import Report

__all__ = ["graph", "load", "synthesise", "verify"]


def load(path: str | Path) -> Program:
    """The checked program of a ``.srg`` file.

    Raises:
        srgc.session.SpecErrors: the file has errors; ``checked.diagnostics`` holds them.
        srgc.session.UsageFault: the file cannot be read.
    """
    from srgc.session import program_of

    return program_of(Path(path))


def graph(
    program: Program,
    of: str,
    *,
    grammar: str | None = None,
    workspace: str | None = None,
    depth: int | None = None,
    highlight: Sequence[str] | None = None,
    near: bool | None = None,
    word: Sequence[str] | None = None,
    derivation: int | None = None,
) -> MultiDiGraph:
    """What ``srgc graph --of ...`` draws, as a graph of networkx.

    Words are sequences of symbols, or texts with blanks between the symbols.  ``near``: only the
    run of ``highlight`` and what is beside it, of words by default.

    Nodes have ``label``, ``accepting``, ``highlighted``, ``initial`` and ``data`` (what they stand
    for), edges ``label``, ``highlighted`` and ``data``.

    Raises:
        srgc.session.UsageFault: as on the command line.
    """
    from compiler.views.networkx_graph import to_networkx
    from srgc.graphs.graph_request import GraphRequest, drawing_of

    run = None if highlight is None else _symbols(highlight)
    robot = None if word is None else _symbols(word)
    request = GraphRequest(of, grammar, workspace, depth, run, near, robot, derivation)
    return to_networkx(drawing_of(program, request).picture)


def _symbols(word: Sequence[str]) -> tuple[str, ...]:
    return tuple(word.split() if isinstance(word, str) else word)


def synthesise(
    program: Program,
    task: str | None = None,
    *,
    seed: int = 0,
    jobs: int = 1,
    cells: int | None = None,
    every: bool = False,
) -> Synthesis:
    """Search a task of a program for a proved robot, or for a proof that there is none.

    The search begins with at least ``cells`` cells, where that is given, and with ``every`` it goes
    on after the first design.  With several ``jobs`` it
    is made by as many other processes: the calling module has to be importable, as
    :mod:`multiprocessing` says.  The result is the same.

    Nothing is written; ``srgc synth`` writes a result folder that can be verified.

    Raises:
        srgc.session.UsageFault: there is no such task, or several and none is named.
        srgc.session.SpecErrors: the task has a clause that this version cannot compile.
        srgc.session.NoAnswer: the processes were ended, again and again.
    """
    from solvers import synthesis
    from solvers.progress import Conduct
    from srgc.session import chosen, refuse_unsupported
    from srgc.workers import workers_for

    chosen_task = chosen(program.tasks, task, "task")
    refuse_unsupported(program, chosen_task)
    with workers_for(jobs) as workers:
        conduct = Conduct(seed=seed, workers=workers)
        return synthesis.synthesise(program, chosen_task, conduct, cells, every=every)


def verify(
    folder: str | Path, *, spec: str | Path | None = None, trust: str | None = None
) -> Report:
    """Check a result folder independently of the search (see ``solvers.verifier``)."""
    from solvers.verifier.verification import verify_directory

    return verify_directory(Path(folder), None if spec is None else Path(spec), trust)
