"""Sizes and names of files, the types of the Python interface, and what a command may load."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from tests.oracles.loaded_modules import loaded_after

ROOT = Path(__file__).parents[1]
PACKAGES = ["grammar_lang", "compiler", "solvers", "srgc"]
SOLVERS = {"pysat", "z3", "cvxpy", "clarabel", "piqp", "sklearn", "pysmt", "scipy", "mosek", "cvc5"}
HEAVY = SOLVERS | {"casadi", "dask", "distributed"}


@pytest.mark.types
def test_a_strictly_typed_program_is_accepted(tmp_path):
    """But for the lines that mistake a type and a name, so that they are known at all."""
    sample = tmp_path / "sample.py"
    sample.write_text(
        "import srgc\n"
        "program = srgc.load('arm.srg')\n"
        "words: list[str] = srgc.words(program, limit=3)\n"
        "result = srgc.synthesize(program, seed=1)\n"
        "if result.verdict == 'found' and result.word is not None:\n"
        "    robot = srgc.robot(program, result.word, result.parameters)\n"
        "    total: float = robot.mass_matrix([0.1, 0.2]).sum()\n"
        "    urdf: str = srgc.export(result, 'urdf')\n"
        "    left: float = min(srgc.verify(result).margins.values())\n"
        "costs: list[float] = [\n"
        "    step.cost for step in srgc.synthesize(program, mission='Day').steps if step\n"
        "]\n"
        "try:\n    srgc.check(text='module')\n"
        "except srgc.SrgcError as error:\n    print(str(error).upper())\n"
        "wrong: int = srgc.words(program)\n"
        "srgc.synthesise(program)\n",
        encoding="utf-8",
    )
    found = subprocess.run(
        [
            Path(sys.executable).parent / "mypy",
            *["--strict", "--python-executable", sys.executable, sample],
        ],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    # What mypy remembers of an earlier run has the folder of that run in it.
    told, named = [line for line in found.stdout.splitlines() if "sample.py:" in line]
    assert "sample.py:17: error: Incompatible types in assignment" in told
    assert '"list[str]", variable has type "int"' in told
    assert 'Module has no attribute "synthesise"' in named


def test_no_file_is_over_four_hundred_lines():
    lengths = {
        str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines())
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
    }
    assert len(lengths) > 90
    assert {name: length for name, length in lengths.items() if length > 400} == {}


@pytest.mark.parametrize("package", PACKAGES)
def test_no_file_is_named_for_nothing(package):
    names = {path.stem for path in (ROOT / package).rglob("*.py")}
    assert not names & {"utils", "util", "helpers", "helper", "common", "base", "misc"}


CHECKER = {"solvers", "solvers.verdict", "solvers.verifier"}
"""The modules of ``solvers`` that a verification may load, with all that is below the verifier."""
LIBRARIES = {"casadi", "numpy", "python-flint"}
"""The libraries that it may load: expression graphs, arrays and ball arithmetic."""


def not_allowed(loaded: set[str]) -> list[str]:
    """What a verification has loaded beside itself, ``compiler``, ``grammar_lang`` and these."""
    providers = packages_distributions()
    modules = {
        name
        for name in loaded
        if name.startswith("solvers") and not name.startswith("solvers.verifier.")
    }
    packages = {name.partition(".")[0] for name in loaded - loaded_after("")}
    libraries = {library for name in packages for library in providers.get(name, ())}
    return [
        *sorted(
            modules - CHECKER - {one for one in modules if one.startswith("solvers.verifier.")}
        ),
        *sorted(libraries - LIBRARIES - {"srgc"}),
    ]


def test_what_is_not_allowed():
    loaded = {"solvers", "solvers.verifier", "solvers.verifier.report", "solvers.verifiers"}
    assert not_allowed(
        {*loaded, "solvers.search.synthesis", "srgc", "json", "flint", "z3.z3core"}
    ) == [
        "solvers.search.synthesis",
        "solvers.verifiers",
        "z3-solver",
    ]


@pytest.mark.parametrize("spec", ["slider", "beyond_reach"])
def test_the_verifier_loads_itself_alone(made, spec):
    folder = made(spec) / "out"
    loaded = loaded_after(
        "from pathlib import Path\n"
        "from solvers.verifier.verification import verify_directory\n"
        f"report = verify_directory(Path({str(folder)!r}), trust='z3')\n"
        "assert report.outcome.value == 'valid', report"
    )
    assert "solvers.verifier.report" in loaded
    assert not not_allowed(loaded)
    assert "srgc" not in loaded


def test_the_verify_command_loads_no_searcher(made):
    loaded = loaded_after(
        f"from srgc.cli import run\nassert run(['verify', {str(made('slider') / 'out')!r}]) == 0"
    )
    assert set(not_allowed(loaded)) <= {"click", "colorama", "filelock", "rich"}


@pytest.mark.parametrize(
    "arguments",
    [["check"], ["words"], ["accepts"], ["graph", "--of", "sra"], ["graph", "--of", "workspace"]],
    ids=" ".join,
)
def test_light_commands_load_nothing_heavy(arguments):
    loaded = loaded_after(
        f"from srgc.cli import run\nrun([*{arguments!r}, 'specs/planar_arm.srg'])"
    )
    assert not {name.partition(".")[0] for name in loaded} & HEAVY
    assert not {name for name in loaded if name.startswith("solvers.")}


def test_the_space_of_parameters_needs_no_equations_of_motion():
    loaded = loaded_after("from solvers.parameters.parameter_search import Halton, ParameterSpace")
    assert not {name.partition(".")[0] for name in loaded} & HEAVY
    assert not {name for name in loaded if name.startswith(("compiler.disc", "solvers.trajectory"))}


def test_the_public_surface_is_small():
    names = subprocess.run(
        [sys.executable, "-c", "import srgc; print(*(n for n in dir(srgc) if n[0] != '_'))"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    ).stdout.split()  # fmt: skip
    assert len(names) <= 18


def test_every_module_says_what_it_is():
    for package in PACKAGES:
        for path in (ROOT / package).rglob("*.py"):
            assert path.read_text(encoding="utf-8").lstrip().startswith(('"""', 'r"""')), path


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("words/grammar.py", "structural reconfiguration grammar"),
        ("words/pushdown_automaton.py", "structural reconfiguration automaton"),
        ("words/functional_automaton.py", "functional reconfiguration automaton"),
    ],
)
def test_the_objects_have_the_names_of_the_paper(file, name):
    """Section 2 of the paper spells out SRG, SRA and FRA."""
    text = (ROOT / "compiler" / file).read_text(encoding="utf-8")
    assert text.startswith(f'"""The {name} ')
