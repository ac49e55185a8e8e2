"""The verifier on impossibilities that coverings prove: what holds, and what is refused."""

from __future__ import annotations

import shutil

import pytest

from compiler.robots.normal_form import family_of
from grammar_lang.load import load
from solvers.verifier.refutations.structure_evidence import refutation_scripts
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.coverings import covering
from tests.oracles.refuted_folders import claim_impossible
from tests.oracles.result_files import alter, alter_spec, read, write
from tests.oracles.small_specs import BEYOND_REACH, replaced

LINK = covering("AA", "aaaaaa")
COVERINGS = {
    "B eps JO eps EN": covering("", ""),
    "B eps JO eps L eps EN": LINK,
    "B eps JO eps EN eps L": covering("", ""),
    "B eps JO eps EN eps EN": covering("", ""),
}
TOO_COARSE = covering("", "aaa")


@pytest.fixture(scope="session")
def claimed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("boxes") / "out"
    return claim_impossible(folder, BEYOND_REACH, 4, COVERINGS)


@pytest.fixture
def folder(claimed, tmp_path):
    return shutil.copytree(claimed, tmp_path / "out")


def refused(folder, reason):
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert reason in str(report.reason)


def structure(number, **changes):
    return lambda content: content["structures"][number].update(changes)


def test_no_solver_is_believed(folder, capsys, monkeypatch):
    module = "solvers.verifier.refutations.structure_evidence.agreed"
    monkeypatch.setattr(module, lambda *_arguments: pytest.fail("a solver was asked"))
    report = verify_directory(folder)
    assert (report.outcome, report.verdict) == (Outcome.VALID, "impossible")
    assert (report.level, report.reason) == ("validated", None)
    assert verify_directory(folder, trust="z3").level == "validated"
    assert run(["verify", str(folder)]) == 0
    assert capsys.readouterr().out.startswith("valid: impossible, level validated")
    same = [s["same_robot_as"] for s in read(folder)["structures"]]
    assert same == [None, 0, None, 0, None, None]


def test_a_changed_covering_proves_nothing(folder):
    path = folder / "proofs" / "0002.boxes"
    for text, reason in (
        (TOO_COARSE, "0002.boxes does not refute structure 2: box 1 of the parameters"),
        (LINK.replace("boxes 1", "boxes 2"), "the first line"),
        (LINK + ".", "something follows"),
        (LINK[:-5], "too early"),
        (covering("AAB", "aaaaaa"), "does not have"),
        (covering("", "aaa", "!"), "too weak"),
        (covering("", ""), "box 1"),
    ):
        path.write_text(text, encoding="ascii")
        refused(folder, reason)
    path.write_bytes(LINK.encode() + b"\xff")
    refused(folder, "is not ASCII")
    path.unlink()
    refused(folder, "the evidence proofs/0002.boxes is missing")


def test_another_true_covering_is_as_good(folder):
    finer = covering("AAA", "aaaaaaa")
    (folder / "proofs" / "0002.boxes").write_text(finer, encoding="ascii")
    assert verify_directory(folder).outcome is Outcome.VALID


FALSE = {
    "no evidence": (structure(2, boxes=None), "structure 2 has no evidence"),
    "that of another robot": (structure(2, boxes="proofs/0000.boxes"), "does not refute"),
    "elsewhere": (structure(0, boxes="../../etc/passwd"), "is missing"),
    "another than that of the same robot": (
        structure(1, boxes="proofs/0002.boxes"),
        "structure 1 does not name the evidence of structure 0",
    ),
    "none, unlike the same robot": (structure(3, boxes=None), "does not name the evidence"),
    "a script that is none": (
        structure(2, evidence="proofs/0002.boxes"),
        "is not the script of structure 2",
    ),
    "a structure left out": (lambda c: c["structures"].pop(4), "structure 4 is not"),
    "the last left out": (lambda c: c["structures"].pop(), "structure 5 is missing"),
    "the same as a different one": (structure(2, same_robot_as=0), "is not the same robot"),
    "another bound": (lambda c: c.update(modules=5), "bound on modules"),
}


