"""The gallery: its examples, what `make gallery` has measured of them, and the page of both.

``docs/gallery/examples.toml`` lists the examples, ``docs/gallery/runs`` has a file for each that
has been run, and beside them stand the pictures and the page. Reports are not kept: the site has
those that ``out/gallery`` has when it is built.
"""

from __future__ import annotations

import json
import re
import shutil
import tomllib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

ROOT = Path(__file__).parents[2]
GALLERY = ROOT / "docs" / "gallery"
MADE = "out/gallery"
"""Where results are, a folder for each example."""
BUSY = 0.85
"""A run with less processor time than this share of its time had to wait for other programs."""
_REPORT = re.compile(r"<!-- report (\w+) -->")


@dataclass(frozen=True, slots=True)
class Example:
    """An example: what it is of, its spec from the root, what it shows, and what is expected."""

    kind: str
    title: str
    spec: str
    says: str
    verdict: str = "found"

    @property
    def name(self) -> str:
        """That of its files."""
        return Path(self.spec).stem

    @property
    def commands(self) -> dict[str, str]:
        """All that is run for it, in order, without the ``srgc`` in front."""
        folder = f"{MADE}/{self.name}"
        found = {"synth": f"synth {self.spec} -o {folder}", "verify": f"verify {folder}"}
        if self.verdict == "found":
            found["picture"] = f"export {folder} --to svg -o {folder}.svg"
        else:
            found["picture"] = f"plan {self.spec} -o {folder}.svg"
            found["why"] = f"why {folder} --no-runs"
        return {**found, "report": f"report {folder}"}


@dataclass(frozen=True, slots=True)
class Step:
    """A command that was run: seconds, seconds of the processor, and the peak of memory in MiB."""

    seconds: float
    cpu: float
    peak: float

    @property
    def shown(self) -> str:
        """The time, or where other programs kept the machine busy that of the processor, signed."""
        busy = self.cpu < BUSY * self.seconds
        time = self.cpu if busy else self.seconds
        return f"{time:.{1 if time < 100 else 0}f} s{'†' if busy else ''}"


@dataclass(frozen=True, slots=True)
class Run:
    """What came of an example, and where it was measured.

    Attributes:
        commands: what was run, as the example says it.
        code: digest of the code.
        files: digests of the spec and of all that it reads, by their paths below its folder.
        machine: cores, system and Python.
        date: the day.
        printed: what ``synth`` printed about its answer, and ``why``.
        steps: by the names of the commands.
    """

    commands: dict[str, str]
    code: str
    files: dict[str, str]
    machine: str
    date: str
    printed: list[str]
    steps: dict[str, Step]

    def text(self) -> str:
        """As a file."""
        return json.dumps(asdict(self), indent=1, ensure_ascii=False) + "\n"


def read_examples(folder: Path = GALLERY) -> list[Example]:
    """All examples, in their order."""
    content = tomllib.loads((folder / "examples.toml").read_text(encoding="utf-8"))
    return [Example(**each) for each in content["example"]]


def read_run(example: Example, folder: Path = GALLERY) -> Run | None:
    """What was measured of an example; None where nothing was."""
    file = folder / "runs" / f"{example.name}.json"
    if not file.exists():
        return None
    content = json.loads(file.read_text(encoding="utf-8"))
    steps = {name: Step(**step) for name, step in content.pop("steps").items()}
    return Run(**content, steps=steps)


# --- the page -------------------------------------------------------------------------------------


def page(examples: Sequence[Example], runs: Mapping[str, Run]) -> str:
    """The page as Markdown: a table of all examples, and a card for each."""
    lines = ["# Gallery", "", *_introduction(runs), "", *_table(examples, runs), ""]
    for example in examples:
        lines += [*_card(example, runs.get(example.name)), ""]
    return "\n".join(lines).rstrip() + "\n"


def _introduction(runs: Mapping[str, Run]) -> Iterator[str]:
    yield "Examples of what srgc is for, each with its spec in `specs/`. The pictures are drawn by"
    yield "`srgc export --to svg` from results that `srgc verify` has checked. `make gallery` runs"
    yield "all of them again, writes this page, and leaves results and reports in `out/gallery`."
    if not runs:
        return
    places: dict[str, str] = {}
    for run in runs.values():
        places[run.machine] = max(run.date, places.get(run.machine, ""))
    measured = "; ".join(f"{machine} ({date})" for machine, date in sorted(places.items()))
    yield ""
    yield f"Measured on {measured}. Each command is a process of its own; memory is its peak."
    if any(_is_busy(run) for run in runs.values()):
        yield "†: time of the processor, since other programs kept the machine busy."


def _is_busy(run: Run) -> bool:
    return any("†" in run.steps[name].shown for name in ("synth", "verify"))


def _table(examples: Sequence[Example], runs: Mapping[str, Run]) -> Iterator[str]:
    yield "| kind | example | verdict | `synth` | `verify` | memory |"
    yield "|---|---|---|---:|---:|---:|"
    for example in examples:
        link = f"[{example.title}](#{_anchor(example.title)})"
        run = runs.get(example.name)
        figures = "not yet run | | | |"
        if run is not None:
            synth, verify = run.steps["synth"], run.steps["verify"]
            peak = max(synth.peak, verify.peak)
            figures = f"{example.verdict} | {synth.shown} | {verify.shown} | {peak:.0f} MiB |"
        yield f"| {example.kind} | {link} | {figures}"


def _anchor(title: str) -> str:
    """The fragment of a heading, as GitHub and Sphinx make it."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def _card(example: Example, run: Run | None) -> Iterator[str]:
    yield f"## {example.title}"
    yield ""
    if run is not None:
        yield f"![{_seen(example)}]({example.name}.svg)"
        yield ""
    yield f"{example.says}"
    yield f"[`{example.spec}`](../../{example.spec})<!-- report {example.name} -->"
    yield ""
    shown = [name for name in example.commands if name != "picture"]
    yield "```sh"
    yield from (f"srgc {example.commands[name]}" for name in shown)
    yield "```"
    if run is not None:
        yield ""
        yield "```text"
        yield from run.printed
        yield "```"


def _seen(example: Example) -> str:
    """What the picture shows, for those who do not see it."""
    moving = "the motion of the robot" if example.verdict == "found" else "the workspace"
    return f"{example.title}: {moving}, drawn by srgc"


# --- reports on the site --------------------------------------------------------------------------


def with_reports(text: str, made: Path) -> str:
    """The page with links to the reports that there are."""

    def link(found: re.Match[str]) -> str:
        there = (made / found[1] / "report.html").is_file()
        return f' · <a href="reports/{found[1]}.html">report</a>' if there else ""

    return _REPORT.sub(link, text)


def copy_reports(made: Path, site: Path) -> None:
    """Put the reports that there are where the page looks for them."""
    for example in read_examples():
        report = made / example.name / "report.html"
        if report.is_file():
            target = site / "gallery" / "reports" / f"{example.name}.html"
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(report, target)
