"""Why a task was not met."""

from __future__ import annotations

from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault
from srgc.time_limit import TimeLimit

if TYPE_CHECKING:
    from solvers.explanation.explanation import Explanation as Found


@dataclass(frozen=True, slots=True)
class Explanation:
    """Which lines of a specification conflict, and what would make its task possible.

    Attributes:
        found: all that is known; not a stable interface.
    """

    found: Found

    @property
    def conflicts(self) -> list[list[str]]:
        """The lines that together rule robots out, by conflict, in words."""
        return [[line.says for line in one.lines] for one in self.found.conflicts.found]

    @property
    def suggestions(self) -> list[str]:
        """Changes of one line with which a run has found and proved a robot, in words."""
        return [one.change.says for one in self.found.suggestions]

    def __repr__(self) -> str:
        conflicts, changes = len(self.conflicts), len(self.suggestions)
        return f"<Explanation: {conflicts} conflicts, {changes} suggestions>"

    def __str__(self) -> str:
        from srgc.text_reports.why_report import why_text

        return why_text(self.found).rstrip()

    def _repr_html_(self) -> str:
        from srgc.api.displays import explanation_html

        return explanation_html(self.found)


@spoken
def why(
    result: str | PathLike[str], *, runs: bool = True, time_limit: float | None = None
) -> Explanation:
    """Say which lines of a specification conflict, and what would make its task possible.

    Args:
        result: one with the verdict impossible or unknown, or its folder.
        runs: whether to look for changes that help, each confirmed by a run of its own.
        time_limit: seconds; what is known by then is given.

    Raises:
        SrgcError: there are no results, or a robot was found.
    """
    from solvers.explanation.explanation import Asked, explain
    from solvers.explanation.run import MOST_RUNS
    from solvers.run_context import RunContext
    from srgc.results.why_folder import tried_folder

    limit = TimeLimit(time_limit)
    tried = tried_folder(Path(result))
    if tried.tried is None:
        raise UsageFault("a robot was found: there is nothing to explain, `verify` checks it")
    context = RunContext(
        seed=tried.seed, search=tried.search, solver=tried.solver, out_of_time=limit.reached
    )
    # Places are told as in the specification itself, not in the copy, which may be anywhere.
    program = tried.posed.program
    sources = tuple(replace(source, name=source.path) for source in program.sources)
    posed = replace(tried.posed, program=replace(program, sources=sources))
    with limit.holds():
        found = explain(posed, tried.tried, Asked(context, MOST_RUNS if runs else 0))
    return Explanation(found)
