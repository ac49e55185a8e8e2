"""The result of a synthesis for one task: a verdict with its evidence, in a folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from srgc.api.folder_result import FolderResult, TemporaryFolder
from srgc.api.landscape import Landscape, landscape_of
from srgc.api.robot import Robot
from srgc.api.spoken_faults import spoken
from srgc.chosen_robot import ChosenRobot
from srgc.faults import UsageFault

if TYPE_CHECKING:
    from collections.abc import Sequence

    from srgc.api.trajectory import Trajectory
    from srgc.results.found_design import FoundDesign
    from srgc.results.stated_objectives import Objective
    from srgc.text_reports.synthesis_report import UsedInputs


@dataclass(frozen=True)
class Result(FolderResult):
    """A verdict about a task with its evidence, in a folder as ``srgc synth`` writes it.

    It can be used instead of the path of that folder.

    Attributes:
        folder: the folder with its files; a temporary one unless another was requested.
        design: the content of its ``design.json``.
        keeper: the owner of a temporary folder, or None; the folder exists as long as its owner.
        answers: the answers of ``verify`` so far; the display of the result shows the last one.
    """

    @property
    def task(self) -> str:
        """The name of the task."""
        return str(self.design["task"])

    @property
    def word(self) -> str | None:
        """The symbols of the robot, separated by blanks; None without a robot."""
        return None if self.design["word"] is None else " ".join(self.design["word"])

    @property
    def parameters(self) -> dict[str, float]:
        """The values of the robot's parameters in SI units, by name, such as ``"4.length"``."""
        found = self.design["parameters"]
        return {f"{one['symbol']}.{one['name']}": float(one["value"]) for one in found}

    @property
    def robustness(self) -> float | None:
        """The robustness rho, the least distance of an input from its bound; None without a robot.

        Each input counts in its own unit.
        """
        return None if self.word is None else float(self.design["robustness"])

    @property
    def bound(self) -> float | None:
        """A proved upper bound on the robustness of all robots, as a fraction; None without one.

        It bounds ``robustness_share`` of ``design.json``, and only ``gap`` asks for it.
        """
        found = self.design.get("bound")
        return None if found is None else float(found["share"])

    @property
    def objectives(self) -> tuple[Objective, ...]:
        """The value of each objective of the task, with what is proved about all robots.

        Raises:
            SrgcError: the results have been altered.
        """
        return self._objectives()

    @spoken
    def _objectives(self) -> tuple[Objective, ...]:
        from srgc.results.stated_objectives import stated_objectives

        return stated_objectives(self.design, self.folder / "design.json")

    @property
    def effort_peak(self) -> float | None:
        """The largest effort; None without a robot."""
        return None if self.word is None else float(self.design["effort_peak"])

    @cached_property
    def _found(self) -> FoundDesign:
        from srgc.results.found_design import found_design

        return found_design(self.folder)

    @cached_property
    def robot(self) -> Robot:
        """The robot with its parameters, under the gravity of its task.

        Raises:
            SrgcError: the result has no robot.
        """
        return self._robot()

    @spoken
    def _robot(self) -> Robot:
        found = self._found
        grammar = found.program.grammars[found.task.grammar]
        word, labels = found.derivation.word, tuple(found.derivation.labels)
        chosen = ChosenRobot(found.program, word, labels, found.model, grammar, found.task)
        return Robot(chosen, found.stated)

    @cached_property
    def trajectory(self) -> Trajectory:
        """The motion at its samples, as arrays in SI units: t, q, qd, s, u, effectors.

        ``plot`` draws the motion over time.

        Raises:
            SrgcError: the result has no robot.
        """
        return self._trajectory()

    @spoken
    def _trajectory(self) -> Trajectory:
        from srgc.api.trajectory import trajectory_of

        return trajectory_of(self._found)

    @property
    def designs(self) -> tuple[Result, ...]:
        """With ``every`` or ``pareto``: a result for each design that was kept; otherwise empty."""
        found = [path for path in self.folder.glob("designs/*") if path.name.isdecimal()]
        folders = sorted(found, key=lambda path: int(path.name))
        return tuple(Result(path, _design(path), self.keeper) for path in folders)

    @spoken
    def landscape(
        self,
        over: str | Sequence[str] | None = None,
        *,
        ranges: Mapping[str, tuple[float, float]] | None = None,
        points: int | None = None,
        marks: Mapping[str, Sequence[float]] | None = None,
        jobs: int = 1,
    ) -> Landscape:
        """Evaluate the robustness over one or two parameters, with everything else as designed.

        Args:
            over: the names of the parameters, such as ``"4.length"``; by default the first two
                that may vary.
            ranges: the lowest and the highest value to evaluate, by parameter.
            points: the number of values per parameter; by default 11, or 41 for one parameter.
            marks: points to mark in the picture, by label; each has a value per parameter.
            jobs: the number of processes.

        Raises:
            SrgcError: there is no robot or no such parameter, or a range is invalid.
        """
        return landscape_of(self.folder, over, ranges or {}, points, marks or {}, jobs)

    def _used(self) -> tuple[UsedInputs, ...]:
        """How much of its inputs the motion uses; empty without a motion that can be read."""
        from srgc.text_reports.synthesis_report import used_inputs

        if self.word is None:
            return ()
        try:
            found = self._found
        except UsageFault:
            return ()
        return used_inputs(found.model, found.task, found.claim.inputs)

    def __repr__(self) -> str:
        said = self.word or self.reason
        return f"<Result {self.task}: {self.verdict}{', ' if said else ''}{said or ''}>"

    def __str__(self) -> str:
        from srgc.api.displays import result_text

        return result_text(self.design, self._used())

    def _repr_html_(self) -> str:
        from srgc.api.displays import result_html

        said = self.answers[-1].report if self.answers else None
        return result_html(self.folder, self.design, self._used(), said)


def opened(folder: Path, keeper: TemporaryFolder | None = None) -> Result:
    """The result in a folder.

    Raises:
        UsageFault: the folder has no result, or the result has been altered.
    """
    from srgc.results.why_folder import tried_folder

    tried_folder(folder)
    return result_in(folder, keeper)


def result_in(folder: Path, keeper: TemporaryFolder | None = None) -> Result:
    """The result in a folder that is known to contain one."""
    return Result(folder, _design(folder), keeper)


def _design(folder: Path) -> dict[str, Any]:
    from srgc.results.result_folder import json_object

    return json_object(folder / "design.json")