@pytest.mark.parametrize("name", FALSE)
def test_a_false_claim_with_its_own_digest(folder, name):
    change, reason = FALSE[name]
    alter(folder, change, sign=False)
    refused(folder, "altered")
    alter(folder, lambda _content: None, sign=True)
    refused(folder, reason)


@pytest.mark.parametrize(
    "change",
    [
        lambda c: c["structures"][0].update(boxes=3),
        lambda c: c["structures"][0].pop("boxes"),
        lambda c: c["structures"][0].update(cover=None),
    ],
)
def test_a_malformed_claim(folder, change):
    alter(folder, change, sign=True)
    refused(folder, "malformed")


def test_another_spec_is_not_covered(folder):
    # Within reach at 1.6 m and below for the longer links; the start as well.
    alter_spec(folder, "[0.5, 0.8] x", "[0.5, 1.9] x", sign=True)
    refused(folder, "0002.boxes does not refute structure 2")


def test_some_by_boxes_and_the_rest_by_scripts(folder, capsys):
    program = load(folder / "spec" / "robot.srg").program
    (task,) = program.tasks.values()
    family = family_of(program, task)
    labels = read(folder)["structures"][2]["derivation"]
    model = family.robot(family.replay(labels))
    script = next(refutation_scripts(model, program.workspaces[task.workspace], task))
    (folder / "proofs" / "0002.smt2").write_text(script, encoding="utf-8")
    alter(folder, structure(2, evidence="proofs/0002.smt2"), sign=True)
    assert verify_directory(folder).level == "validated"
    alter(folder, structure(2, boxes=None), sign=True)
    report = verify_directory(folder)
    assert (report.outcome, report.level) == (Outcome.UNCHECKED, None)
    scripts = "the scripts of 1 of 6 structures"
    assert report.reason == f"no solver has run on {scripts}; --trust z3 runs z3 on them"
    assert run(["verify", str(folder)]) == 4
    assert scripts in capsys.readouterr().out
    trusting = verify_directory(folder, trust="z3")
    assert (trusting.outcome, trusting.level) == (Outcome.VALID, "z3")
    assert trusting.reason == f"z3 answers unsat to {scripts}, boxes prove the others"


def test_the_design_has_to_agree_on_the_coverings(folder):
    certificate = read(folder)
    design = {
        **{key: certificate[key] for key in ("task", "spec", "spec_sha256")},
        "verdict": "impossible",
        "word": None,
        "derivation": None,
        "parameters": [],
        "path": [],
        "reconfiguration": None,
        "cells": cells_of(folder),
        "structures_tried": [
            {**s, "verdict": "refuted", "evidence": s["boxes"]} for s in certificate["structures"]
        ],
    }
    write(folder, design, "design.json")
    assert verify_directory(folder).outcome is Outcome.VALID
    design["structures_tried"][2]["boxes"] = None
    write(folder, design, "design.json")
    refused(folder, "differ in `structures_tried`")


def cells_of(folder):
    from compiler.workspaces.abstraction import abstract

    program = load(folder / "spec" / "robot.srg").program
    return abstract(program.workspaces["Table"]).describe()


KEPT = " fixed L.length = 1.3 m"


def test_a_fixed_parameter_has_one_value(tmp_path):
    # The kept link of 1.3 m gets into the start region, and not to the target at 1.6 m.
    text = replaced(BEYOND_REACH, "[0.5, 0.8] x [-0.2, 0.2]", "[1.2, 1.9] x [-0.3, 0.3]")
    line = f"  from B eps JO eps L eps EN{KEPT};\n  modules <= 4;"
    text = replaced(text, "  modules <= 4;", line)
    coverings = COVERINGS | {"B eps JO eps L eps EN": covering("", "aaaaaa")}
    folder = claim_impossible(tmp_path / "out", text, 4, coverings)
    assert verify_directory(folder).outcome is Outcome.VALID
    alter_spec(folder, KEPT, "", sign=True)
    refused(folder, "does not refute structure")
