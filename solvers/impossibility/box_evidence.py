"""Coverings that are searched for only after the search for a motion.

For structures that a solver refutes, this happens once all structures are refuted, so that nobody
has to trust the solver for the impossibility. For structures without a motion, it happens when none
was found.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import replace

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.candidate import Candidate, robot_in_task
from compiler.robots.normal_form import RobotFamily
from compiler.robots.robot import RobotModel
from compiler.time_limits.time_limit import OutOfTimeError
from grammar_lang import ir
from solvers.conclusion import StructureRecord
from solvers.impossibility.box_refutation import WITH_PROOF, BoxRefutation, box_refutation
from solvers.impossibility.drive_search import AFTER_MOTIONS, drive_refutation
from solvers.run_context import RunContext

WITHOUT_SUCCESS = 5
"""This many searches without a result end it: each takes much longer than a successful one."""
NONE_FOUND = ""


def covered(
    records: Sequence[StructureRecord],
    family: RobotFamily,
    task: ir.Task,
    context: RunContext,
    due: Container[int] | None = None,
) -> tuple[list[StructureRecord], OutOfTimeError | None]:
    """The records of all structures, with the coverings that were found.

    With ``due`` coverings are searched for at these indices alone. A time limit ends the search and
    is returned; refuted structures stay refuted.
    """
    found, failed = list(records), 0
    try:
        for number, record in enumerate(records):
            if failed == WITHOUT_SUCCESS:
                break
            known = record.boxes is not None or record.script is None
            passed_over = due is not None and number not in due
            if record.verdict != "refuted" or known or passed_over:
                continue
            context.check_time()
            derivation = family.replay(record.derivation)
            model = robot_in_task(family, task.origin, derivation)
            boxes = _boxes(number, model, family.program, task, context)
            failed += boxes is None
            found[number] = replace(found[number], boxes=boxes)
    except OutOfTimeError as late:
        return found, late
    return found, None


def out_of_reach_of_drives(
    candidate: Candidate, program: ir.Program, task: ir.Task, context: RunContext
) -> BoxRefutation | None:
    """A proof that drives are too weak for a robot without a known motion; None if not found."""
    key = f"drives|{candidate.number}"
    match context.journal.recall(key):
        case [str(boxes), str(reason)]:
            return BoxRefutation(boxes, reason) if boxes else None
        case _:
            found = None
    if candidate.model is not None:
        workspace = program.workspaces[task.workspace]
        graph = robot_graph(candidate.model, task.gravity)
        found = drive_refutation(candidate.model, graph, workspace, task, AFTER_MOTIONS)
    known = (NONE_FOUND, "") if found is None else (found.boxes, found.reason)
    context.journal.record(key, list(known))
    return found


def _boxes(
    number: int, model: RobotModel, program: ir.Program, task: ir.Task, context: RunContext
) -> str | None:
    """The covering of a structure, by its number; the journal is read first."""
    key = f"boxes|{number}"
    known = context.journal.recall(key)
    if not isinstance(known, str):
        workspace = program.workspaces[task.workspace]
        graph = robot_graph(model, task.gravity)
        answer = box_refutation(model, graph, workspace, task, WITH_PROOF)
        known = NONE_FOUND if answer is None else answer.boxes
        context.journal.record(key, known)
    return known or None
