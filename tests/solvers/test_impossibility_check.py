from __future__ import annotations

import pickle
import shutil

import pytest

from solvers.verdict import Reason, Unknown
from solvers.verifier.proofs.scene import Watch
from solvers.verifier.refutations import impossibility_check, structure_evidence
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.result_files import alter, alter_spec, read
from tests.oracles.small_specs import BEYOND_REACH, SLIDER, replaced


def test_impossible_up_to_the_bound(made):
    place = made("beyond_reach")
    assert (place / "status").read_text() == "3"
    design = read(place / "out", "design.json")
    assert design["verdict"] == "impossible"
    assert "at most 4 modules" in design["reason"]
    assert design["word"] is None
    # B JO and one or two of JO, L, EN, with an EN among them.
    words = [" ".join(s["word"]) for s in design["structures_tried"]]
    assert words == [
        "B eps JO eps EN",
        "B eps JO eps JO eps EN",
        "B eps JO eps L eps EN",
        "B eps JO eps EN eps JO",
        "B eps JO eps EN eps L",
        "B eps JO eps EN eps EN",
    ]
    assert all(s["verdict"] == "refuted" for s in design["structures_tried"])
    names = sorted(p.name for p in (place / "out").iterdir())
    assert names == ["certificate.json", "design.json", "log.json", "proofs", "spec"]
    certificate = read(place / "out")
    assert (certificate["kind"], certificate["modules"]) == ("impossible", 4)


def without_boxes(folder):
    """The same claim by scripts alone."""
    alter(folder, lambda c: [s.update(boxes=None) for s in c["structures"]], sign=True)
    design = read(folder, "design.json")
    for tried in design["structures_tried"]:
        tried["boxes"] = None
    result_files.write(folder, design, "design.json")


def test_boxes_need_no_solver(srgc_run, made):
    status, out = srgc_run("verify", made("beyond_reach") / "out")
    assert (status, out.splitlines()[:2]) == (
        0, ["valid: impossible, level validated", "task: Turn"],
    )  # fmt: skip


def test_scripts_are_not_checked_until_z3_runs_on_them(srgc_run, result):
    folder = result("beyond_reach")
    without_boxes(folder)
    status, out = srgc_run("verify", folder)
    assert status == 4
    assert out.startswith("not checked: impossible: no solver has run on the scripts of 6 of 6 ")
    assert "valid" not in out
    status, out = srgc_run("verify", folder, "--trust", "z3")
    assert status == 0
    assert out.startswith("valid: impossible, level z3")


def test_what_z3_does_not_decide_is_neither_valid_nor_refuted(srgc_run, result, monkeypatch):
    folder = result("beyond_reach")
    without_boxes(folder)
    unanswered = Unknown(Reason.RESOURCE_LIMIT, "z3 answers unknown")
    monkeypatch.setattr(structure_evidence, "agreed", lambda *_arguments: unanswered)
    status, out = srgc_run("verify", folder, "--trust", "z3")
    assert status == 4
    assert out.startswith("undecided: the script of structure 0 is not decided: z3 answers unknown")


def eagerly(function, jobs):
    """As processes do it: jobs are drawn long before their results are asked for, and pickled."""
    return (pickle.loads(job)[0](pickle.loads(job)[1]) for job in
            [pickle.dumps((function, job)) for job in jobs])  # fmt: skip


def spoilt(certificate):
    """Structure 4 is another one, and there is one too many; the third has lost its evidence."""
    structures = certificate["structures"]
    structures[4]["word"] = structures[5]["word"]
    structures[2].update(boxes=None, evidence=None)
    structures.append(structures[0])


def too_many(certificate):
    certificate["structures"].append(certificate["structures"][0])


def too_few(certificate):
    certificate["structures"].pop()


FAULTS = [
    (None, None),
    (spoilt, "structure 2 has no evidence"),
    (too_many, "the claim lists structures that the family does not have"),
    (too_few, "structure 5 is missing: B eps JO eps EN eps EN"),
]


