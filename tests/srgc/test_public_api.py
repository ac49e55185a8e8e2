"""``import srgc``: the names, what they give, and that a fault is one message."""

from __future__ import annotations

import ast
import gc
import inspect
import json
import os
import pickle
import re
import shutil
import subprocess
import sys
import tomllib
import traceback
from importlib import import_module
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import srgc
from grammar_lang.diagnostics.diagnostic import Code
from srgc.api.export import Binary, Form, Text
from srgc.exports import design_export
from srgc.faults import WITH_O, UsageFault, argument
from tests.oracles.small_specs import TURNER, replaced

ROOT = Path(__file__).parents[2]
WORD = "B eps JO eps L eps JO eps L eps EN"
FALLING = replaced(TURNER, "  reach T;", "  reach T;\n  gravity (0, -9.81) m/s^2;")


def fresh(program: str) -> str:
    """What a program prints in an interpreter of its own."""
    finished = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT, capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    return finished.stdout


@pytest.fixture(scope="module")
def program():
    return srgc.load(ROOT / "specs" / "planar_arm.srg")


@pytest.fixture
def turned(made):
    return srgc.open_result(made("turner") / "out")


# --- the names ----------------------------------------------------------------------------------


def test_importing_loads_nothing():
    before_and_after = (
        "import sys; before = set(sys.modules)\nimport srgc\n"
        "print(*sorted(set(sys.modules) - before))"
    )
    assert fresh(before_and_after).split() == ["srgc"]


def test_light_calls_load_no_library():
    loaded = fresh(
        "import sys, srgc\np = srgc.load('specs/planar_arm.srg'); srgc.words(p, limit=5)\n"
        "srgc.check(text='module'); print(*sys.modules)"
    ).split()
    assert not {"numpy", "casadi", "flint", "scipy", "click"} & set(loaded)


def test_every_name_has_one_home_and_is_known_to_type_checkers():
    tree = ast.parse((ROOT / "srgc" / "__init__.py").read_text(encoding="utf-8"))
    [guarded] = [
        node for node in tree.body if isinstance(node, ast.If) and isinstance(node.test, ast.Name)
    ]
    static = {
        alias.name: node.module
        for node in guarded.body
        for alias in node.names
        if alias.asname == alias.name
    }
    assert static == srgc._HOMES
    assert sorted(static) == srgc.__all__ == dir(srgc)
    assert len(static) <= 18
    for name, home in static.items():
        thing = getattr(srgc, name)
        assert getattr(import_module(home), name) is thing
        assert (thing.__module__, thing.__name__) == (home, name)
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert srgc.__version__ == declared["project"]["version"]
    with pytest.raises(AttributeError, match="has no attribute 'synthesise'"):
        srgc.synthesise  # noqa: B018


@pytest.mark.parametrize("name", [name for name in srgc.__all__ if name != "SrgcError"])
def test_functions_say_what_they_take(name):
    function = getattr(srgc, name)
    text = inspect.getdoc(function)
    assert "Raises:\n    SrgcError: " in text
    for parameter in inspect.signature(function).parameters.values():
        assert parameter.annotation is not inspect.Parameter.empty
        assert name == "open_result" or f"    {parameter.name}: " in text, parameter.name
    assert inspect.signature(function).return_annotation is not inspect.Signature.empty


def test_every_name_is_in_the_reference():
    page = (ROOT / "docs" / "reference" / "python.md").read_text(encoding="utf-8")
    assert sorted(
        re.findall(r"\.\. auto(?:class|function|exception):: (\w+)$", page, re.MULTILINE)
    ) == (srgc.__all__)


@pytest.mark.parametrize("package", ["srgc", "solvers", "compiler", "grammar_lang"])
def test_types_are_shipped(package):
    """Of all packages: what srgc gives has types of the others, as ``Verification.outcome``."""
    assert (ROOT / package / "py.typed").is_file()


# --- specifications -----------------------------------------------------------------------------


