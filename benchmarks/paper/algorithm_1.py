"""Algorithm 1: its lines, the loop as the paper prints it, and the one that srgc runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from paper.paper_loop import Step
from paper.section import Section, inline_html, number_of, paragraph, table, word
from paper.syntheses import Synthesis
from srgc.render.html_text import many, text

LINES = (
    ("1", "ω = q₀", "structures by length, each asked first whether it has poses for the task"),
    ("2", "𝒲* = WS.Abstraction(𝒲)", "convex cells, in exact arithmetic"),
    ("3", "while no feasible trajectory has been found", "until a motion is proved"),
    ("4", "κ = SAT(P*, ℋ*, N*)", "a SAT solver, paths with few changes of cell first"),
    ("5", "θ* = argmax ρ(ω, θ, 𝒲*, x̄, κ)", "GP-ACB, then θ as a variable of convex programs"),
    ("6–8", "if ρ &lt; 0: φ_c = CounterExample; κ = κ ∧ φ_c",
     "a minimal set of cells that cannot be followed; paths through these are deferred"),
    ("9–10", "if κ = ∅: ω = S.Synthesis(ω)", "the next structure, and no claim about this one"),
    ("11–12", "else break", "only when the nonlinear motion is proved in continuous time"),
    ("13", "return ω, θ", "the design with its certificate"),
)  # fmt: skip
"""The lines of the algorithm, and what srgc does in their place; HTML."""


@dataclass
class Path:
    """A path of cells that a search tried, and the best robustness after each improvement."""

    cells: tuple[str, ...]
    best: list[float] = field(default_factory=list[float])


@dataclass
class Structure:
    """A structure that a search tried: its number, its symbols, its paths, and notes."""

    number: int
    symbols: tuple[str, ...]
    paths: list[Path] = field(default_factory=list[Path])


def structures(told: Sequence[str]) -> list[Structure]:
    """The structures and paths that ``srgc synth`` told of, line by line."""
    found = list[Structure]()
    for line in told:
        head, _, rest = line.partition(": ")
        if head.startswith("structure "):
            found.append(Structure(int(head.split()[1]), tuple(rest.split())))
        elif head == "path":
            found[-1].paths.append(Path(tuple(rest.split(" > "))))
        elif head == "best robustness":
            found[-1].paths[-1].best.append(float(rest.split()[0]))
    return found


def algorithm_1(steps: Sequence[Step], found: Synthesis) -> Section:
    """The lines, both traces, and what they are to each other."""
    lines = table(
        "Algorithm 1, line by line",
        ("Line", "The paper", "srgc"),
        [(number, paper, ours) for number, paper, ours in LINES],
    )
    content = (
        f"{lines}"
        + paragraph(
            "The first trace is the paper's loop as printed, on its own two structures, with the "
            "planner and the control synthesis of srgc: GP-ACB alone chooses the lengths, and "
            "nothing is proved."
        )
        + paper_table(steps)
        + paragraph(
            "The second is what <code>srgc synth specs/planar_arm.srg</code> does. A structure "
            "that cannot have poses for the task is refuted before a path is planned: "
            f"{_needed(found)}. "
            "What the paper concludes from a search that failed (erratum 4.11) is proved here."
        )
        + srgc_table(found)
    )
    return Section("algorithm-1", "Algorithm 1, step by step", content)


def _needed(found: Synthesis) -> str:
    count = len(found.design["counterexamples"])
    if not count:
        return "no counterexample of a path was needed"
    return f"{many(count, 'counterexample')} of paths {'was' if count == 1 else 'were'} needed"


def paper_table(steps: Sequence[Step]) -> str:
    """The rounds of the paper's loop."""
    rows = [
        (
            str(number),
            word(step.word.split()),
            _cells(step.path),
            f"{number_of(step.robustness, 2)} at {_lengths(step.lengths)}",
            _core(step),
            _verdict(step, steps[number:]),
        )
        for number, step in enumerate(steps, start=1)
    ]
    names = ("Step", "Structure ω", "Path κ", "Best ρ (N*m)", "Counterexample φ_c", "Verdict")
    return table("The loop as the paper prints it", names, rows)


def _lengths(values: Sequence[float]) -> str:
    return f"({', '.join(number_of(value, 2) for value in values)}) m"


def _core(step: Step) -> str:
    if step.core is None:
        return "none"
    if not step.core:
        return "no cell: no motion was found whatever the cells"
    return f"{_cells(step.core)}{'' if step.ordered else ', in any order'}"


def _verdict(step: Step, later: Sequence[Step]) -> str:
    if step.explained:
        return "ρ &lt; 0 by GP-ACB, but no counterexample: convex programs found a motion"
    if step.core is None:
        return "ρ ≥ 0: the loop ends with ω and θ*"
    if later and later[0].word == step.word:
        return "ρ &lt; 0: paths with these cells are left out"
    return "ρ &lt; 0, and no path is left: next structure"


def srgc_table(found: Synthesis) -> str:
    """What srgc's loop did, structure by structure and path by path."""
    tried = found.design["structures_tried"]
    told = structures(found.told)
    rows = [
        row for structure in told for row in _rows(structure, tried[structure.number], found.design)
    ]
    names = ("Structure", "ω", "Path κ", "Best ρ (N*m)", "Core or evidence", "Verdict")
    return table("The loop of srgc", names, rows)


def _rows(
    structure: Structure, record: Mapping[str, Any], design: Mapping[str, Any]
) -> Iterator[tuple[str, ...]]:
    head = str(structure.number), word(structure.symbols)
    if not structure.paths:
        yield (*head, "none planned", "", _evidence(record), text(record["verdict"]))
    excluded = [each for each in design["counterexamples"] if each["structure"] == structure.number]
    for place, path in enumerate(structure.paths):
        core = next((each for each in excluded if set(each["cells"]) <= set(path.cells)), None)
        proved = record["verdict"] == "found" and place == 0
        why = "none" if core is None else _cells(core["cells"])
        best = " → ".join(number_of(value, 2) for value in path.best)
        verdict = (
            f"found: {text(record['evidence'])}, ρ = {number_of(design['robustness'], 3)}"
            if proved
            else "another way round for the proved design: not more robust"
            if record["verdict"] == "found"
            else text(record["verdict"])
        )
        yield (*head, _cells(path.cells), best, why, verdict)


def _evidence(record: Mapping[str, Any]) -> str:
    reason = f": {inline_html(record['reason'])}" if record["reason"] else ""
    return f"{text(record['evidence'])}{reason}"


def _cells(cells: Sequence[str]) -> str:
    return " → ".join(f"<code>{text(cell)}</code>" for cell in cells)
