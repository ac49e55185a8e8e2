"""Shards, ledgers and the list of long tests, on suites of a few tests."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.long_tests import ALWAYS, LISTED, SLOW, slow_tests
from tests.resumable import shard_of

ROOT = Path(__file__).parents[1]
TEN = "\n".join(f"def test_{number}(): assert {number} != 7" for number in range(10))


def run(folder: Path, *options: str) -> tuple[str, set[str]]:
    """What pytest says, and the names of the tests that passed."""
    finished = subprocess.run(
        [
            *[sys.executable, "-m", "pytest", "-c", os.devnull, "--rootdir", folder, "-rpfE"],
            *["-p", "no:cacheprovider", *options, folder],
        ],
        cwd=ROOT,
        env={key: value for key, value in os.environ.items() if key != "PYTEST_XDIST_WORKER"}
        | {"COLUMNS": "200", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    return finished.stdout + finished.stderr, set(re.findall(r"PASSED \S*::(\w+)", finished.stdout))


@pytest.mark.slow
def test_every_test_is_in_one_shard(tmp_path: Path) -> None:
    (tmp_path / "test_ten.py").write_text(TEN.replace("!= 7", "< 10"), encoding="utf-8")
    parts = [run(tmp_path, "-p", "tests.resumable", f"--shard={part}/3")[1] for part in (1, 2, 3)]
    assert sum(map(len, parts)) == 10
    assert set.union(*parts) == {f"test_{number}" for number in range(10)}


@pytest.mark.slow
def test_every_file_is_in_one_part(tmp_path: Path) -> None:
    for number in range(5):
        test = f"def test_{number}(): pass"
        (tmp_path / f"test_{number}.py").write_text(test, encoding="utf-8")
    parts = [run(tmp_path, "-p", "tests.resumable", f"--files={part}/2")[1] for part in (1, 2)]
    assert parts == [{"test_0", "test_2", "test_4"}, {"test_1", "test_3"}]


def test_a_second_slow_run_knows_its_options() -> None:
    """A word of its own that names a folder is taken for the tests to run: no plugin is loaded."""
    text = (ROOT / "Makefile").read_text()
    for target in ("test-slow", "campaigns"):
        [recipe] = re.findall(f"^{target}:.*\n\t(.*)$", text, re.MULTILINE)
        assert recipe.endswith(" $(SLOWLY)")
    [options] = re.findall("^SLOWLY := (.*)$", text, re.MULTILINE)
    assert "--ledger=out/slow" in options.split()
    assert "--shard=$(SHARD)" in options


@pytest.mark.parametrize("shard", ["0/3", "4/3", "3", "a/b", "-1/3", "1/0"])
def test_a_shard_that_is_none(shard: str) -> None:
    with pytest.raises(pytest.UsageError, match="expected K/N with 1 <= K <= N"):
        shard_of(shard)


@pytest.mark.slow
def test_a_ledger_leaves_out_what_passed(tmp_path: Path) -> None:
    tests, ledger = tmp_path / "tests", tmp_path / "ledger"
    tests.mkdir()
    (tests / "test_ten.py").write_text(
        TEN + "\nimport pytest\ndef test_skipped(): pytest.skip()", encoding="utf-8"
    )
    options = ["-p", "xdist", "-p", "tests.resumable", "-n", "2", f"--ledger={ledger}"]
    assert len(run(tests, *options)[1]) == 9
    said, passed = run(tests, *options)
    assert not passed
    assert "1 failed, 1 skipped" in said
    (file,) = ledger.iterdir()
    told = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    assert sorted(line["test"] for line in told) == [
        f"test_ten.py::test_{number}" for number in range(10) if number != 7
    ]
    # A line that was cut off is no test that passed.
    file.write_text(file.read_text(encoding="utf-8")[:-4], encoding="utf-8")
    options[5] = "0"
    assert run(tests, *options)[1] == {told[-1]["test"].partition("::")[2]}


def test_a_quick_test_starts_no_process(tmp_path: Path) -> None:
    (tmp_path / "test_two.py").write_text(
        "import os, subprocess, sys\n"
        "def test_alone(): pass\n"
        "def test_starts(): subprocess.run([sys.executable, '-c', ''], check=True)\n",
        encoding="utf-8",
    )
    said, passed = run(tmp_path, "-p", "tests.long_tests", "-m", "not long")
    assert passed == {"test_alone"}
    assert "test_starts" in said
    assert "run `make timings`" in said


def test_a_slow_test_is_left_out_of_the_usual_suite(tmp_path: Path) -> None:
    """The list names a file of this suite, and a test there."""
    file, names = next(iter(json.loads(SLOW.read_text(encoding="utf-8")).items()))
    place = tmp_path / file
    place.parent.mkdir(parents=True)
    name = names[0].partition("[")[0]
    text = f"def test_else(): pass\ndef {name}(): pass\n"
    if "[" in names[0]:
        text = "import pytest\n@pytest.mark.parametrize('x', [0], ids=[IDS])\n".replace(
            "IDS", repr(names[0].partition("[")[2][:-1])
        ) + text.replace(f"{name}()", f"{name}(x)")
        text = text.replace("def test_else(): pass\n", "") + "def test_else(): pass\n"
    place.write_text(text, encoding="utf-8")
    _, passed = run(tmp_path, "-p", "tests.long_tests", "-m", "not slow")
    assert passed == {"test_else"}


CLOCK = """
import types
from pathlib import Path
import pytest
from _pytest import timing
from tests import long_tests

