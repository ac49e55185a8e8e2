"""Which tests `make quick` and `make test` leave out, because of how long they take.

`make timings` records in ``long_tests.json``, file by file, which tests take 0.015 s and more,
start a process, or use a shared fixture that does or takes 0.5 s; `make quick` leaves them out. A
test that is not listed is quick; if it starts a process it fails in `make quick`.

In ``slow_tests.json`` are those that run in `make test-slow` alone, as those marked `slow` do:

- tests that took 0.2 s and more; where all cases of one test took more than 0.3 s together, the
  slowest of them, too, but for those below 0.03 s. The quickest test of each file stays unless it
  took 3 s, and the quickest case of each test of soundness unless it took 1 s;
- of pages, shipped specs and what the paper says (``USUAL``), whatever took 3 s and more, but for
  the pages that everybody reads first and one run that is repeated (``ALWAYS``, which has the test
  that the verifier loads no searcher, too);
- by hand, those for which alone a long synthesis would be made. What tests share, fixtures and the
  syntheses of ``made``, is counted for none of them.
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from pathlib import Path

import pytest

LISTED = Path(__file__).with_name("long_tests.json")
LONG_SECONDS = 0.015
STAYS_SECONDS = 0.03
"""A case that takes less stays in the usual suite."""
FIXTURE_SECONDS = 0.5
"""All tests that use a shared fixture which takes this long are long."""
SLOW = Path(__file__).with_name("slow_tests.json")
SLOW_SECONDS = 0.2
CASES_SECONDS = 0.3
"""What the cases of one test may take together, the quickest first; quick tests stay."""
KEPT_SECONDS = 3.0
"""The quickest test of a file stays in the usual suite, unless it takes as long as this."""
SOUND_SECONDS = 1.0
"""So does the quickest case of each test below ``SOUNDNESS``."""
SOUNDNESS = "tests/soundness/"
USUAL_SECONDS = 3.0
USUAL = {
    "tests/solvers/test_case_study.py",
    "tests/srgc/test_determinism.py",
    "tests/srgc/test_shipped_specs.py",
    "tests/test_documentation.py",
    "tests/test_forty_mistakes.py",
    "tests/test_glossary.py",
    "tests/test_golden.py",
    "tests/test_language_reference.py",
}
"""What pages, specs and the paper say is in the usual suite if it takes less than that."""
ALWAYS = {
    "tests/srgc/test_determinism.py::test_a_small_spec[turner]",
    "tests/test_documentation.py::test_pages_run_as_shown[README.md]",
    "tests/test_documentation.py::test_pages_run_as_shown[docs/tutorial.md]",
    "tests/test_structure.py::test_the_verify_command_loads_no_searcher",
}
STARTS = {"os.fork", "os.forkpty", "os.posix_spawn", "os.system", "pty.spawn", "subprocess.Popen"}

MADE = {"made", "result"}
"""Fixtures that hand out finished syntheses: whichever test asks first starts the process."""

Fixture = tuple[str, str]
"""Where a fixture is defined, and its name."""


class ProcessCount:
    """How many processes this interpreter has started since :meth:`watch`."""

    def __init__(self) -> None:
        self.started = 0

    def watch(self) -> None:
        """For good: Python takes no audit hook back."""
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: object) -> None:
        self.started += event in STARTS


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--record-long", action="store_true", help=f"write {LISTED.name} anew")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "long: in long_tests.json, left out by `make quick`")
    if config.option.record_long:
        config.pluginmanager.register(Recorder(), "recorder of long tests")
    elif "not long" in config.option.markexpr:
        config.pluginmanager.register(QuickTestsAlone(), "no process in a quick test")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    marks = pytest.mark.long, pytest.mark.slow
    for mark, tests in zip(marks, map(_listed, (LISTED, SLOW)), strict=True):
        for item in items:
            if item.nodeid in tests:
                item.add_marker(mark)


def _listed(file: Path) -> set[str]:
    """The tests that a list names."""
    found = json.loads(file.read_text(encoding="utf-8")).items()
    return {f"{path}::{name}" for path, names in found for name in names}


def _write(file: Path, tests: Iterable[str]) -> None:
    listed: dict[str, list[str]] = defaultdict(list)
    for test in sorted(tests):
        path, _, name = test.partition("::")
        listed[path].append(name)
    file.write_text(json.dumps(listed, indent=0, ensure_ascii=True) + "\n", encoding="utf-8")


def slow_tests(seconds: Mapping[str, float]) -> set[str]:
    """Those that `make test` leaves out from now on, by what each takes."""
    slow, seen = set[str](), set[str]()
    together: dict[str, float] = defaultdict(float)
    for test in sorted(seconds, key=lambda test: (seconds[test], test)):
        file, name = test.partition("::")[0], test.partition("[")[0]
        together[name] += seconds[test]
        many = file not in USUAL and name in seen and together[name] > CASES_SECONDS
        many = many and seconds[test] >= STAYS_SECONDS
        if many or seconds[test] >= _bound(test, file not in seen, name not in seen):
            slow.add(test)
        seen |= {file, name}
    return slow


def _bound(test: str, first_of_file: bool, first_case: bool) -> float:
    """The seconds from which a test is slow."""
    if test in ALWAYS:
        return math.inf
    if test.partition("::")[0] in USUAL:
        return USUAL_SECONDS
    if first_of_file:
        return KEPT_SECONDS
    return SOUND_SECONDS if first_case and test.startswith(SOUNDNESS) else SLOW_SECONDS


class SharedTime:
    """Seconds that have gone to what tests share: made for one of them, it is there for all."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._depth = 0

    @contextmanager
    def making(self) -> Iterator[None]:
        """What is made meanwhile is shared; within another of these it is not counted again."""
        begin = time.perf_counter()
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1
            if not self._depth:
                self.seconds += time.perf_counter() - begin


