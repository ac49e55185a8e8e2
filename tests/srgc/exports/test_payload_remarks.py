"""Exports say that a payload is part of the robot, and give it to the last link."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import TURNER, replaced
from tests.srgc.conftest import Ran

WORD = "B eps JO eps L eps EN"


def mass(text: str) -> float:
    """The mass of all links of a URDF, in kg."""
    return sum(float(each.attrib["value"]) for each in ET.fromstring(text).iter("mass"))


@pytest.mark.parametrize("form", ["urdf", "mjcf"])
@pytest.mark.parametrize("who", ["", " by effector 1"])
def test_a_payload_is_told(srgc: Callable[..., Ran], tmp_path: Path, form: str, who: str) -> None:
    loaded = replaced(TURNER, "reach T;", f"reach T; payload 1.25 kg{who};")
    folder = claim_found(tmp_path / "loaded", loaded, WORD, ["1.5"])
    ran = srgc("export", folder, "--to", form)
    said = "the payload of effector 1, 1.25 kg," if who else "the payload, 1.25 kg,"
    assert ran.err == f"note: {said} is part of the robot\n"
    assert f"<!-- {said} is part of the robot -->" in ran.out
    bare = srgc("export", claim_found(tmp_path / "bare", TURNER, WORD, ["1.5"]), "--to", form)
    assert bare.err == ""
    if form == "urdf":
        assert mass(ran.out) - mass(bare.out) == pytest.approx(1.25, abs=1e-9)
