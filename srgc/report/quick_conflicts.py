"""The lines of a spec that rule its robots out, where a few questions find them.

It is what ``srgc synth`` prints after *impossible*; ``srgc why`` says more.
"""

from __future__ import annotations

from solvers.explanation.conflict import Conflict
from solvers.explanation.explanation import foremost, quick_conflict
from solvers.progress import Conduct
from srgc.results.why_folder import TriedFolder


def quick_conflicts(folder: TriedFolder) -> tuple[Conflict, ...]:
    """The conflict of one refuted robot, or of all of them, of a folder that says impossible.

    None is sought where poses of whole bodies are asked for, which takes seconds.
    """
    tried, task = folder.tried, folder.posed.task
    if tried is None or tried.verdict != "impossible":
        return ()
    refuted = tried.refuted
    if refuted and (task.bounds_body or any(clause.subject == "body" for clause in task.avoid)):
        return ()
    first = foremost(folder.posed, refuted) if refuted else None
    return quick_conflict(folder.posed, first, Conduct(folder.seed)).conflicts.found
