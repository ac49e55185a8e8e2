"""The result of a mission: a verdict, a design for each task, and the changes between them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from srgc.api.folder_result import FolderResult, TemporaryFolder
from srgc.api.result import Result, result_in
from srgc.api.spoken_faults import spoken

if TYPE_CHECKING:
    from compiler.missions.robot_changes import Changes
    from srgc.comparisons.mission_reasons import MissionReasons
    from srgc.results.mission_folder import MissionFolder


@dataclass(frozen=True, slots=True)
class RobotChange:
    """The changes before a task, for the cheapest choice of kept modules.

    Positions in a word are indices of its symbols, from 0.

    Attributes:
        task: the name of the task.
        cost: the total cost of the changes.
        added: the added modules with their positions in the new word, such as ``(6, "JO")``.
        removed: the removed modules with their positions in the old word.
        kept: the kept modules, each with its positions in the old and in the new word.
        changed: the parameters of kept modules that get another value, such as ``"4.length"``.
    """

    task: str
    cost: float
    added: tuple[tuple[int, str], ...]
    removed: tuple[tuple[int, str], ...]
    kept: tuple[tuple[int, int], ...]
    changed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MissionExplanation:
    """What rules out robots in each task of a mission, and the cheapest robots that are left.

    Attributes:
        found: the whole explanation; not a stable interface.
    """

    found: MissionReasons

    @property
    def refuted(self) -> dict[str, list[str]]:
        """The refutations in each task, in words."""
        return {each.task: list(each.says) for each in self.found.tasks}

    @property
    def cheapest_left(self) -> float | None:
        """The least cost of the robots that are not refuted; None without any, or if unknown."""
        left = self.found.left
        return None if left is None else float(left.cost)

    @property
    def undecided(self) -> dict[str, list[str]]:
        """The robots of each task that are neither found nor refuted, with reasons, in words.

        Statements about all tasks together have the key ``"Pack, Sort"``: the names in one text.
        """
        together = ", ".join(self.found.mission.mission.tasks)
        return {
            task or together: [one.says() for one in each]
            for task, each in self.found.undecided.items()
        }

    @property
    def try_first(self) -> str | None:
        """What to try first, given what ended the search; None if nothing ended it early."""
        first = self.found.mission.design.get("try_first")
        return None if first is None else str(first)

    def __repr__(self) -> str:
        return f"<MissionExplanation: {self.found.mission.mission.name}>"

    def __str__(self) -> str:
        from srgc.comparisons.mission_reasons_text import mission_reasons_text

        return mission_reasons_text(self.found).rstrip()

    def _repr_html_(self) -> str:
        from srgc.render.html_text import block, coloured

        return block(coloured(str(self)))


@dataclass(frozen=True)
class MissionResult(FolderResult):
    """A verdict about a mission, or about one step of ``evolve``, with its evidence.

    Its folder is as ``srgc synth --mission`` or ``srgc evolve`` writes it.  It can be used instead
    of the path of that folder.

    Attributes:
        folder: the folder with its files; a temporary one unless another was requested.
        design: the content of its ``design.json``.
        keeper: the owner of a temporary folder, or None; the folder exists as long as its owner.
        answers: the answers of ``verify`` so far; the display of the result shows the last one.
    """

    @property
    def mission(self) -> str:
        """The name of the mission; for a step of ``evolve``, that of its task."""
        return str(self.design["mission"])

    @cached_property
    def _folder(self) -> MissionFolder:
        from srgc.results.mission_folder import mission_folder

        return mission_folder(self.folder)

    @property
    def tasks(self) -> tuple[str, ...]:
        """The names of the tasks, in order."""
        return tuple(str(self.design["task"]).split(", "))

    @property
    def one_robot(self) -> bool:
        """Whether one robot has to do all tasks; otherwise it is rebuilt between them."""
        return bool(self.design["kind"] == "one robot")

    @property
    def designs(self) -> dict[str, Result]:
        """The design for each task, as a ``Result``, by name; empty unless the verdict is found."""
        return {
            str(each["task"]): result_in(self.folder / "tasks" / str(each["task"]), self.keeper)
            for each in self.design["robots"]
        }

    @property
    def cost(self) -> float | None:
        """The total cost of all changes; None without robots, or if one robot does all tasks."""
        return None if self.design["cost"] is None else float(self.design["cost"])

    @property
    def least(self) -> float | None:
        """A lower bound on the cost for any robots; None if there is no ``cost``."""
        return None if self.cost is None else float(self.design["least"])

    @property
    def differs(self) -> dict[str, tuple[str, ...]]:
        """The modules of the existing robot that the specification builds differently.

        Each has its differences: ``{"Limb": ("parameter length", "bodies")}``.  A kept module is
        from then on as the specification says.
        """
        return {each["module"]: tuple(each["what"]) for each in self.design["differs"]}

    @property
    def steps(self) -> tuple[RobotChange | None, ...]:
        """The changes before each task; None before the first, unless there is a robot already.

        Raises:
            SrgcError: the results have been altered.
        """
        return self._steps()

    @spoken
    def _steps(self) -> tuple[RobotChange | None, ...]:
        mission = self._folder
        words = [robot.claim.word for robot in mission.robots]
        before = () if mission.before is None else mission.before.word
        return tuple(
            None if step is None else _change(mission, task, step, old, new)
            for task, step, old, new in zip(
                self.tasks, mission.steps, [before, *words], words, strict=False
            )
        )

    @spoken
    def why(self) -> MissionExplanation:
        """Explain what rules out other robots, as ``srgc why`` does.

        Raises:
            SrgcError: the results have been altered.
        """
        from srgc.comparisons.mission_reasons import mission_reasons

        return MissionExplanation(mission_reasons(self.folder))

    def __repr__(self) -> str:
        said = self.reason or ("one robot" if self.cost is None else f"changes {self.cost:g}")
        return f"<MissionResult {self.mission}: {self.verdict}, {said}>"

    def __str__(self) -> str:
        from srgc.api.displays_of_missions import mission_lines

        return "\n".join(mission_lines(self.design))

    def _repr_html_(self) -> str:
        from srgc.api.displays_of_missions import mission_html

        said = self.answers[-1].report if self.answers else None
        return mission_html(self.folder, self.design, said)


def _change(
    mission: MissionFolder, task: str, step: Changes, old: tuple[str, ...], new: tuple[str, ...]
) -> RobotChange:
    modules = mission.program.modules
    before = [place for place, symbol in enumerate(old) if symbol in modules]
    after = [place for place, symbol in enumerate(new) if symbol in modules]
    return RobotChange(
        task,
        float(step.cost),
        tuple((after[j], new[after[j]]) for j in step.added),
        tuple((before[i], old[before[i]]) for i in step.removed),
        tuple((before[i], after[j]) for i, j in step.kept),
        tuple(f"{after[j]}.{name}" for _, j, name in step.changed),
    )


def mission_in(folder: Path, keeper: TemporaryFolder | None = None) -> MissionResult:
    """The result of a mission in a folder.

    Raises:
        UsageFault: the folder has no such result, or it has been altered.
    """
    from srgc.results.mission_folder import mission_folder

    return MissionResult(folder, mission_folder(folder).design, keeper)