def test_findings(tmp_path):
    found = srgc.check(text="module B { role base; } edge eps")
    assert not found.ok
    assert [one.code.value for one in found.errors] == ["SRG0104"]
    [record] = found.records()
    assert (record["line"], record["column"]) == (1, 33)
    assert "\n      |                                 ^\n" in str(found)
    assert len(found) == 1
    fine = srgc.check(ROOT / "specs" / "planar_arm.srg")
    assert fine.ok
    assert not fine.errors


def test_a_text_includes_what_is_in_its_folder(tmp_path):
    modules, rest = TURNER.split("edge eps;")
    (tmp_path / "modules.srg").write_text(modules, encoding="utf-8")
    text = f'include "modules.srg";\nedge eps;{rest}'
    assert srgc.load(text=text, folder=tmp_path).modules == ("B", "JO", "L", "EN")
    with pytest.raises(srgc.SrgcError, match="include"):
        srgc.load(text=text)


def test_a_path_does_where_a_program_does(program):
    path = ROOT / "specs" / "planar_arm.srg"
    for given in (path, str(path), os.fspath(path)):
        assert srgc.words(given, limit=3) == srgc.words(program, limit=3)
    assert srgc.plan(path).paths == srgc.plan(program).paths
    assert repr(srgc.graph(path, "sra")) == repr(srgc.graph(program, "sra"))
    assert srgc.robot(str(path), WORD).parameters == srgc.robot(program, WORD).parameters


def test_a_program(program):
    assert (program.name, program.grammars, program.tasks) == (
        "planar_arm.srg", ("PlanarArm",), ("PickAndPlace",),
    )  # fmt: skip
    assert program.workspaces == ("Bench",)
    assert program.text == (ROOT / "specs" / "planar_arm.srg").read_text(encoding="utf-8")
    shortest = "B eps JO eps EN"
    longer = {f"B eps JO eps {last}" for last in (
        "JO eps EN", "L eps EN", "EN eps JO", "EN eps L", "EN eps EN",
    )}  # fmt: skip
    found = srgc.words(program, max_length=7)
    assert (found[0], set(found[1:]), len(found)) == (shortest, longer, 6)
    assert srgc.words(program, limit=2) == found[:2]
    assert srgc.plan(program).paths == {1: ("S", "free.5", "free.8", "T")}


# --- faults -------------------------------------------------------------------------------------


def test_errors_read_well():
    with pytest.raises(srgc.SrgcError) as caught:
        srgc.load(text=replaced(TURNER, "bounds box [-1, 3] x [-1, 3] m", "bounds box [-1, 3] kg"))
    lines = str(caught.value).splitlines()
    assert lines[0] == "the spec has errors"
    assert lines[1].startswith("spec.srg:26:")
    assert lines[2] == "   26 |   bounds box [-1, 3] kg;"
    assert "^" in lines[3]


