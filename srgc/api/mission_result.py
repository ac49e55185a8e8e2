"""The outcome of a mission: a verdict, a design for each task, and what is changed between them."""

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
    """What is changed before a task, by the cheapest way to keep modules.

    Attributes:
        task: the name of the task.
        cost: what all of it costs.
        added: modules with their places in the new word, as ``(6, "JO")``.
        removed: modules with their places in the old word.
        kept: pairs of places, in the old word and in the new one.
        changed: parameters of kept modules that get another value, named as in ``"4.length"``.
    """

    task: str
    cost: float
    added: tuple[tuple[int, str], ...]
    removed: tuple[tuple[int, str], ...]
    kept: tuple[tuple[int, int], ...]
    changed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MissionExplanation:
    """What rules robots out in each task of a mission, and what would be left without it.

    Attributes:
        found: all that is known; not a stable interface.
    """

    found: MissionReasons

    @property
    def refuted(self) -> dict[str, list[str]]:
        """By task what was shown of robots there, in words."""
        return {each.task: list(each.says) for each in self.found.tasks}

    @property
    def cheapest_left(self) -> float | None:
        """What no robots that are left cost less than; None where none are, or it is not known."""
        left = self.found.left
        return None if left is None else float(left.cost)

    @property
    def undecided(self) -> dict[str, list[str]]:
        """By task the robots that are neither found nor refuted, and why, in words.

        What is about all tasks together stands under their names in one text: ``"Pack, Sort"``.
        """
        together = ", ".join(self.found.mission.mission.tasks)
        return {
            task or together: [one.says() for one in each]
            for task, each in self.found.undecided.items()
        }

    @property
    def try_first(self) -> str | None:
        """What may be done about what ended the search; None where nothing did."""
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
    """A verdict about a mission, which is a folder as ``srgc synth --mission`` writes it.

    So is one step of ``srgc evolve``.  It can stand wherever the path of such a folder can.

    Attributes:
        folder: where its files are; a temporary folder unless another was asked for.
        design: what its ``design.json`` says.
        keeper: what keeps a temporary folder.
        answers: what the verifier has said so far, which the display of the result shows.
    """

    @property
    def mission(self) -> str:
        """The name of the mission; of one step from a robot, that of its task."""
        return str(self.design["mission"])

    @cached_property
    def _folder(self) -> MissionFolder:
        from srgc.results.mission_folder import mission_folder

        return mission_folder(self.folder)

    @property
    def tasks(self) -> tuple[str, ...]:
        """The names of the tasks, in their order."""
        return tuple(str(self.design["task"]).split(", "))

    @property
    def one_robot(self) -> bool:
        """Whether one robot is to do all tasks, not robots that are rebuilt between them."""
        return bool(self.design["kind"] == "one robot")

    @property
    def designs(self) -> dict[str, Result]:
        """By the name of the task its design, an ordinary result; none unless found."""
        return {
            str(each["task"]): result_in(self.folder / "tasks" / str(each["task"]), self.keeper)
            for each in self.design["robots"]
        }

    @property
    def cost(self) -> float | None:
        """What all changes cost; None without robots, and of one robot."""
        return None if self.design["cost"] is None else float(self.design["cost"])

    @property
    def least(self) -> float | None:
        """What no robots cost less than; None where there is no ``cost``."""
        return None if self.cost is None else float(self.design["least"])

    @property
    def differs(self) -> dict[str, tuple[str, ...]]:
        """Modules of the robot before that the specification builds otherwise, and in what.

        As in ``{"Limb": ("parameter length", "bodies")}``; kept ones are as it says.
        """
        return {each["module"]: tuple(each["what"]) for each in self.design["differs"]}

    @property
    def steps(self) -> tuple[RobotChange | None, ...]:
        """What is changed before each task; None before the first one, unless there is a robot.

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
        """What rules other robots out, as ``srgc why`` says it.

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
        UsageFault: there is none, or it has been altered.
    """
    from srgc.results.mission_folder import mission_folder

    return MissionResult(folder, mission_folder(folder).design, keeper)
