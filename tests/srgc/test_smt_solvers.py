"""``synth --smt`` and ``verify --trust``: solvers by name, that agree, and that do not."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from srgc.cli import run
from tests.oracles.result_files import alter
from tests.oracles.small_specs import BEYOND_REACH, TURNER
from tests.srgc.conftest import Ran

Srgc = Callable[..., Ran]


def solver(folder: Path, name: str, program: str) -> Path:
    path = folder / name
    path.write_text(f"#!{sys.executable}\nimport sys, time\nsys.stdin.read()\n{program}\n")
    path.chmod(0o755)
    return path


@pytest.fixture
def disagreeing(capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Run a command that ends with status 70; what it prints."""

    def call(*arguments: object) -> str:
        capsys.readouterr()
        assert run([str(argument) for argument in arguments]) == 70
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        return printed.out + printed.err

    return call


def scripts_alone(folder: Path) -> None:
    alter(folder, lambda c: [s.update(boxes=None) for s in c["structures"]], sign=True)
    (folder / "design.json").unlink()


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    path = tmp_path / "far.srg"
    path.write_text(BEYOND_REACH, encoding="utf-8")
    return path


@pytest.fixture
def unchecked(result: Callable[[str], Path], tmp_path: Path) -> Path:
    folder = result("beyond_reach")
    scripts_alone(folder)
    return folder


def test_another_solver_refutes_as_well(srgc: Srgc, spec: Path, tmp_path: Path) -> None:
    ran = srgc("synth", spec, "-o", tmp_path / "out", "--smt", "cvc5", "--no-lemmas")
    assert ran.status == 3
    assert json.loads((tmp_path / "out" / "design.json").read_text())["smt"] == "cvc5"
    scripts_alone(tmp_path / "out")
    for names in ("z3", "cvc5", "z3,cvc5"):
        ran = srgc("verify", tmp_path / "out", "--trust", names)
        assert ran.status == 0
        level = names.replace(",", " and ")
        assert ran.out.startswith(f"valid: impossible, level {level}\n")


@pytest.mark.parametrize(
    ("arguments", "place"), [(["synth", "far.srg"], "--smt"), (["verify", "out"], "--trust")]
)
def test_a_solver_that_is_not_here(
    srgc: Srgc, spec: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    arguments: list[str], place: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir(exist_ok=True)
    ran = srgc(*arguments, place, "nix")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == "error: there is no SMT solver `nix`; here are `cvc5`, `z3`\n"


def test_solvers_that_disagree(
    srgc: Srgc, disagreeing: Callable[..., str], spec: Path, tmp_path: Path, unchecked: Path
) -> None:
    liar = solver(tmp_path, "liar", "print('sat')")
    out = tmp_path / "out"
    said = disagreeing("synth", spec, "-o", out, "--smt", f"z3,{liar}", "--no-lemmas")
    assert f"z3 says unsat, {liar} says sat" in said
    kept = json.loads((out / "proofs" / "disagreement.json").read_text())
    assert kept == {"answers": {"z3": "unsat", str(liar): "sat"}}
    assert "(check-sat)" in (out / "proofs" / "disagreement.smt2").read_text()
    assert not (out / "certificate.json").exists()
    said = disagreeing("verify", unchecked, "--trust", f"z3,{liar}")
    assert said.startswith("disagreement: ")
    assert f"proofs/0000.smt2: z3 says unsat, {liar} says sat" in said
    # Alone it is believed, and then the claim is refuted.
    assert srgc("verify", unchecked, "--trust", liar).status == 1


def test_a_liar_of_the_same_name(
    disagreeing: Callable[..., str], tmp_path: Path, unchecked: Path
) -> None:
    (tmp_path / "other").mkdir()
    liar = solver(tmp_path / "other", "z3", "print('sat')")
    for names in (f"z3,{liar}", f"{liar},z3"):
        said = disagreeing("verify", unchecked, "--trust", names)
        assert "z3 says unsat" in said
        assert f"{liar} says sat" in said


def test_a_solver_that_fails_is_named_also_where_coverings_decide(
    srgc: Srgc, spec: Path, tmp_path: Path
) -> None:
    bad = solver(tmp_path, "bad", "sys.exit(3)")
    ran = srgc("synth", spec, "-o", tmp_path / "out", "--smt", bad, "--no-lemmas")
    assert f"{bad} ended with status 3" in ran.err


@pytest.mark.parametrize("names", ["z3,", ",", ""])
def test_an_empty_name(srgc: Srgc, unchecked: Path, names: str) -> None:
    ran = srgc("verify", unchecked, "--trust", names)
    assert (ran.status, ran.out) == (2, "")
    assert "is empty" in ran.err


def test_a_file_that_is_no_command(srgc: Srgc, spec: Path, tmp_path: Path) -> None:
    plain = tmp_path / "plain"
    plain.write_text("unsat")
    ran = srgc("synth", spec, "-o", tmp_path / "out", "--smt", plain)
    assert (ran.status, ran.out) == (2, "")
    assert "is not executable" in ran.err


def test_a_lie_that_the_library_sees(
    disagreeing: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A robot is not refuted because one program says so: here poses are not even looked for."""
    from solvers.impossibility import structure_refutation

    monkeypatch.setattr(structure_refutation, "find_poses", lambda *_: None)
    liar = solver(tmp_path, "liar", "print('unsat')")
    (tmp_path / "turn.srg").write_text(TURNER, encoding="utf-8")
    said = disagreeing("synth", tmp_path / "turn.srg", "-o", tmp_path / "out", "--smt", liar)
    assert f"{liar} says unsat, z3 as a library says sat" in said


@pytest.mark.parametrize(
    ("program", "said"),
    [
        ("sys.exit(3)", "ended with status 3"),
        ("print('unknown')", "answers unknown"),
        ("print('perhaps')", "prints what is no answer: perhaps"),
        ("print('\\x1b[31mred\\a')", "prints what is no answer: \ufffd[31mred\ufffd"),
    ],
)
def test_a_solver_without_an_answer(
    srgc: Srgc, unchecked: Path, tmp_path: Path, program: str, said: str
) -> None:
    bad = solver(tmp_path, "bad", program)
    ran = srgc("verify", unchecked, "--trust", bad)
    assert ran.status == 4
    assert ran.out.startswith(f"undecided: the script of structure 0 is not decided: {bad} {said}")