def test_a_traceback_ends_at_the_call(program):
    with pytest.raises(srgc.SrgcError) as caught:
        srgc.robot(program, "B eps EN")
    frames = traceback.extract_tb(caught.value.__traceback__)
    assert [Path(frame.filename).name for frame in frames] == [
        "test_public_api.py", "spoken_faults.py",
    ]  # fmt: skip
    assert caught.value.__cause__ is None
    assert caught.value.__suppress_context__


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda p: srgc.graph(p, "robot"), "`of` robot needs the word: `word`"),
        (lambda p: srgc.graph(p, "fsa"), "no view `fsa`"),
        (lambda p: srgc.load("nowhere.srg"), "cannot read"),
        (lambda p: srgc.load(), "give the path"),
        (lambda p: srgc.load("a.srg", text=""), "give the path"),
        (lambda p: srgc.words(p, grammar="G"), "no grammar `G`; the file has: PlanarArm"),
        (lambda p: srgc.words(p, limit=-1), "not negative"),
        (lambda p: srgc.robot(p, WORD, [1]), "1 parameters: the robot has 4.length, 8.length"),
        (lambda p: srgc.robot(p, WORD, {"5.length": 1}), "no parameter `5.length`"),
        (lambda p: srgc.robot(p, WORD, [1, 7]), r"8.length = 7 is not in \[0.5, 5\] m"),
        (lambda p: srgc.robot(p, WORD, [1, np.nan]), "8.length is nan"),
        (lambda p: srgc.robot(p, WORD, [1, "1"]), "8.length is '1': a finite number is expected"),
        (lambda p: srgc.robot(p, WORD, 3), "`parameters` is numbers by their names"),
        (lambda p: srgc.robot(p, WORD, derivation=0), "counts from 1"),
        (lambda p: srgc.robot(p, WORD).mass_matrix("ab"), "`q` is not an array of numbers"),
        (lambda p: srgc.robot(p, WORD).mass_matrix([0, 10**400]), "`q` is not an array of numbers"),
        (lambda p: srgc.robot(p, WORD).coriolis([[1, 2]] * 2, [[1, 2]] * 3), "2 poses, and `qd` 3"),
        (lambda p: srgc.robot(p, WORD).svg([0, np.nan]), "2 finite numbers"),
        (lambda p: srgc.robot(p, WORD).svg([[0, 0]]), "2 finite numbers"),
        (lambda _: srgc.words("arm.srg"), "cannot read"),
        (lambda _: srgc.synthesize(None), "`program` is what `srgc.load` gives, a .* not None"),
        (srgc.load, "`path` is a path, or a specification that was built, not <Program"),
        (lambda _: srgc.load(b"arm.srg"), "`path` is a path, .*, not b'arm.srg'"),
        (lambda _: srgc.load("module B {"), r"`path` is a path: `srgc.load\(text=...\)` reads"),
        (lambda _: srgc.plan("edge a;\nedge b;"), "`program` is a path: "),
        (lambda _: srgc.load("a.srg", folder="b"), "`folder` goes with `text`"),
        (lambda _: srgc.check(text=3), "`text` is a text, not 3"),
        (lambda _: srgc.open_result(7), "`folder` is a path, not 7"),
        (lambda p: srgc.words(p, limit=2.5), "`limit` is a whole number, not 2.5"),
        (lambda p: srgc.words(p, max_length="9"), "`max_length` is a whole number, not '9'"),
        (lambda p: srgc.words(p, grammar=1), "`grammar` is a text, not 1"),
        (lambda p: srgc.graph(p, "sra", highlight=3), "`highlight` is a text, or several, not 3"),
        (lambda p: srgc.graph(p, "workspace", cells=0), "counts from 1"),
        (lambda p: srgc.synthesize(p, time_limit="1"), "`time_limit` is a number, not '1'"),
        (lambda p: srgc.synthesize(p, jobs="2" * 99), r"whole number, not '2{56}\.\.\."),
        (lambda _: srgc.export("nowhere", "csv", efforts=False), "goes with ros2 alone"),
        (lambda p: srgc.robot(p, WORD).mass_matrix([1]), r"`q` has the shape \(1,\): \(2,\)"),
        (lambda p: srgc.synthesize(p, jobs=0), "count from 1"),
        (lambda p: srgc.synthesize(p, seed=-1), "not negative"),
        (lambda p: srgc.synthesize(p, time_limit=0), "positive number of seconds"),
        (lambda p: srgc.plan(p, cells=0), "counts from 1"),
        (lambda p: srgc.open_result("nowhere"), "not a folder"),
        (lambda p: srgc.verify("nowhere"), "not a folder"),
        (lambda p: srgc.why("nowhere"), "not a folder"),
        (lambda p: srgc.export("nowhere", "urdf"), "not a folder"),
        (lambda p: srgc.export("nowhere", "step"), "no format `step`"),
        (lambda p: srgc.export("nowhere", "all"), "give its `path`"),
    ],
)  # fmt: skip
def test_faults_are_one_message(program, call, said):
    with pytest.raises(srgc.SrgcError, match=said) as caught:
        call(program)
    assert "--" not in str(caught.value)


def test_options_are_called_as_arguments_are():
    fault = UsageFault("give ", argument("max_length"), " to count it")
    assert (str(fault), fault.in_python()) == (
        "give --max-length to count it", "give `max_length` to count it",
    )  # fmt: skip
    fault = UsageFault("a -- b, `x--y` {}; choose another place", WITH_O)
    assert fault.in_python() == "a -- b, `x--y` {}; choose another place"
    assert str(pickle.loads(pickle.dumps(fault))) == f"{fault.in_python()} with -o"
    assert fault.code is None


