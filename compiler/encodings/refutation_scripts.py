"""Every script that refutes a robot for a task: without its body first, then with it."""

from __future__ import annotations

from collections.abc import Iterator

from compiler.encodings.body_conditions import body_demands
from compiler.encodings.body_smt import body_script, body_scripts
from compiler.encodings.pose_questions import pose_questions
from compiler.encodings.reachability_smt import refutation_script
from compiler.robots.robot import RobotModel
from grammar_lang import ir


def refutation_scripts(model: RobotModel, workspace: ir.Workspace, task: ir.Task) -> Iterator[str]:
    """The scripts in a fixed order, made one by one; any of them that is ``unsat`` refutes."""
    demands = body_demands(workspace, task)
    for question in pose_questions(workspace, task):
        yield refutation_script(model, question)
        if demands is None:
            continue
        for poses in body_scripts(question):
            script = body_script(model, question, demands, poses)
            if script is not None:
                yield script
