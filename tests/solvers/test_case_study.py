"""The paper's case study, whole: what is found, against independent calculations."""

from __future__ import annotations

import csv
import shutil
from fractions import Fraction

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load
from solvers.search.evaluation import evaluate
from solvers.trajectory.control_problem import FULL
from solvers.trajectory.path_following import PathProblem
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.result_files import alter, read
from tests.oracles.two_rods import FINE, simulated

PUBLISHED = (2.23, 3.35)
RUNS = ["planar_arm", "planar_arm_paper"]


@pytest.mark.parametrize("spec", RUNS)
def test_found_and_valid(made, spec):
    place = made(spec)
    assert (place / "status").read_text() == "0"
    design = read(place / "out", "design.json")
    links = ["L", "L"] if spec == "planar_arm" else ["L1", "L2"]
    assert design["verdict"] == "found"
    assert design["word"] == f"B eps JO eps {links[0]} eps JO eps {links[1]} eps EN".split()
    assert [d["symbols"] for d in design["dofs"]] == [[2], [6]]
    assert [p["symbol"] for p in design["parameters"]] == [4, 8]
    if spec == "planar_arm_paper":
        assert tuple(p["value"] for p in design["parameters"]) == PUBLISHED
    report = verify_directory(place / "out", place / f"{spec}.srg")
    assert (report.outcome, report.level) == (Outcome.VALID, "validated")
    assert all(f.margin >= 0 for f in report.conditions)
    margins = {f.name for f in report.conditions}
    assert margins >= {"effort (N*m)", "clearance of effector to O", "target T", "bounds"}


@pytest.mark.parametrize("spec", RUNS)
def test_every_earlier_structure_is_refuted_with_a_script(made, spec):
    folder = made(spec) / "out"
    design = read(folder, "design.json")
    *earlier, last = design["structures_tried"]
    assert last["verdict"] == "found"
    assert earlier
    keys = [(len(s["word"]), s["word"]) for s in earlier]
    assert [k[0] for k in keys] == sorted(k[0] for k in keys)
    scripts = {lemma["evidence"] for lemma in design["lemmas"] if lemma.get("evidence")}
    for structure in earlier:
        assert structure["verdict"] == "refuted"
        if "lemma" in structure:
            continue
        text = (folder / structure["evidence"]).read_text(encoding="utf-8")
        assert "(check-sat)" in text
        first = structure["same_robot_as"]
        if first is None:
            assert structure["evidence"] not in scripts
            scripts.add(structure["evidence"])
        else:
            assert earlier[first]["evidence"] == structure["evidence"]
            assert earlier[first]["same_robot_as"] is None
    assert sorted(p.name for p in folder.glob("proofs/*")) == sorted(
        name.removeprefix("proofs/") for name in scripts
    )


@pytest.mark.parametrize("spec", RUNS)
def test_an_independent_simulation_does_the_task(made, spec):
    folder = made(spec) / "out"
    certificate = read(folder)
    times, states, (x, y) = simulated(certificate)
    assert 0.8 < x[0] < 1.2
    assert 1.0 < y[0] < 1.4
    assert list(states[0, 2:]) == [0, 0]
    assert 3.5 < x[-1] < 4.2
    assert 3.8 < y[-1] < 4.5
    assert np.all((x > 0) & (x < 5) & (y > 0) & (y < 5))
    beside, above = np.maximum(1.7 - x, x - 3), np.maximum(2 - y, y - 3)
    assert np.all(np.maximum(beside, above) > 0)
    # The Euclidean distance to the obstacle, corners included.
    outside = np.hypot(np.maximum(beside, 0), np.maximum(above, 0))
    assert np.all(np.abs(states[:, :2]) < np.pi)
    efforts = [abs(Fraction(u)) for row in certificate["inputs"] for u in row]
    assert max(efforts) == Fraction(certificate["effort_peak"])
    assert 10 - max(efforts) == Fraction(certificate["robustness"])

    report = verify_directory(folder)
    margins = {f.name: f.margin for f in report.conditions}
    assert margins["clearance of effector to O"] <= outside.min() + 1e-9
    assert margins["clearance of effector to O"] >= 0.9 * outside.min()
    ends = min(x[-1] - 3.5, 4.2 - x[-1], y[-1] - 3.8, 4.5 - y[-1])
    assert margins["target T"] == pytest.approx(ends, abs=1e-6)
    assert margins["bounds"] == pytest.approx(np.min([x, 5 - x, y, 5 - y]), rel=0.03)

    with (folder / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        head, *rows = list(csv.reader(file))
    assert head == ["t", "q1", "q2", "qd1", "qd2", "u1", "u2", "e1_x", "e1_y"]
    table = np.array([[float(cell or "nan") for cell in row] for row in rows])
    assert len(table) == 82
    # The table is of the searcher's own integration, which the proof does not rely on.
    assert np.abs(table[:, 1:5] - states[::FINE]).max() < 1e-3
    assert np.abs(table[:, 7:] - np.array([x, y]).T[::FINE]).max() < 1e-3
    assert np.allclose(table[:, 0], times[::FINE])


def test_the_design_is_better_than_the_published_one_on_its_own_path(made):
    found, published = (read(made(spec) / "out", "design.json") for spec in RUNS)
    assert found["robustness"] >= published["robustness"]


def test_the_published_lengths_on_the_path_found(made):
    folder = made("planar_arm") / "out"
    design = read(folder, "design.json")
    program = load(folder / "spec" / "planar_arm.srg").program
    task = program.tasks["PickAndPlace"]
    workspace = program.workspaces[task.workspace]
    cells = abstract(workspace)
    family = family_of(program, task)
    model = family.robot(family.replay(tuple(design["derivation"])))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    path = tuple(cells.index(name) for name in dict.fromkeys(design["path"][0]))
    path_problem = PathProblem(numeric, workspace, task, cells, 0, path, 2e-3, 0)
    outcome = evaluate(path_problem, np.array(PUBLISHED), FULL)
    assert outcome.feasible
    assert design["robustness"] >= outcome.robustness


def test_one_field_changed_is_refused(made, tmp_path):
    """The arm's own certificate: an effort, a length, the path, the word."""
    changes = {
        "effort (N*m): violated": lambda c: c["inputs"][40].__setitem__(1, "10.01"),
        "is outside its range": lambda c: c["parameters"][0].update(value="5.01"),
        "goes through `O`": lambda c: c["path"][0].__setitem__(40, "O"),
        "does not derive the word": lambda c: c["word"].__setitem__(4, "JO"),
    }
    for number, (reason, change) in enumerate(changes.items()):
        folder = tmp_path / str(number)
        shutil.copytree(made("planar_arm") / "out", folder)
        alter(folder, change, sign=False)
        assert "altered" in str(verify_directory(folder).reason)
        alter(folder, lambda _content: None, sign=True)
        report = verify_directory(folder)
        assert report.outcome is Outcome.REFUTED
        assert reason in str(report.reason)