@pytest.mark.parametrize(("change", "said"), FAULTS)
@pytest.mark.parametrize("at_once", [1, 2, 8])
def test_the_first_fault_is_named_however_many_are_checked_at_once(
    result, monkeypatch, change, said, at_once
):
    folder = result("beyond_reach")
    if change is not None:
        alter(folder, change, sign=True)
    monkeypatch.setattr(impossibility_check, "AT_ONCE", at_once)
    done: list[int] = []
    watch = Watch(part=lambda number, _count: done.append(number), each=eagerly)
    report = verify_directory(folder, watch=watch)
    assert report == verify_directory(folder)
    assert report.outcome is (Outcome.VALID if said is None else Outcome.REFUTED)
    assert said is None or said in str(report.reason)
    assert done == sorted(done)


def test_several_processes_give_the_same_report(srgc_run, made):
    folder = made("beyond_reach") / "out"
    assert srgc_run("verify", folder, "--jobs", "2") == srgc_run("verify", folder)


@pytest.mark.parametrize("field", ["evidence", "boxes"])
@pytest.mark.parametrize("name", ["proofs/\0", "\0", "proofs/" + "a" * 5000, "proofs", "", "loop"])
def test_evidence_of_any_name_is_refused(srgc_run, result, field, name):
    folder = result("beyond_reach")
    (folder / "loop").symlink_to("loop")

    def renamed(content):
        for each in content["structures"]:
            each["evidence"], each["boxes"] = None, None
            each[field] = name

    alter(folder, renamed, sign=True)
    status, out = srgc_run("verify", folder)
    assert status == 1
    assert out.startswith("refuted: the evidence ")
    assert out.count("\n") == 5  # the answer, the task, the spec and its digest, what to do


def test_sparse_files_are_not_read(srgc_run, result):
    """Of 4 GiB and more, which a disk holds in one block: told by their size."""
    for name, status, said in (
        ("proofs/0000.boxes", 1, "more than 268,435,456"),
        ("spec/beyond_reach.srg", 1, "more than 75,497,472"),
        ("spec/more.srg", 1, "more than 75,497,472"),
        ("certificate.json", 4, "more than 268,435,456"),
        ("design.json", 4, "more than 268,435,456"),
    ):
        folder = result("beyond_reach")
        with (folder / name).open("ab") as file:
            file.truncate(5 * 2**30)
        found, out = srgc_run("verify", folder)
        assert (found, said in out) == (status, True), (name, out)
        shutil.rmtree(folder)
    folder = result("beyond_reach")
    other = folder / "other.srg"
    with other.open("wb") as file:
        file.truncate(5 * 2**30)
    status, out = srgc_run("verify", folder, "--spec", str(other))
    assert (status, "the files differ" in out) == (1, True)


@pytest.fixture
def srgc_run(capsys):
    from srgc.cli import run

    def call(*arguments):
        status = run([str(argument) for argument in arguments])
        return status, capsys.readouterr().out

    return call


def structure(number, **changes):
    return lambda content: content["structures"][number].update(changes)


FALSE = {
    "a structure left out": (lambda c: c["structures"].pop(2), "structure 2 is not"),
    "the last left out": (lambda c: c["structures"].pop(), "structure 5 is missing"),
    "one too many": (lambda c: c["structures"].append(c["structures"][0]), "does not have"),
    "another word": (structure(1, word=["B"]), "structure 1 is not"),
    "another derivation": (structure(1, derivation=["tool", "base"]), "structure 1 is not"),
    "another bound": (lambda c: c.update(modules=5), "bound on modules"),
    "no bound": (lambda c: c.update(modules=None), "bound on modules"),
    "no evidence": (structure(0, evidence=None, boxes=None), "no evidence"),
    "evidence of another": (structure(2, evidence="proofs/0000.smt2"), "is not the script"),
    "evidence elsewhere": (structure(0, evidence="../../etc/passwd"), "is missing"),
    "evidence nowhere": (structure(0, evidence="proofs/9.smt2"), "is missing"),
    "a different robot as the same": (structure(2, same_robot_as=0), "is not the same robot"),
    "the same as itself": (structure(2, same_robot_as=2), "is not the same robot"),
    "the same as a later one": (structure(1, same_robot_as=3), "is not the same robot"),
    "the same as none": (structure(1, same_robot_as=-1), "is not the same robot"),
}


