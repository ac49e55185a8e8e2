"""Long suites in parts: a shard of the tests, and a run that goes on where the last one ended.

``--shard 2/6`` runs every sixth test, from the second on, and ``--files 2/6`` the tests of every
sixth file, which alone are imported then. ``--ledger FOLDER`` writes each test that
passes, with its seconds, into a file that is named after the code, and leaves out what is in it:
once anything that is tested or tests has changed, the file has another name and all tests run.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--shard", metavar="K/N", help="every Nth test, from the Kth on")
    parser.addoption("--files", metavar="K/N", help="every Nth file of tests, from the Kth on")
    parser.addoption("--ledger", metavar="FOLDER", help="leave out what passed with the same code")


def pytest_configure(config: pytest.Config) -> None:
    if config.option.ledger:
        config.pluginmanager.register(Ledger(config), "ledger of tests that passed")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    if not config.option.files or not collection_path.name.startswith("test_"):
        return None
    first, count = shard_of(config.option.files)
    tests = config.rootpath / "tests"
    number = test_files(tests if tests.is_dir() else config.rootpath).get(collection_path)
    return None if number is None or number % count == first else True


@cache
def test_files(folder: Path) -> dict[Path, int]:
    """All files of tests below a folder, numbered."""
    return {file: number for number, file in enumerate(sorted(folder.rglob("test_*.py")))}


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """The shard is one of all tests: what passes in one run moves none to another shard."""
    if config.option.shard:
        first, count = shard_of(config.option.shard)
        keep(config, items, {item.nodeid for item in items[first::count]})
    ledger = config.pluginmanager.get_plugin("ledger of tests that passed")
    if ledger is not None:
        keep(config, items, {item.nodeid for item in items} - ledger.passed)


def shard_of(text: str) -> tuple[int, int]:
    """``"2/6"`` as the number of its first test, from 0, and the number of shards."""
    number, slash, count = text.partition("/")
    if not (slash and number.isdecimal() and count.isdecimal() and 1 <= int(number) <= int(count)):
        raise pytest.UsageError(f"{text}: expected K/N with 1 <= K <= N, as in 2/6")
    return int(number) - 1, int(count)


def keep(config: pytest.Config, items: list[pytest.Item], kept: set[str]) -> None:
    config.hook.pytest_deselected(items=[item for item in items if item.nodeid not in kept])
    items[:] = [item for item in items if item.nodeid in kept]


def code_digest() -> str:
    """Of all files that git knows or would add, by their names and bytes."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        check=True,
    ).stdout
    digest = hashlib.sha256()
    for name in sorted(filter(None, listed.split(b"\0"))):
        file = ROOT / os.fsdecode(name)
        if file.is_file():
            digest.update(name + b"\0" + hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()[:16]


class Ledger:
    """The tests that have passed with this code: a line of JSON each, added as it passes."""

    def __init__(self, config: pytest.Config) -> None:
        self.seconds: dict[str, float] = {}
        self.calls_passed: set[str] = set()
        if hasattr(config, "workerinput"):
            # What passed before the run, also for a worker that replaces one that died.
            self.file = None
            self.passed = set(config.workerinput["passed"])
        else:
            self.file = ROOT / config.option.ledger / f"{code_digest()}.jsonl"
            self.passed = self._read(self.file)

    @staticmethod
    def _read(file: Path) -> set[str]:
        if not file.exists():
            return set()
        # The last line is cut off where the machine was.
        whole, _, _ = file.read_text(encoding="utf-8").rpartition("\n")
        return {json.loads(line)["test"] for line in whole.splitlines()}

    @pytest.hookimpl(optionalhook=True)
    def pytest_configure_node(self, node: Any) -> None:
        node.workerinput["passed"] = sorted(self.passed)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """A test that was skipped is tried again the next time."""
        test = report.nodeid
        self.seconds[test] = self.seconds.get(test, 0.0) + report.duration
        if report.when == "call" and report.passed:
            self.calls_passed.add(test)
        elif (
            report.when == "teardown" and report.passed and test in self.calls_passed and self.file
        ):
            self.file.parent.mkdir(parents=True, exist_ok=True)
            told = {"test": test, "seconds": round(self.seconds[test], 3)}
            with self.file.open("a", encoding="utf-8") as ledger:
                ledger.write(json.dumps(told) + "\n")