def test_a_fault_keeps_its_code_and_its_hint():
    fault = UsageFault("a", argument("b"), code=Code.NO_ROBOT, hint="c")
    assert (str(fault), fault.in_python()) == ("a--b\n  hint: c", "a`b`")
    again = pickle.loads(pickle.dumps(fault))
    assert (str(again), again.code) == (str(fault), Code.NO_ROBOT)


# --- robots -------------------------------------------------------------------------------------


def test_a_robot_is_that_of_the_textbook(program):
    """Two uniform rods of 1 kg/m; the numbers are those of the formulas of two links."""
    arm = srgc.robot(program, WORD, [1, 0.5])
    assert arm.parameters == {"4.length": 1.0, "8.length": 0.5}
    q, qd = np.array([0.3, 0.4]), np.array([1.5, -0.7])
    np.testing.assert_allclose(
        arm.mass_matrix(q), [[1.1052652485, 0.1567992909], [0.1567992909, 0.0416666667]], atol=1e-9
    )
    h = 1 * 0.5**2 / 2 * np.sin(0.4)
    expected = [-h * (2 * 1.5 * -0.7 + 0.7**2), h * 1.5**2]
    np.testing.assert_allclose(arm.coriolis(q, qd), expected, rtol=1e-12)
    np.testing.assert_allclose(arm.gravity(q), [0, 0])
    tip = [np.cos(0.3) + 0.5 * np.cos(0.7), np.sin(0.3) + 0.5 * np.sin(0.7)]
    np.testing.assert_allclose(arm.effectors(q), [tip], rtol=1e-12)
    many = np.array([q, [0, 0], [1, 2]])
    assert arm.mass_matrix(many).shape == (3, 2, 2)
    assert arm.coriolis(many, many).shape == arm.gravity(many).shape == (3, 2)
    np.testing.assert_allclose(arm.effectors(many)[0], [tip], rtol=1e-12)
    assert "M22 = l2^3/3" in arm.equations()


def test_gravity_is_that_of_the_task():
    program = srgc.load(text=FALLING)
    rod = srgc.robot(program, "B eps JO eps L eps EN", [2], task="Turn")
    expected = 2 * 9.81 * 1 * np.cos([0, 0.7])
    np.testing.assert_allclose(rod.gravity([[0], [0.7]])[:, 0], expected, rtol=1e-12)
    still = srgc.robot(program, "B eps JO eps L eps EN", [2])
    np.testing.assert_allclose(still.gravity([0.7]), [0])


def test_parameters_left_out_are_in_the_middle(program):
    arm = srgc.robot(program, WORD, {"8.length": 1})
    assert arm.parameters == {"4.length": 2.75, "8.length": 1.0}


# --- results ------------------------------------------------------------------------------------


def files(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != "log.json"
    }


@pytest.mark.parametrize("spec", ["turner", "beyond_reach"])
def test_a_result_is_what_the_command_writes(made, tmp_path, spec):
    lemmas = spec != "beyond_reach"
    result = srgc.synthesize(srgc.load(made(spec) / f"{spec}.srg"), lemmas=lemmas)
    written = files(made(spec) / "out")
    assert files(result.folder) == written
    target = result.save(tmp_path / "kept")
    assert files(target) == written
    assert (target / "log.json").is_file()
    assert srgc.open_result(target).design == result.design
    result.save(target)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "diary").write_text("x", encoding="utf-8")
    with pytest.raises(srgc.SrgcError, match="is not empty"):
        result.save(tmp_path / "other")


def test_a_temporary_folder_lasts_as_long_as_its_result():
    result = srgc.synthesize(srgc.load(text=TURNER), time_limit=1e-9)
    folder = result.folder
    assert (result.verdict, folder.is_dir()) == ("unknown", True)
    del result
    gc.collect()
    assert not folder.exists()


