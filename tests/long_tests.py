"""Which tests `make quick` leaves out: those that take 0.1 s and more, or start a process.

`make timings` records them in ``long_tests.json``, file by file; a test that is not listed is
quick. One that starts a process and is not listed fails in `make quick`.
"""

from __future__ import annotations

import json
import os
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

LISTED = Path(__file__).with_name("long_tests.json")
LONG_SECONDS = 0.1
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
    listed = {
        f"{file}::{name}"
        for file, names in json.loads(LISTED.read_text(encoding="utf-8")).items()
        for name in names
    }
    for item in items:
        if item.nodeid in listed:
            item.add_marker(pytest.mark.long)


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
        self.starting: set[str] = set()
        self.long_fixtures: set[Fixture] = set()
        self.used: dict[str, set[Fixture]] = {}

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[object]) -> Iterator[object]:
        """What a shared fixture starts counts for all tests that use it, whichever came first."""
        before = self.processes.started
        result = yield
        key = (fixturedef.baseid, fixturedef.argname)
        self.fixtures[key] = self.fixtures.get(key, False) or self.processes.started > before
        return result

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[object]:
        before = self.processes.started
        item.user_properties.append(("before", before))
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item) -> Iterator[pytest.TestReport]:
        report = yield
        if report.when == "teardown":
            before = dict(item.user_properties)["before"]
            used = [
                (definition.baseid, definition.argname)
                for definitions in getattr(item, "_fixtureinfo").name2fixturedefs.values()  # noqa: B009
                for definition in definitions
            ]
            report.user_properties = [
                (
                    "starts",
                    self.processes.started > before or bool(MADE & {key[1] for key in used}),
                ),
                ("used", used),
                ("starting", [key for key, starts in self.fixtures.items() if starts]),
            ]
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.seconds[report.nodeid] += report.duration
        if report.when == "teardown":
            told = dict(report.user_properties)
            self.used[report.nodeid] = {tuple(key) for key in told["used"]}
            self.long_fixtures |= {tuple(key) for key in told["starting"]}
            if told["starts"]:
                self.starting.add(report.nodeid)

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if "PYTEST_XDIST_WORKER" in os.environ:
            return
        listed: dict[str, list[str]] = defaultdict(list)
        for test in sorted(self.used):
            if (
                self.seconds[test] >= LONG_SECONDS
                or test in self.starting
                or self.used[test] & self.long_fixtures
            ):
                file, _, name = test.partition("::")
                listed[file].append(name)
        LISTED.write_text(json.dumps(listed, indent=0, ensure_ascii=True) + "\n", encoding="utf-8")
