"""The line on what to do next."""

from __future__ import annotations

import shlex

import pytest

from srgc.text_reports.next_step import next_advice, next_command


@pytest.mark.parametrize("path", ["out/a", "a folder", "it's", "$HOME", "a # b"])
def test_a_command_can_be_copied_into_a_shell(path: str) -> None:
    line = next_command("srgc verify", path, "what it does")
    assert shlex.split(line.removeprefix("next:"), comments=True) == ["srgc", "verify", path]


def test_what_does_not_fit_is_left_out() -> None:
    assert next_command("srgc why", "a" * 40, "b" * 18).endswith("  # " + "b" * 18)
    assert next_command("srgc why", "a" * 60, "b" * 20) == f"next:    srgc why {'a' * 60}"
    assert next_command("srgc why", "a" * 70) == "next:    srgc why, with the same path"


def test_advice_has_the_command_beside_it_or_below() -> None:
    assert next_advice("try more", "srgc why", "out") == "next:    try more, or srgc why out"
    assert next_advice("try " + "more " * 14, "srgc why", "out").splitlines()[1] == (
        "         or srgc why out"
    )
