from __future__ import annotations

import json
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar_lang import ir
from solvers.verifier.claims.certificate import (
    CertificateError,
    FoundClaim,
    ImpossibleClaim,
    ParameterClaim,
    SeparationClaim,
    cut_claim,
    exact,
    exact_cuts,
    from_text,
    spec_digest,
    spec_files,
    to_text,
)
from solvers.verifier.claims.structure_claims import StructureClaim
from tests.oracles import result_files
from tests.oracles.some_cases import examples

FOUND = FoundClaim(
    "Do", "größe.srg", "ab" * 32, ("B", "eps", "L"), ("link", "base"),
    (ParameterClaim(2, "length", "1.5"),), 0, 2, "1/8", ("0.1", "0"), (("1.25",), ("-3",)),
    (("S", "free.1", "T"),), "3", "7", ((2, ("1/3", "-1"), "0.5"),),
)  # fmt: skip
IMPOSSIBLE = ImpossibleClaim(
    "Do", "a.srg", "cd" * 32, 4,
    (
        StructureClaim(("B",), ("base",), "proofs/0000.smt2", None),
        StructureClaim(("B", "eps", "B"), ("x", "base"), "proofs/0000.smt2", 0),
    ),
)  # fmt: skip


CUT_OFF = ImpossibleClaim(
    "Do", "a.srg", "cd" * 32, None, (),
    SeparationClaim(2, "S", "T", ("Wall",), ("S", "free.1")),
)  # fmt: skip


@pytest.mark.parametrize("claim", [FOUND, IMPOSSIBLE, CUT_OFF])
def test_written_and_read(claim):
    assert from_text(to_text(claim)) == claim
    content = json.loads(to_text(claim))
    assert content["digest"] == result_files.digest(content)
    assert content["format"] == 3


def _read(text):
    """What is read; None where it is refused."""
    try:
        return from_text(text)
    except CertificateError:
        return None


@pytest.mark.parametrize("claim", [FOUND, IMPOSSIBLE, CUT_OFF])
def test_any_field_altered_added_or_removed(claim):
    content = json.loads(to_text(claim))
    for key in content:
        for other in (None, 3, "x", [], {}, True, [[]], [{}], [None], -1, 1.5):
            changed = content | {key: other}
            if changed == content:
                continue
            with pytest.raises(CertificateError, match="altered"):
                from_text(json.dumps(changed))
            if key == "digest":
                continue
            changed["digest"] = result_files.digest(changed)
            assert _read(json.dumps(changed)) != claim
        less = {name: value for name, value in content.items() if name != key}
        less["digest"] = result_files.digest(less)
        if key != "digest":
            with pytest.raises(CertificateError):
                from_text(json.dumps(less))
    more = content | {"extra": 1}
    more["digest"] = result_files.digest(more)
    with pytest.raises(CertificateError, match="`extra` is unknown"):
        from_text(json.dumps(more))


@pytest.mark.parametrize(
    "cut",
    [None, 3, [], [0, ["1"]], [0, ["1", "2"], "3", 4], ["0", ["1", "2"], "3"], [0, [1, 2], "3"],
     [0, "12", "3"], [0, ["1", "2"], 3], [True, ["1", "2"], "3"]],
)  # fmt: skip
def test_a_cut_that_is_none(cut):
    content = json.loads(to_text(FOUND)) | {"cuts": [cut]}
    content["digest"] = result_files.digest(content)
    with pytest.raises(CertificateError, match="malformed"):
        from_text(json.dumps(content))


def test_cuts_are_exact():
    half_space = ir.HalfSpace((Fraction(1, 3), Fraction(-5, 4)), Fraction(2, 7))
    claimed = cut_claim(4, half_space)
    assert claimed == (4, ("1/3", "-5/4"), "2/7")
    assert exact_cuts([claimed, (0, ("0.25", "1"), "-3")]) == (
        (4, half_space),
        (0, ir.HalfSpace((Fraction(1, 4), Fraction(1)), Fraction(-3))),
    )
    with pytest.raises(CertificateError, match="malformed"):
        exact_cuts([(0, ("1e5", "1"), "1")])


@pytest.mark.parametrize(
    "change",
    [{"effector": "2"}, {"effector": True}, {"source": None}, {"avoided": "Wall"},
     {"cells": [1]}, {"more": 1}],
)  # fmt: skip
def test_a_separation_that_is_none(change):
    content = json.loads(to_text(CUT_OFF))
    content["separation"] |= change
    content["digest"] = result_files.digest(content)
    with pytest.raises(CertificateError, match="malformed"):
        from_text(json.dumps(content))


def test_a_repeated_key_is_refused():
    text = to_text(FOUND)
    with pytest.raises(CertificateError, match="repeated"):
        from_text(text.replace('"steps": 2,', '"steps": 3, "steps": 2,'))


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3)
    ),
    max_leaves=8,
)


@settings(max_examples=examples(15, 100))
@given(JSON)
def test_any_other_json_is_refused(value):
    with pytest.raises(CertificateError):
        from_text(json.dumps(value))


@given(st.text(max_size=60))
def test_any_text_is_refused(text):
    with pytest.raises(CertificateError):
        from_text(text)


@pytest.mark.parametrize(
    "text",
    ["", "nan", "inf", "1e5", "1E999999999", "1_0", "\u0661", " 1", "1 ", "+1", ".5", "5.", "1/0",
     "--1", "0x1", "1/2/3", "1/-2", "1.5/2", "1" + "0" * 300, "9" * 5000, "0." + "1" * 5000],
)  # fmt: skip
def test_numbers_that_are_none(text):
    with pytest.raises(CertificateError, match="malformed"):
        exact(text)


@pytest.mark.parametrize(("text", "value"), [("10/81", (10, 81)), ("-0.250", (-1, 4)), ("7", (7,))])
def test_numbers(text, value):
    assert exact(text) == Fraction(*value)


def test_the_digest_of_a_spec(tmp_path):
    files = {"b.srg": b"1", "a/c.srg": b"22"}
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(content)
    assert spec_files(tmp_path) == files
    assert spec_digest(files) == result_files.spec_digest(files)
    # The border between name and content, and between files, is part of it.
    assert spec_digest({"ab": b"c"}) != spec_digest({"a": b"bc"})
    assert spec_digest({"a": b"", "b": b""}) != spec_digest({"a": b"b"})
