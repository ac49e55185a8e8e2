"""Names of packages, against the parser of ROS."""

from __future__ import annotations

import re

from catkin_pkg.package import parse_package_string
from hypothesis import example, given
from hypothesis import strategies as st

from srgc.exports.ros.package_name import package_name


@given(st.text())
@example("Pick")
@example("HTTPServer")
@example("3 arms")
@example("__")
@example("Ärm")
def test_every_name_of_a_task_makes_one_of_a_package(text: str) -> None:
    """REP 144: lower case, digits and single underscores, a letter first."""
    name = package_name(text)
    assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)+", name)
    manifest = (
        f'<package format="3"><name>{name}</name><version>0.0.0</version><description>d'
        '</description><maintainer email="a@b.org">m</maintainer><license>l</license></package>'
    )
    warnings: list[str] = []
    assert parse_package_string(manifest, warnings=warnings).name == name
    assert warnings == []


def test_names_of_packages_are_readable() -> None:
    names = ["PickIt", "Pick_and_Place", "pick2", "42", "Öl"]
    assert [package_name(name) for name in names] == [
        "pick_it_robot", "pick_and_place_robot", "pick2_robot", "task_42_robot", "l_robot",
    ]  # fmt: skip
