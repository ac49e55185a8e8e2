"""Whether ``design.json`` and ``pareto.json`` have what a report reads of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from srgc.faults import UsageFault
from srgc.report.structure_groups import GROUPS


def checked_design(design: Mapping[str, Any], path: Path) -> None:
    """Raise unless ``design.json`` says what was tried as ``srgc synth`` does.

    What the certificate determines is held against it elsewhere.

    Raises:
        UsageFault: it does not.
    """
    tried = design.get("structures_tried")
    if not (
        isinstance(tried, list)
        and _all(tried, _is_structure)
        and all(_follows(tried, number) for number in range(len(tried)))
        and _all(design.get("counterexamples", []), _is_counterexample)
        and isinstance(design.get("iterations"), dict)
        and all(isinstance(each, int) for each in design["iterations"].values())
        and _all(design.get("satisfy"), _is_formula)
    ):
        raise UsageFault(f"{path} is not what `srgc synth` writes")


def checked_designs(content: Mapping[str, Any], path: Path) -> None:
    """The same for ``pareto.json``, which may be empty.

    Raises:
        UsageFault: it is not what ``srgc synth`` writes.
    """
    if not all(_all(content.get(name, []), _is_design) for name in ("designs", "dominated")):
        raise UsageFault(f"{path} is not what `srgc synth` writes")


def _all(items: Any, right: Callable[[Any], bool]) -> bool:
    return isinstance(items, list) and all(isinstance(e, dict) and right(e) for e in items)


def _is_structure(one: Mapping[str, Any]) -> bool:
    return (
        _is_word(one.get("word"))
        and one.get("verdict") in GROUPS
        and isinstance(one.get("evidence"), str)
        and (one.get("boxes") is None or isinstance(one["boxes"], str))
        and isinstance(one.get("reason", ""), str)
    )


def _follows(tried: Sequence[Mapping[str, Any]], number: int) -> bool:
    """Whether the robot that a structure is again was tried before, itself no repetition."""
    same = tried[number].get("same_robot_as")
    if same is None:
        return True
    return isinstance(same, int) and 0 <= same < number and tried[same].get("same_robot_as") is None


def _is_counterexample(one: Mapping[str, Any]) -> bool:
    return (
        isinstance(one.get("structure"), int)
        and _is_word(one.get("cells"))
        and all(
            each is None or _is_number(each) for each in (one.get("time"), one.get("robustness"))
        )
    )


def _is_formula(one: Mapping[str, Any]) -> bool:
    value = one.get("robustness")
    return value is None or _is_number(value)


def _is_design(one: Mapping[str, Any]) -> bool:
    return (
        all(_is_number(one.get(name)) for name in ("structure", "modules", "total_length"))
        and _is_number(one.get("robustness"))
        and _is_word(one.get("word"))
        and isinstance(one.get("folder"), str)
    )


def _is_word(word: Any) -> bool:
    return isinstance(word, list) and all(isinstance(each, str) for each in word)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