def test_a_pickled_result_takes_its_files_along():
    """As one that another process sends, whose temporary folder ends with it."""
    result = srgc.synthesize(srgc.load(text=TURNER), time_limit=1e-9)
    content, expected = pickle.dumps(result), files(result.folder)
    del result
    gc.collect()
    sent = pickle.loads(content)
    assert files(sent.folder) == expected
    assert sent.verify().outcome.value == "undecided"
    folder = sent.folder
    del sent
    gc.collect()
    assert not folder.exists()


def test_a_result_in_a_folder_of_its_own_is_pickled_as_that(turned):
    assert pickle.loads(pickle.dumps(turned)) == turned
    assert pickle.loads(pickle.dumps(turned)).folder == turned.folder


def test_an_unfinished_search_goes_on_in_its_folder(tmp_path, made):
    program = srgc.load(made("turner") / "turner.srg")
    assert srgc.synthesize(program, folder=tmp_path, time_limit=1e-9).verdict == "unknown"
    assert srgc.synthesize(program, folder=tmp_path).verdict == "found"
    assert files(tmp_path) == files(made("turner") / "out")


def test_a_found_result(turned):
    design = json.loads((turned.folder / "design.json").read_text(encoding="utf-8"))
    assert (turned.verdict, turned.task, turned.reason) == ("found", "Turn", None)
    assert turned.word == "B eps JO eps L eps EN"
    [length] = turned.parameters.values()
    assert list(turned.parameters) == ["4.length"]
    assert turned.robustness == design["robustness"] == pytest.approx(10 - turned.effort_peak)
    motion = turned.trajectory
    assert motion.q.shape == motion.qd.shape == (11, 1)
    assert motion.u.shape == (10, 1)
    assert motion.effectors.shape == (11, 1, 2)
    angles = motion.q[:, 0]
    tips = length * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    np.testing.assert_allclose(motion.effectors[:, 0], tips, atol=1e-9)
    np.testing.assert_allclose(turned.robot.effectors(motion.q), motion.effectors, atol=1e-9)
    assert np.abs(motion.u).max() == pytest.approx(turned.effort_peak)
    assert turned.designs == ()
    with pytest.raises(srgc.SrgcError, match="nothing to explain"):
        srgc.why(turned)


def test_the_motion_is_that_of_the_certificate(result, turned):
    """The table beside it has no digest: whoever edits it changes no motion."""
    copy = srgc.open_result(result("turner"))
    (copy.folder / "trajectory.csv").write_text("t,q1\n0,1\n", encoding="utf-8")
    np.testing.assert_array_equal(copy.trajectory.q, turned.trajectory.q)


def test_the_verifier_is_asked_each_time(result):
    copy = srgc.open_result(result("turner"))
    answer = copy.verify()
    assert (answer.valid, answer.verdict, answer.level) == (True, "found", "validated")
    assert answer.margins["target T"] > 0
    (copy.folder / "certificate.json").write_text("{}", encoding="utf-8")
    again = srgc.verify(copy)
    assert (again.valid, again.outcome.value) == (False, "refuted")
    assert copy.verify().reason == again.reason


def test_all_designs(designs):
    result = srgc.open_result(designs)
    assert len(result.designs) == len(list((designs / "designs").iterdir())) > 1
    assert all(one.verdict == "found" and one.verify().valid for one in result.designs[:2])


def test_objectives(priced):
    """Of the cheapest slide and the next one; the value of a design alone is all that it claims."""
    result = srgc.open_result(priced)
    price, mass = result.objectives
    assert (price.objective, price.value, price.least, price.unit) == ("sum(price)", 10, 10, "")
    assert (mass.objective, mass.value, mass.least, mass.unit) == ("mass", 4, 4, "kg")
    assert (price.undecided, price.all_tried, price.is_least, price.gap) == (0, True, True, 0)
    shown = str(result)
    assert "10; no robot has less" in shown
    assert "4 kg; no robot within what the objectives before it leave has less" in shown
    light = next(one for one in result.designs if "Light" in one.word)
    assert [(each.value, each.least) for each in light.objectives] == [(30, 0), (2, 0)]
    assert "30; nothing is proved of other robots" in str(light)


