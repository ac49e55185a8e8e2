"""A whole planning problem as text for other solvers: satisfiable iff there is a plan.

Sources: the DIMACS format of the SAT competitions; Barrett, Fontaine & Tinelli, *The SMT-LIB
standard, version 2.6*, logic QF_UF.
"""

from __future__ import annotations

from collections.abc import Iterator

from compiler.tasks.formula_clauses import Clauses
from compiler.tasks.plan_encoding import plan_encoding
from compiler.tasks.specification import PlanningProblem


def dimacs(problem: PlanningProblem) -> Iterator[str]:
    """Lines of a CNF file; comments name the variables."""
    clauses, arrays = _closed(problem)
    yield from (f"c {line}" for line in _heading(problem))
    yield from (f"c {variable} {name}" for variable, name in clauses.names())
    yield f"p cnf {clauses.variables} {sum(len(array) for array in arrays)}"
    for array in arrays:
        for row in array:
            yield f"{' '.join(map(str, row))} 0"


def smt2(problem: PlanningProblem) -> Iterator[str]:
    """Lines of an SMT-LIB 2 script; the names of Booleans are their meanings."""
    clauses, arrays = _closed(problem)
    yield from (f"; {line}" for line in _heading(problem))
    yield "(set-logic QF_UF)"
    names = [""]
    used: dict[str, int] = {}
    for _, name in clauses.names():
        used[name] = used.get(name, 0) + 1
        names.append(f"|{name}|" if used[name] == 1 else f"|{name} ({used[name]})|")
    yield from (f"(declare-fun {name} () Bool)" for name in names[1:])
    for array in arrays:
        for row in array:
            literals = [names[v] if v > 0 else f"(not {names[-v]})" for v in row]
            body = literals[0] if len(literals) == 1 else f"(or {' '.join(literals)})"
            yield f"(assert {body})"
    yield "(check-sat)"


def _closed(problem: PlanningProblem) -> tuple[Clauses, list[list[list[int]]]]:
    encoding = plan_encoding(problem)
    encoding.close()
    return encoding.clauses, [array.tolist() for array in encoding.clauses.taken()]


def _heading(problem: PlanningProblem) -> Iterator[str]:
    number = problem.changes
    yield f"a plan of at most {number} change{'' if number == 1 else 's'} of cell"
    yield "one cell per position, as many positions as cells are entered"
    if problem.by_samples:
        yield f"positions are entered at samples 0 to {problem.steps}, one after the other"