@pytest.mark.parametrize("name", FALSE)
def test_a_false_claim(result, name):
    change, reason = FALSE[name]
    folder = result("beyond_reach")
    alter(folder, change, sign=False)
    assert "altered" in str(verify_directory(folder).reason)
    alter(folder, lambda _content: None, sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert reason in str(report.reason)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text + "\n",
        lambda text: text.replace("(check-sat)", "(assert false)\n(check-sat)"),
        lambda text: "(check-sat)",
        lambda text: None,
    ],
)
def test_an_altered_or_missing_script(result, change):
    folder = result("beyond_reach")
    path = folder / "proofs" / "0000.smt2"
    text = change(path.read_text(encoding="utf-8"))
    if text is None:
        path.unlink()
    else:
        path.write_text(text, encoding="utf-8")
    for trust in (None, "z3"):
        report = verify_directory(folder, trust=trust)
        assert report.outcome is Outcome.REFUTED
        assert "proofs/0000.smt2" in str(report.reason)


def test_another_spec_needs_other_scripts(result):
    folder = result("beyond_reach")
    alter_spec(folder, "[1.6, 1.9] m;", "[0.5, 0.8] m;", sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "is not the script" in str(report.reason)


def test_more_modules_are_more_structures(result):
    folder = result("beyond_reach")
    alter_spec(folder, "modules <= 4;", "modules <= 5;", sign=True)
    alter(folder, lambda c: c.update(modules=5), sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "structure 6 is missing" in str(report.reason)


def test_without_a_bound_an_infinite_family_is_refused(result):
    folder = result("beyond_reach")
    alter_spec(folder, "  modules <= 4;\n", "", sign=True)
    alter(folder, lambda c: c.update(modules=None), sign=True)
    assert "infinite" in str(verify_directory(folder).reason)


def test_a_grammar_that_derives_itself_is_refused(result):
    folder = result("beyond_reach")
    alter_spec(folder, "  base:  N -> B;", "  base:  N -> B; again: N -> N;", sign=False)
    alter_spec(folder, "  base  {", "  again { this.frame = N.frame; } base  {", sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "derives itself" in str(report.reason)


def test_a_design_that_says_something_else(result):
    folder = result("beyond_reach")
    design = read(folder, "design.json")
    for change in (
        {"verdict": "found"},
        {"word": ["B"]},
        {"structures_tried": design["structures_tried"][:-1]},
        {"structures_tried": [s | {"verdict": "found"} for s in design["structures_tried"]]},
        {"structures_tried": None},
    ):
        result_files.write(folder, design | change, "design.json")
        report = verify_directory(folder)
        assert report.outcome is Outcome.REFUTED
        assert f"differ in `{next(iter(change))}`" in str(report.reason)


@pytest.mark.parametrize("accept", ["matches B eps EN", "matches B eps EN eps EN | B eps EN"])
def test_a_finite_family_needs_no_bound(srgc_run, tmp_path, accept):
    path = tmp_path / "finite.srg"
    path.write_text(replaced(SLIDER, "matches B eps P eps M eps EN", accept), encoding="utf-8")
    status, _ = srgc_run("synth", path, "-o", tmp_path / "out", "--no-lemmas")
    assert status == 3
    assert read(tmp_path / "out")["modules"] is None
    assert srgc_run("verify", tmp_path / "out")[0] == 0
    without_boxes(tmp_path / "out")
    assert srgc_run("verify", tmp_path / "out")[0] == 4
    assert srgc_run("verify", tmp_path / "out", "--trust", "z3")[0] == 0


def test_the_scripts_do_not_depend_on_the_bound(made):
    """A found robot's earlier structures have the same scripts as an impossible claim's."""
    assert "modules <= 4" in BEYOND_REACH
    scripts = sorted((made("beyond_reach") / "out" / "proofs").glob("*.smt2"))
    assert len(scripts) == 4
    assert all(script.read_text().startswith(";") for script in scripts)
