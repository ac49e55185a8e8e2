"""The outcome of a synthesis, which is a folder, and its report."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike, fspath
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, Literal

from srgc.api.landscape import Landscape, landscape_of
from srgc.api.robot import Robot
from srgc.api.spoken_faults import spoken
from srgc.api.verification import Verification, verify
from srgc.chosen_robot import ChosenRobot
from srgc.faults import UsageFault

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from srgc.report.tables import Trajectory
    from srgc.results.found_design import FoundDesign
    from srgc.results.stated_objectives import Objective
    from srgc.text_reports.synthesis_report import UsedInputs


@dataclass(frozen=True)
class Result:
    """A verdict with its evidence, which is a folder as ``srgc synth`` writes it.

    It can stand wherever the path of such a folder can.

    Attributes:
        folder: where its files are; a temporary folder unless another was asked for.
        design: what its ``design.json`` says.
        keeper: what keeps a temporary folder.
        answers: what the verifier has said so far, which the display of the result shows.
    """

    folder: Path
    design: Mapping[str, Any] = field(repr=False)
    keeper: TemporaryFolder | None = field(default=None, repr=False, compare=False)
    answers: list[Verification] = field(default_factory=list, repr=False, compare=False)

    def __fspath__(self) -> str:
        return fspath(self.folder)

    def __reduce__(self) -> tuple[Callable[..., Result], tuple[object, ...]]:
        """How it is pickled: with what a temporary folder holds, since that is removed with it."""
        if self.keeper is None:
            return Result, (self.folder, self.design, None, self.answers)
        place = self.folder.relative_to(self.keeper.path)
        return _unpickled, (self.keeper.files(), place, self.design, self.answers)

    @property
    def verdict(self) -> Literal["found", "impossible", "unknown"]:
        """Whether a robot was found, or proved impossible, or neither."""
        verdicts: dict[str, Literal["found", "impossible", "unknown"]] = {
            "found": "found", "impossible": "impossible", "unknown": "unknown",
        }  # fmt: skip
        return verdicts[self.design["verdict"]]

    @property
    def reason(self) -> str | None:
        """Why no robot was found; None where one was."""
        return None if self.design["reason"] is None else str(self.design["reason"])

    @property
    def task(self) -> str:
        """The name of the task."""
        return str(self.design["task"])

    @property
    def word(self) -> str | None:
        """The symbols of the robot with blanks between them; None without a robot."""
        return None if self.design["word"] is None else " ".join(self.design["word"])

    @property
    def parameters(self) -> dict[str, float]:
        """The values of the robot's parameters in SI units, named as in ``4.length``."""
        found = self.design["parameters"]
        return {f"{one['symbol']}.{one['name']}": float(one["value"]) for one in found}

    @property
    def robustness(self) -> float | None:
        """What is left of the bounds on inputs, rho; None without a robot."""
        return None if self.word is None else float(self.design["robustness"])

    @property
    def bound(self) -> float | None:
        """The share of their bounds that no robot's inputs keep; None where none was proved."""
        found = self.design.get("bound")
        return None if found is None else float(found["share"])

    @property
    def objectives(self) -> tuple[Objective, ...]:
        """What the robot has of each objective of its task, and what is proved of all robots.

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
        """The robot with its parameters, and the gravity of its task.

        Raises:
            SrgcError: there is none.
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

        Raises:
            SrgcError: there is no robot.
        """
        return self._trajectory()

    @spoken
    def _trajectory(self) -> Trajectory:
        from srgc.report.tables import planned_trajectory

        return planned_trajectory(self._found)

    @property
    def designs(self) -> tuple[Result, ...]:
        """All robots that were found, each a result of its own, where all were asked for."""
        found = [path for path in self.folder.glob("designs/*") if path.name.isdecimal()]
        folders = sorted(found, key=lambda path: int(path.name))
        return tuple(Result(path, _design(path), self.keeper) for path in folders)

    @spoken
    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Copy the files to a folder, as ``srgc synth -o`` writes them.

        Args:
            folder: a new or an empty one, or one with older results of the same synthesis.
            force: replace the results of another one.

        Raises:
            SrgcError: the folder holds something else, or cannot be written.
        """
        from srgc.results.result_folder import copy_results

        return copy_results(self.folder, Path(folder), force=force)

    def verify(self, *, trust: str | None = None) -> Verification:
        """Check the result independently, as ``srgc verify`` does."""
        answer = verify(self.folder, trust=trust)
        self.answers.append(answer)
        return answer

    @spoken
    def report(self, *, verify: bool = True) -> Page:
        """The report of ``srgc report``, as a page that shows itself in a notebook.

        Args:
            verify: whether to check the certificate again, and to show what is proved.
        """
        return page_of(self.folder, verify=verify)

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
        """The robustness of the robot over one or two of its parameters, all else as designed.

        Args:
            over: their names, as ``"4.length"``; by default the first two that may vary.
            ranges: by name the lowest and the highest value to look at.
            points: values per parameter; 11 by default, and 41 on a single one.
            marks: by label points to be marked, a value for each of the parameters.
            jobs: how many processes evaluate.

        Raises:
            SrgcError: there is no robot, or no such parameter, or a range that is none.
        """
        return landscape_of(self.folder, over, ranges or {}, points, marks or {}, jobs)

    def _used(self) -> tuple[UsedInputs, ...]:
        """What the motion uses of its inputs; nothing without one that can be read."""
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
        UsageFault: there is none, or it has been altered.
    """
    from srgc.results.why_folder import tried_folder

    tried_folder(folder)
    return result_in(folder, keeper)


def result_in(folder: Path, keeper: TemporaryFolder | None = None) -> Result:
    """The result in a folder that is known to have one."""
    return Result(folder, _design(folder), keeper)


def _unpickled(
    files: Mapping[str, bytes],
    place: PurePath,
    design: Mapping[str, Any],
    answers: list[Verification],
) -> Result:
    """A result in a temporary folder of its own."""
    keeper = TemporaryFolder.made(files)
    return Result(keeper.path / place, design, keeper, answers)


def _design(folder: Path) -> dict[str, Any]:
    from srgc.results.result_folder import json_object

    return json_object(folder / "design.json")


# --- its report, and where it may live ------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Page:
    """A page of its own, which shows itself in a frame of a notebook.

    Attributes:
        html: the whole page; it loads nothing from elsewhere.
    """

    html: str

    def save(self, path: str | PathLike[str]) -> Path:
        """Write the page to a file.

        Raises:
            SrgcError: it cannot be written.
        """
        from srgc.paths import write_output

        write_output(Path(path), self.html)
        return Path(path)

    def __repr__(self) -> str:
        return f"<Page: {len(self.html.encode()) / 1000:.0f} kB of HTML>"

    def _repr_html_(self) -> str:
        from srgc.api.displays import page_frame

        return page_frame(self.html)


def page_of(folder: Path, *, verify: bool) -> Page:
    """The report of a result folder.

    Raises:
        UsageFault: there are no results, or they have been altered.
    """
    from srgc.report.page import report_page

    return Page(report_page(folder, verify=verify))


@dataclass(frozen=True, slots=True, weakref_slot=True)
class TemporaryFolder:
    """A new folder, which is removed when nothing refers to this any more."""

    path: Path

    @classmethod
    def made(cls, files: Mapping[str, bytes] | None = None) -> TemporaryFolder:
        """A new one, with these files in it."""
        folder = cls(Path(tempfile.mkdtemp(prefix="srgc-")))
        weakref.finalize(folder, shutil.rmtree, folder.path, ignore_errors=True)
        for name, content in (files or {}).items():
            place = folder.path / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
        return folder

    def files(self) -> dict[str, bytes]:
        """All that is in it."""
        return {
            path.relative_to(self.path).as_posix(): path.read_bytes()
            for path in sorted(self.path.rglob("*"))
            if path.is_file()
        }
