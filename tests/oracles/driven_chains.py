"""Chains of joints and rods as programs, and what a uniform covering says of their drives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from compiler.expressions.evaluators.balls import working_precision
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from compiler.unreachability.actuation_reach import DriveBound, drive_reach, out_of_reach
from compiler.unreachability.box_tree import LEAF, CoordinateTree, Part
from compiler.unreachability.covered_poses import CoveredPoses
from compiler.unreachability.motion_conditions import motion_conditions
from compiler.words.structures import structures
from grammar_lang import ir
from tests.oracles.formulas import program

LIMITED = "in [-170, 170] deg"


@dataclass(frozen=True, slots=True)
class Segment:
    """A joint and the rod behind it; ``own`` is its module's own dynamics."""

    length: float | str
    axis: str = "z"
    along: str = "x"
    kind: str = "revolute"
    limits: str = LIMITED
    own: str = ""
    density: float = 1.0
    effector: bool = False


def chain(segments: Sequence[Segment]) -> str:
    """The modules, the grammar and the semantics of one robot; the last rod has an effector."""
    modules = ["module B { role base; } module E { role effector; } edge eps;"]
    rules, blocks = ["b: N0 -> B;"], ["b { this.frame = world; }"]
    for i, item in enumerate(segments):
        length = item.length
        held = f"const length = {length} m;"
        if isinstance(length, str):
            held = f"param length in {length} m;"
        modules.append(
            f"module J{i} {{ role joint; dof q: {item.kind} {item.axis} {item.limits}; "
            f"{item.own} }}"
            f"module L{i} {{ role link; {held} const density = {item.density} kg/m; }}"
        )
        moves = "rot" if item.kind == "revolute" else "move"
        tip = f"N{i}.frame * {moves}({item.axis}, J{i}.q)"
        last = " eps E" if item.effector else ""
        rules.append(f"j{i}: P{i} -> N{i} eps J{i}; l{i}: N{i + 1} -> P{i} eps L{i}{last};")
        effector = "effector(frame: this.frame);" if item.effector else ""
        blocks.append(
            f"j{i} {{ this.frame = {tip}; }} "
            f"l{i} {{ this.frame = P{i}.frame * move({item.along}, L{i}.length);"
            f"rod(frame: P{i}.frame, axis: {item.along}, length: L{i}.length, "
            f"density: L{i}.density); {effector} }}"
        )
    count = len(segments)
    rules.append(f"t: S -> N{count} eps E;")
    blocks.append(f"t {{ this.frame = N{count}.frame; effector(frame: N{count}.frame); }}")
    grammar = f"grammar G {{ start S; {' '.join(rules)} }}"
    return "\n".join([*modules, grammar, f"semantics G {{ {' '.join(blocks)} }}"])


def spot(point: Sequence[float], radius: float = 1e-3) -> str:
    """A small box about a point."""
    return " x ".join(f"[{x - radius:.9f}, {x + radius:.9f}]" for x in point)


def problem(segments: Sequence[Segment], target: str, clauses: str, start: str = "") -> str:
    """A program with one robot and one task; ``start`` and ``target`` are boxes in metres."""
    space = target.count(" x ") == 2
    head = "space xyz;" if space else "plane xy;"
    bounds = " x ".join(["[-30, 30]"] * (3 if space else 2))
    region = f"region A box {start} m;" if start else ""
    return (
        f"{chain(segments)}\nworkspace W {{ {head} bounds box {bounds} m; {region} "
        f"target T box {target} m; }}\ntask P {{ robot G; workspace W; {clauses} }}"
    )


def robot_of(text: str) -> tuple[RobotModel, ir.Workspace, ir.Task]:
    """The one robot of a program, with its workspace and its task."""
    loaded = program(text)
    (task,) = loaded.tasks.values()
    family = family_of(loaded, task)
    (derivation,) = structures(family.language, 12)
    return family.robot(derivation), loaded.workspaces[task.workspace], task


def uniform(halvings: Sequence[int]) -> CoordinateTree:
    """The tree that halves every coordinate so often."""
    if not any(halvings):
        return (LEAF,)
    most = max(range(len(halvings)), key=lambda i: halvings[i])
    below = uniform([n - (i == most) for i, n in enumerate(halvings)])
    return (most, *below, *below)


def answers(
    text: str, halvings: Sequence[int], parameters: Sequence[Part] | None = None
) -> list[list[DriveBound | None]]:
    """Per question and choice of effectors, what is shown on a uniform covering."""
    model, workspace, task = robot_of(text)
    with working_precision(64):
        drive = drive_reach(model, workspace, task)
        poses = CoveredPoses(motion_conditions(model, workspace, task))
        box = tuple(parameters or [Part()] * len(model.parameters))
        cover = poses.cover(poses.parameters_of(box), uniform(halvings))
        return [
            [out_of_reach(drive, item, cover.parameters, cover.leaves(item)) for item in choices]
            for choices in poses.demands.passages
        ]


def answer(
    text: str, halvings: Sequence[int], parameters: Sequence[Part] | None = None
) -> DriveBound | None:
    """The same for a task with one question and one choice."""
    ((found,),) = answers(text, halvings, parameters)
    return found
