"""URDF as others write it: names that meet, limits that are none, what is not carried over."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import srgc
from srgc.faults import UsageFault
from srgc.imports.urdf.urdf_import import urdf_import
from tests.oracles.urdf_files import LIMIT, joint, link, robot


def imported(tmp_path: Path, *parts: str, **options):
    file = tmp_path / "r.urdf"
    file.write_text(robot(*parts))
    return urdf_import(file, **options)


def words(text: str) -> list[str]:
    program = srgc.load(text=text)
    return [" ".join(word) if not isinstance(word, str) else word
            for word in srgc.words(program, limit=3)]  # fmt: skip


CHAINS = {
    "a joint called like its link": (
        [("a", "wrist", "wrist_joint"), ("wrist", "tip", "tip")], 4,
    ),
    "joints that differ in signs": ([("a", "b", "arm.1"), ("b", "c", "arm-1")], 4),
    "joints that differ in case": ([("a", "b", "J"), ("b", "c", "j")], 4),
}  # fmt: skip


@pytest.mark.parametrize("name", CHAINS)
def test_a_robot_is_one_word_with_all_its_modules(name: str, tmp_path: Path) -> None:
    """A base, a module for each joint, and a tip."""
    chain, count = CHAINS[name]
    links = [link("a"), *(link(child) for _, child, _ in chain)]
    joints = [
        joint("revolute", LIMIT, name=called, parent=parent, child=child)
        for parent, child, called in chain
    ]
    (word,) = words(imported(tmp_path, *links, *joints).text)
    assert len(word.split()) == count
    assert len(set(word.split())) == count


def test_two_tips_have_types_of_their_own(tmp_path: Path) -> None:
    parts = [link("a"), link("b"), link("c"), joint("revolute", LIMIT, child="b"),
             joint("revolute", LIMIT, name="k", child="c"),
             link("hand.x"), link("hand_x"),
             joint("fixed", name="m", parent="b", child="hand.x"),
             joint("fixed", name="n", parent="c", child="hand_x")]  # fmt: skip
    found = imported(tmp_path, *parts, effectors=["hand.x", "hand_x"])
    assert len(words(found.text)) == 1


RANGE = '<limit lower="{}" upper="{}" effort="5" velocity="2"/>'
WRONG = {
    "no number": (RANGE.format("nan", 1), "`lower` is `nan`, which is not finite"),
    "no rate": ('<limit lower="-1" upper="1" effort="5" velocity="nan"/>', "`velocity` is `nan`"),
    "a rate below 0": ('<limit lower="-1" upper="1" effort="5" velocity="-1"/>', "velocity -1"),
    "an effort below 0": ('<limit lower="-1" upper="1" effort="-3" velocity="1"/>', "effort -3"),
}


@pytest.mark.parametrize("name", WRONG)
def test_limits_that_are_none_are_refused(name: str, tmp_path: Path) -> None:
    limit, says = WRONG[name]
    with pytest.raises(UsageFault, match=re.escape(says)):
        imported(tmp_path, link("a"), link("b"), joint("revolute", limit))


def test_infinity_is_no_limit(tmp_path: Path) -> None:
    limit = '<limit lower="-inf" upper="inf" effort="inf" velocity="inf"/>'
    found = imported(tmp_path, link("a"), link("b"), joint("revolute", limit))
    assert re.search(r"dof q: revolute \S+ named \S+;", found.text)


def test_what_is_not_carried_over_is_told(tmp_path: Path) -> None:
    inertial = '<inertial><mass value="0"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'  # noqa: E501
    seen = '<visual><geometry><box size="1 1 1"/></geometry></visual>'
    found = imported(
        tmp_path, link("a", more=seen), f'<link name="b">{inertial}</link>', link("c"),
        joint("revolute", LIMIT), joint("revolute", LIMIT, name="k", parent="b", child="c"),
        joint("revolute", LIMIT + '<mimic joint="j" offset="5"/>', name="m", parent="c", child="d"),
        link("d"),
        '<transmission name="both"><joint name="j"/><joint name="k"/></transmission>',
        '<transmission name="other"><joint name="nobody"/></transmission>',
    )  # fmt: skip
    told = "\n".join([*found.remarks, *(warning.message for warning in found.warnings)])
    assert "link `b` has moments of inertia and no mass: they are left out" in told
    assert "pictures that are no meshes: `a`" in told
    assert "transmission `both` is not the gear of one joint" in told
    assert "transmission `other` is left out: there is no joint `nobody`" in told
    assert "held at 5 rad, outside of its range from -1 to 1.5" in told


def test_a_chain_that_is_closed_is_refused(tmp_path: Path) -> None:
    loop = '<loop_joint name="l" type="revolute"><link1 link="a"/><link2 link="b"/></loop_joint>'
    with pytest.raises(UsageFault, match="closes a chain"):
        imported(tmp_path, link("a"), link("b"), joint("revolute", LIMIT), loop)


def test_a_module_with_a_link_called_in(tmp_path: Path) -> None:
    found = imported(
        tmp_path, link("a"), link("b"), joint("revolute", LIMIT), '<link name="in"/>',
        '<link name="tool"/>', joint("fixed", name="k", parent="b", child="in"),
        joint("fixed", name="l", parent="b", child="tool"), module=True,
    )  # fmt: skip
    checked = srgc.check(text=found.text)
    assert [each for each in checked if each.severity.value == "error"] == []
    assert len(re.findall(r"port in:", found.text)) == 1


def test_a_module_of_fixed_links(tmp_path: Path) -> None:
    found = imported(tmp_path, link("a"), link("b"), joint("fixed"), module=True)
    checked = srgc.check(text=found.text)
    assert [each for each in checked if each.severity.value == "error"] == []


OPTIONS = {
    "a word of the language": ({"module": True, "ports": ["x=b:F"]}, "`x` is a word"),
    "ports of a robot": ({"ports": ["out=b:F"]}, "--port goes with --module"),
    "effectors of a module": ({"module": True, "effectors": ["b"]}, "--effector does not go"),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_options_that_say_nothing_are_refused(name: str, tmp_path: Path) -> None:
    options, says = OPTIONS[name]
    with pytest.raises(UsageFault, match=says):
        imported(tmp_path, link("a"), link("b"), joint("revolute", LIMIT), **options)
