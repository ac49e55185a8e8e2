"""The lines of a task that rule a robot out, or that rule out every robot at once.

The oracle is the refuter of the synthesis, applied to the task with the other lines relaxed. A
conflict is a set of lines that is refuted, but is not refuted if any one of them is left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias, TypeVar

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import Candidate, robot_in_task
from compiler.robots.normal_form import family_of
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import abstract
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.relaxation import without
from solvers.explanation.task_line import TaskLine, task_lines
from solvers.impossibility.box_evidence import out_of_reach_of_drives
from solvers.impossibility.disconnection import disconnected
from solvers.impossibility.structure_refutation import refute_structure
from solvers.run_context import Memory, RunContext

MOST_QUESTIONS = 1500
"""The most questions to the refuter about all structures together."""
BY_DRIVES = "!"
"""What a covering has where drives are too weak."""

Evidence: TypeAlias = Literal["poses", "ways", "drives"]
"""What refutes a structure: a script or a covering about poses, or a covering by drives."""


@dataclass(frozen=True, slots=True)
class Conflict:
    """Lines that rule out robots, all of them needed; ``words`` are the words of those robots.

    Without words the lines rule out all robots: two places are separated from each other.
    """

    lines: tuple[TaskLine, ...]
    words: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class Conflicts:
    """The conflicts, those that rule out most robots first; ``left`` robots were not explained."""

    found: tuple[Conflict, ...]
    left: int = 0

    @property
    def lines(self) -> tuple[TaskLine, ...]:
        """All lines of all conflicts, without repetition."""
        return tuple(dict.fromkeys(line for conflict in self.found for line in conflict.lines))


def separation_conflict(posed: PosedTask) -> Conflict | None:
    """The lines that separate start and target from each other; None if nothing does."""
    every = task_lines(posed)
    lines = [
        line for line in every if line.kind in ("start", "reach", "satisfy", "avoid", "bounds")
    ]

    def cut_off(kept: Sequence[TaskLine]) -> bool:
        return is_cut_off(without(posed, [line for line in lines if line not in kept]))

    found = minimal_conflict(lines, cut_off)
    return None if found is None else Conflict(found)


def is_cut_off(posed: PosedTask) -> bool:
    """Whether places that the task connects are separated from each other, for every robot."""
    whole = posed.expanded()
    cells = abstract(whole.workspace)
    return disconnected(whole.program, whole.task, cells) is not None


@dataclass(slots=True)
class ConflictSearch:
    """The conflicts of structures; structures ruled out by the same lines are one conflict.

    ``between`` is called before every question to the refuter, and may raise to end the search.
    With ``late``, a structure that is not refuted otherwise is examined as after a search without a
    motion, which takes long.  ``step`` is told of every question, in words, and ``tell`` of each
    conflict when the first structure with it is known.
    """

    posed: PosedTask
    context: RunContext
    between: Callable[[], None] = lambda: None
    late: bool = True
    step: Callable[[str], None] = lambda _: None
    tell: Callable[[Conflict], None] = lambda _: None
    questions: int = 0
    examined: int = 0
    place: str = ""
    lines: tuple[TaskLine, ...] = ()
    _found: dict[tuple[TaskLine, ...], list[tuple[str, ...]]] = field(
        default_factory=dict[tuple[TaskLine, ...], list[tuple[str, ...]]]
    )
    _kinds: dict[tuple[TaskLine, ...], set[Evidence]] = field(
        default_factory=dict[tuple[TaskLine, ...], set[Evidence]]
    )

    def __post_init__(self) -> None:
        self.lines = task_lines(self.posed)

    def conflicts(self, derivations: Sequence[Derivation], most: int = MOST_QUESTIONS) -> Conflicts:
        """The conflicts of refuted structures; those of most robots come first.

        It ends before the first structure after ``most`` questions; another call with the same
        structures goes on from there.
        """
        while self.examined < len(derivations) and self.questions < most:
            derivation = derivations[self.examined]
            self.examined += 1
            self.place = f"robot {self.examined} of {len(derivations)}: "
            lines = self.conflict(derivation)
            if lines is None:
                continue
            if lines not in self._found:
                self.tell(Conflict(lines, (derivation.word,)))
            self._found.setdefault(lines, []).append(derivation.word)
        return self.found(len(derivations))

    def found(self, total: int) -> Conflicts:
        """The conflicts found so far among ``total`` structures."""
        left = total - sum(map(len, self._found.values()))
        ranked = sorted(self._found.items(), key=lambda item: -len(item[1]))
        return Conflicts(tuple(Conflict(lines, tuple(words)) for lines, words in ranked), left)

    def conflict(self, derivation: Derivation) -> tuple[TaskLine, ...] | None:
        """The lines that rule a structure out; None if the refuter does not refute it.

        Conflicts that rule out other structures by evidence of the same kind are tried first.
        Others are not: a refuter may search for long for what drives rule out among poses.
        """
        found = self._conflict(derivation, late=False)
        if found is None and self.late:
            found = self._conflict(derivation, late=True)
        return found

    def _conflict(self, derivation: Derivation, *, late: bool) -> tuple[TaskLine, ...] | None:
        answers: dict[frozenset[TaskLine], Evidence | None] = {}

        def evidence(kept: Sequence[TaskLine]) -> Evidence | None:
            key = frozenset(kept)
            if key not in answers:
                answers[key] = self.evidence(derivation, kept, late=late)
            return answers[key]

        def refuted(kept: Sequence[TaskLine]) -> bool:
            return evidence(kept) is not None

        kind = evidence(self.lines)
        if kind is None:
            return None
        alike = (known for known, kinds in self._kinds.items() if kind in kinds)
        known = next(filter(refuted, alike), self.lines)
        found = minimal_conflict(known, refuted)
        if found is not None:
            self._kinds.setdefault(found, set()).add(kind)
        return found

    def _question(self, derivation: Derivation, kept: Sequence[TaskLine], *, late: bool) -> str:
        """What is being asked, in words."""
        harder = ", with longer proofs" if late else ""
        some = f"{len(kept)} of {len(self.lines)} lines rule"
        what = f"{kept[0].says} rules" if len(kept) == 1 else some
        return f"{self.place}whether {what} out {' '.join(derivation.word)}{harder}"

    def evidence(
        self, derivation: Derivation, kept: Sequence[TaskLine], *, late: bool = False
    ) -> Evidence | None:
        """The kind of evidence by which these lines alone refute a structure; None if they do not.

        ``late``: also with the effort that a synthesis spends after it has found no motion.
        """
        self.between()
        self.questions += 1
        self.step(self._question(derivation, kept, late=late))
        relaxed = without(self.posed, [line for line in self.lines if line not in kept])
        posed = relaxed.expanded()
        family = family_of(posed.program, posed.task)
        try:
            model = robot_in_task(family, posed.task.origin, derivation)
        except SemanticsError:
            return None
        numeric = NumericRobot(robot_graph(model, posed.task.gravity))
        answer = refute_structure(model, numeric, posed.program, posed.task, self.context)
        if answer.script is not None:
            return "poses"
        if answer.boxes is not None:
            return "drives" if BY_DRIVES in answer.boxes else "ways"
        if not late:
            return None
        candidate, context = (
            Candidate(0, derivation, model),
            replace(self.context, journal=Memory()),
        )
        found = out_of_reach_of_drives(candidate, posed.program, posed.task, context)
        return None if found is None else "drives"


# --- A minimal conflict: a refuted subset of constraints, all of them needed ----------------------
#
# QUICKXPLAIN finds one with few questions if it is small; elements that come first are preferred.
# Source: Junker, *QuickXplain: Preferred Explanations and Relaxations for Over-Constrained
# Problems* (AAAI 2004). It assumes that adding constraints never makes a refutation fail. A refuter
# with a budget may break this assumption, so the answer is checked, and elements are removed once
# more one by one.


Item = TypeVar("Item")
Refuted: TypeAlias = Callable[[Sequence[Item]], bool]


def minimal_conflict(items: Sequence[Item], refuted: Refuted[Item]) -> tuple[Item, ...] | None:
    """A subset that is refuted, but not without any one of its elements; in order.

    None if not even all items together are refuted. Empty if nothing is needed.
    """
    if not refuted(items):
        return None
    if refuted(()):
        return ()
    found = _explained((), tuple(items), refuted, grown=False)
    chosen = [item for item in items if item in found]
    return _thinned(chosen if refuted(chosen) else list(items), refuted)


def _explained(
    background: tuple[Item, ...],
    items: tuple[Item, ...],
    refuted: Refuted[Item],
    *,
    grown: bool,
) -> tuple[Item, ...]:
    """The items that are needed in addition to the background; ``grown``: it has new elements."""
    if grown and refuted(background):
        return ()
    if len(items) == 1:
        return items
    half = len(items) // 2
    first, second = items[:half], items[half:]
    later = _explained((*background, *first), second, refuted, grown=True)
    earlier = _explained((*background, *later), first, refuted, grown=bool(later))
    return (*earlier, *later)


def _thinned(items: list[Item], refuted: Refuted[Item]) -> tuple[Item, ...]:
    """The items without those that are not needed, removing the last first.

    An item that is needed among many may not be needed among fewer, so this is repeated until
    nothing changes.
    """
    kept, count = list(items), len(items) + 1
    while len(kept) < count:
        count = len(kept)
        for item in reversed(kept):
            fewer = [other for other in kept if other is not item]
            if refuted(fewer):
                kept = fewer
    return tuple(kept)