def test_without_minimize_there_are_no_objectives(turned):
    assert turned.objectives == ()


@pytest.mark.parametrize("entry", [1, {}, {"objective": "mass", "value": "2"}])
def test_altered_objectives(entry, priced):
    design = json.loads((priced / "design.json").read_text(encoding="utf-8"))
    design["objectives"] = [entry]
    (priced / "design.json").write_text(json.dumps(design), encoding="utf-8")
    with pytest.raises(srgc.SrgcError, match="not what `srgc synth` writes"):
        _ = srgc.open_result(priced).objectives


def test_an_impossible_result(made):
    result = srgc.open_result(made("beyond_reach") / "out")
    assert (result.verdict, result.word, result.robustness) == ("impossible", None, None)
    assert result.reason.endswith("are refuted")
    assert result.verify().valid
    found = srgc.why(result, runs=False)
    assert ["an effector starts in `S`"] in found.conflicts
    assert found.suggestions == []
    assert "\nspec.srg:" in str(found) or "\nbeyond_reach.srg:" in str(found)
    for asked in ("robot", "trajectory"):
        with pytest.raises(srgc.SrgcError) as caught:
            getattr(result, asked)
        assert caught.value.code.value == "SRG0735"
        assert str(caught.value) == (
            f"{result.folder} has no robot: its verdict is impossible\n"
            f"  hint: `srgc why {result.folder}` says why"
        )
    with pytest.raises(srgc.SrgcError):
        result.landscape()


def test_a_landscape(turned):
    """The paper's rho is concave here: least at the ends of what can be reached."""
    found = turned.landscape(points=3, ranges={"4.length": (1.21, 1.6)}, marks={"own": [1.3]})
    assert list(found.axes) == ["4.length"]
    np.testing.assert_allclose(found.axes["4.length"], [1.21, 1.405, 1.6])
    assert found.robustness.shape == found.feasible.shape == (3,)
    assert found.robustness.max() <= turned.robustness + 1e-6
    assert "own" in found.svg
    with pytest.raises(srgc.SrgcError, match=r"no parameter `5\.length`"):
        turned.landscape("5.length")
    for wrong, said in (
        ({"points": 1}, "from 2 to 1000"), ({"points": 10**9}, "from 2 to 1000"),
        ({"jobs": 0}, "counts from 1"), ({"ranges": {"4.length": 3}}, "two numbers"),
        ({"marks": {"own": 1.3}}, "a number for each"), ({"ranges": [1]}, "is a mapping"),
    ):  # fmt: skip
        with pytest.raises(srgc.SrgcError, match=said):
            turned.landscape("4.length", **wrong)
    assert found != turned.landscape(points=3, ranges={"4.length": (1.21, 1.6)})
    assert turned.trajectory != srgc.open_result(turned).trajectory


def test_the_types_of_an_export_name_every_format():
    assert set(get_args(Form)) == {*design_export.FORMS, *design_export.FOLDERS}
    assert set(get_args(Binary)) == set(design_export.BINARY)
    assert set(get_args(Text)) == set(design_export.FORMS) - set(design_export.BINARY)


def test_exports(turned, tmp_path):
    text = srgc.export(turned, "urdf")
    assert "<robot" in text
    assert srgc.export(turned, "urdf", tmp_path / "arm.urdf") == (tmp_path / "arm.urdf",)
    assert (tmp_path / "arm.urdf").read_text(encoding="utf-8") == text
    assert srgc.export(turned, "npz")[:2] == b"PK"
    assert "effort: []" in srgc.export(turned, "ros2", efforts=False)
    assert "effort: []" not in srgc.export(turned, "ros2")
    with pytest.raises(srgc.SrgcError, match="is one of the results"):
        srgc.export(turned, "csv", turned.folder / "trajectory.csv")


def test_a_copy_of_a_folder_is_the_same_result(made, tmp_path):
    shutil.copytree(made("turner") / "out", tmp_path / "moved")
    result = srgc.open_result(tmp_path / "moved")
    assert os.fspath(result) == str(tmp_path / "moved")
    assert srgc.verify(result, spec=made("turner") / "turner.srg").valid