now = [0.0]
timing.perf_counter = timing.time = lambda: now[0]
long_tests.time = types.SimpleNamespace(perf_counter=lambda: now[0])
here = Path(__file__).parent
long_tests.LISTED, long_tests.SLOW = here / "long.json", here / "slow.json"

def take(seconds):
    now[0] += seconds

@pytest.fixture(scope="module")
def shared():
    take(5)

@pytest.fixture
def own():
    take(0.3)
"""
TIMED = """
from conftest import take
from tests.long_tests import SHARED

def test_nothing(): pass
def test_first_of_a_fixture(shared): take(0.1)
def test_second_of_a_fixture(shared): pass
def test_own_fixture(own): pass
def test_made_within():
    with SHARED.making():
        take(2)
        with SHARED.making():
            take(3)
def test_alone(): take(0.25)
"""


def test_what_tests_share_is_counted_for_none(tmp_path: Path) -> None:
    """By a clock that goes on only where it is told to."""
    (tmp_path / "conftest.py").write_text(CLOCK, encoding="utf-8")
    (tmp_path / "test_timed.py").write_text(TIMED, encoding="utf-8")
    for name in ("long.json", "slow.json"):
        (tmp_path / name).write_text("{}", encoding="utf-8")
    said, passed = run(tmp_path, "-p", "tests.long_tests", "--record-long")
    assert len(passed) == 6, said
    slow = json.loads((tmp_path / "slow.json").read_text(encoding="utf-8"))
    assert slow == {"test_timed.py": ["test_alone", "test_own_fixture"]}
    (long,) = json.loads((tmp_path / "long.json").read_text(encoding="utf-8")).values()
    assert long == [
        "test_alone", "test_first_of_a_fixture", "test_made_within", "test_own_fixture",
        "test_second_of_a_fixture",
    ]  # fmt: skip


def test_each_file_keeps_its_quickest_test() -> None:
    seconds = {"a.py::one": 0.7, "a.py::two": 0.6, "b.py::one": 4, "c.py::one": 0.1, "c.py::two": 1}
    assert slow_tests(seconds) == {"a.py::one", "b.py::one", "c.py::two"}


def test_the_cases_of_one_test_have_a_bound_together() -> None:
    """0.06 + 0.07 + 0.08 s are less, and 0.09 s more are 0.3 s; 0.1 s more are too much."""
    cases = {f"a.py::many[{case}]": 0.06 + 0.0099 * case for case in range(5)}
    others = {"a.py::more[0]": 0.14, "a.py::more[1]": 0.15, "a.py::quickest": 0.01}
    quick = {f"a.py::quick[{case}]": 0.029 for case in range(20)}
    assert slow_tests(cases | others | quick) == {"a.py::many[4]"}


def test_each_test_of_soundness_keeps_its_quickest_case() -> None:
    file = "tests/soundness/test_drives.py"
    cases = {"one[a]": 0.7, "one[b]": 0.8, "two": 0.9, "three": 1.0, "four": 0.1}
    slow = slow_tests({f"{file}::{name}": seconds for name, seconds in cases.items()})
    assert slow == {f"{file}::one[b]", f"{file}::three"}


def test_pages_that_take_seconds_are_slow_but_for_the_first_ones() -> None:
    pages = {"README.md": 9, "docs/tutorial.md": 9, "docs/how-to/new.md": 2.9, "docs/a.md": 3}
    page = "tests/test_documentation.py::test_pages_run_as_shown[{}]".format
    assert slow_tests({page(name): took for name, took in pages.items()}) == {page("docs/a.md")}


def test_what_always_runs_is_there_and_is_not_listed() -> None:
    listed = json.loads(SLOW.read_text(encoding="utf-8"))
    for test in ALWAYS:
        file, _, name = test.partition("::")
        assert name not in listed.get(file, [])
        assert f"def {name.partition('[')[0]}(" in (ROOT / file).read_text(encoding="utf-8")


@pytest.mark.parametrize("listed", [LISTED, SLOW], ids=["long", "slow"])
def test_what_is_listed_is_there(listed: Path) -> None:
    """A test that was renamed and forgotten in a list would be run as one that takes no time."""
    for file, names in json.loads(listed.read_text(encoding="utf-8")).items():
        text = (ROOT / file).read_text(encoding="utf-8")
        for name in {name.partition("[")[0] for name in names}:
            assert f"def {name}(" in text, (file, name)
