"""The rule of versions and of the changelog, the citation, and the bill of materials."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from collections import Counter
from datetime import date
from pathlib import Path

import pytest
import yaml
from packaging.version import Version

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CHANGELOG = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
GROUPS = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security", "Soundness"}
"""Those of Keep a Changelog, and ours."""


def headings(changelog: str) -> list[str]:
    return re.findall(r"^## (.+)$", changelog, re.MULTILINE)


def releases(changelog: str) -> list[tuple[Version, date]]:
    """Versions and their days as the headings after the first one have them, the latest first."""
    found = [
        re.fullmatch(r"\[(\d+\.\d+\.\d+)\] - (\d{4}-\d\d-\d\d)", each)
        for each in headings(changelog)[1:]
    ]
    return [(Version(each[1]), date.fromisoformat(each[2])) for each in found if each is not None]


def faults(changelog: str, version: str) -> list[str]:
    """What is against the rule."""
    found = releases(changelog)
    versions, days = [one[0] for one in found], [one[1] for one in found]
    groups = re.findall(r"^### (.+)$", changelog, re.MULTILINE)
    rules = {
        "begins with what is not released": headings(changelog)[:1] == ["[Unreleased]"],
        "other headings are versions and days": len(found) + 1 == len(headings(changelog)),
        "versions fall": versions == sorted(set(versions), reverse=True),
        "days do not rise": days == sorted(days, reverse=True),
        "groups are known": set(groups) <= GROUPS,
        "the version is that of the latest release, or the next": (
            not versions or Version(version) >= versions[0]
        ),
    }
    return [rule for rule, kept in rules.items() if not kept]


def test_the_changelog_follows_the_rule() -> None:
    assert faults(CHANGELOG, PROJECT["version"]) == []


@pytest.mark.parametrize(
    ("changelog", "broken"),
    [
        ("## [0.1.0] - 2026-01-01\n", "begins with what is not released"),
        ("## [Unreleased]\n## [0.1.0] - 1st May\n", "other headings are versions and days"),
        (
            "## [Unreleased]\n## [0.1.0] - 2026-02-01\n## [0.1.1] - 2026-01-01\n",
            "versions fall",
        ),
        (
            "## [Unreleased]\n## [0.1.1] - 2026-01-01\n## [0.1.0] - 2026-02-01\n",
            "days do not rise",
        ),
        ("## [Unreleased]\n### Misc\n", "groups are known"),
        (
            "## [Unreleased]\n## [0.3.0] - 2026-01-01\n",
            "the version is that of the latest release, or the next",
        ),
    ],
)
def test_the_rule_sees_what_breaks_it(changelog: str, broken: str) -> None:
    assert faults(changelog, "0.2.0") == [broken]


def test_the_citation_is_that_of_the_package() -> None:
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert (cited["title"], cited["version"], cited["license"]) == (
        PROJECT["name"], PROJECT["version"], PROJECT["license"],
    )  # fmt: skip
    assert cited["authors"] == PROJECT["authors"]
    assert cited["keywords"] == PROJECT["keywords"]
    [holder] = re.findall(r"^Copyright \(c\) \d+ (.+)$", (ROOT / "LICENSE").read_text(), re.M)
    assert [one["name"] for one in cited["authors"]] == [holder]
    found = releases(CHANGELOG)
    released = found[0][1] if found and str(found[0][0]) == cited["version"] else None
    assert cited.get("date-released") == released


# --- the bill of materials ------------------------------------------------------------------------


def materials(folder: Path, *locks: str) -> dict[str, bytes]:
    """What `make sbom` writes, by lock file."""
    subprocess.run(
        ["bash", ".ci/sbom", folder, *locks],
        cwd=ROOT, env={**os.environ, "PYTHON": sys.executable}, check=True, capture_output=True,
    )  # fmt: skip
    return {lock: (folder / f"{lock}.cdx.json").read_bytes() for lock in locks}


def locked(lock: str) -> list[tuple[str, str, frozenset[str]]]:
    """Name, version and digests of each library of a lock file, read line by line."""
    found: list[tuple[str, str, frozenset[str]]] = []
    for line in (ROOT / "requirements" / f"{lock}.lock").read_text(encoding="utf-8").splitlines():
        if re.match(r"\w", line):
            name, version = re.split(r"==|[ ;\\]", line)[:2]
            found.append((name, version, frozenset()))
        elif "--hash=" in line:
            name, version, digests = found[-1]
            found[-1] = name, version, digests | {line.strip(" \\").removeprefix("--hash=sha256:")}
    return found


def test_the_bill_of_materials_is_the_lock_file(tmp_path: Path) -> None:
    for lock, content in materials(tmp_path, "run", "dev").items():
        bill = json.loads(content)
        listed = [
            (
                one["name"],
                one["version"],
                frozenset(digest["content"] for digest in one["externalReferences"][0]["hashes"]),
            )
            for one in bill["components"]
        ]
        assert Counter(listed) == Counter(locked(lock))
        assert [one["purl"] for one in bill["components"]] == [
            f"pkg:pypi/{name}@{version}" for name, version, _ in listed
        ]
        about = bill["metadata"]["component"]
        assert (about["name"], about["version"]) == (PROJECT["name"], PROJECT["version"])
        assert about["licenses"][0]["license"]["id"] == PROJECT["license"]
        assert "timestamp" not in bill["metadata"]
        assert "serialNumber" not in bill


def test_the_bill_of_materials_is_the_same_each_time(tmp_path: Path) -> None:
    first, second = (materials(tmp_path / which, "run") for which in ("first", "second"))
    assert first == second