SHARED = SharedTime()
"""Of this process."""


class QuickTestsAlone:
    """Fails a test that starts a process."""

    def __init__(self) -> None:
        self.processes = ProcessCount()
        self.processes.watch()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        before = self.processes.started
        result = yield
        if self.processes.started > before:
            pytest.fail("it starts a process and is not in long_tests.json: run `make timings`")
        return result


class Recorder:
    """Notes in every worker what a test costs; writes the list where the reports come together."""

    def __init__(self) -> None:
        self.processes = ProcessCount()
        self.processes.watch()
        self.fixtures: dict[Fixture, bool] = {}
        self.seconds: dict[str, float] = defaultdict(float)
        self.own: dict[str, float] = defaultdict(float)
        """Without what tests share."""
        self.starting: set[str] = set()
        self.long_fixtures: set[Fixture] = set()
        self.used: dict[str, set[Fixture]] = {}

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[object]) -> Iterator[object]:
        """What a shared fixture starts or takes counts for all tests that use it.

        Whichever test came first: if that one were left out, the next one would be the first.
        """
        before, began = self.processes.started, time.perf_counter()
        with nullcontext() if fixturedef.scope == "function" else SHARED.making():
            result = yield
        key = (fixturedef.baseid, fixturedef.argname)
        slow = fixturedef.scope != "function" and time.perf_counter() - began >= FIXTURE_SECONDS
        long = slow or self.processes.started > before
        self.fixtures[key] = self.fixtures.get(key, False) or long
        return result

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[object]:
        item.user_properties.append(("before", (self.processes.started, SHARED.seconds)))
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item) -> Iterator[pytest.TestReport]:
        report = yield
        if report.when == "teardown":
            started, shared = dict(item.user_properties)["before"]
            used = [
                (definition.baseid, definition.argname)
                for definitions in getattr(item, "_fixtureinfo").name2fixturedefs.values()  # noqa: B009
                for definition in definitions
            ]
            report.user_properties = [
                (
                    "starts",
                    self.processes.started > started or bool(MADE & {key[1] for key in used}),
                ),
                ("shared", SHARED.seconds - shared),
                ("used", used),
                ("starting", [key for key, starts in self.fixtures.items() if starts]),
            ]
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.seconds[report.nodeid] += report.duration
        self.own[report.nodeid] += report.duration * (report.when != "teardown")
        if report.when == "teardown":
            told = dict(report.user_properties)
            self.own[report.nodeid] -= told["shared"]
            self.used[report.nodeid] = {tuple(key) for key in told["used"]}
            self.long_fixtures |= {tuple(key) for key in told["starting"]}
            if told["starts"]:
                self.starting.add(report.nodeid)

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if "PYTEST_XDIST_WORKER" in os.environ:
            return
        _write(SLOW, _listed(SLOW) | slow_tests(self.own))
        _write(LISTED, filter(self.is_long, self.used))

    def is_long(self, test: str) -> bool:
        """Whether `make quick` leaves a test out."""
        starts = test in self.starting or bool(self.used[test] & self.long_fixtures)
        return starts or self.seconds[test] >= LONG_SECONDS
