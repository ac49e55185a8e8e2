"""Texts at the ends of the scale: a clear message or the right answer, and soon."""

from __future__ import annotations

from pathlib import Path

import pytest

from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.diagnostics.render import to_text
from grammar_lang.files.file_tree import LIMIT
from grammar_lang.load import load_text
from grammar_lang.parsing.parse import MAX_ERRORS
from srgc.cli import run
from srgc.session import Checked, check_file, check_loaded
from tests.oracles.small_specs import SLIDER, replaced
from tests.oracles.some_cases import examples, some
from tests.oracles.survival import format_survives, sound_findings, time_bound

DEEP = 10_000
MANY = examples(200_000, 1_000_000)


def const(value: str) -> str:
    return f"module M {{ role base; const c = {value}; }}"


def accept(condition: str) -> str:
    return f"module A {{ role base; }} grammar G {{ start N; a: N -> A; accept {condition}; }}"


def satisfy(formula: str) -> str:
    return f"task T {{ satisfy {formula}; }}"


def checked(text: str) -> Checked:
    """After all checks, within the time of the fuzz tests."""
    with time_bound():
        loaded = load_text(text, "t.srg")
        found = check_loaded(loaded)
        to_text(found.diagnostics, found.sources, most=200)
    assert (found.program is None) == bool(errors(found))
    return found


def errors(found: Checked) -> list[str]:
    return [d.code.value for d in found.diagnostics if d.severity is Severity.ERROR]


# --- nesting ------------------------------------------------------------------------------------

# Grouping alone makes nothing deeper, and so is read whatever its depth.
FLAT = {
    "parentheses": const("(" * DEEP + "1" + ")" * DEEP),
    "conditions in parentheses": accept("(" * DEEP + "contains A" + ")" * DEEP),
    "regular expressions in parentheses": accept("matches " + "(" * DEEP + "A" + ")" * DEEP),
    "alternatives": accept("matches " + "A|" * DEEP + "A"),
    "conjunctions": accept("contains A and " * DEEP + "contains A"),
}
DEPTHS = {
    "minus signs": const("-" * DEEP + "1"),
    "sums": const("1+" * DEEP + "1"),
    "sums in sums": const("1+(" * DEEP + "1" + ")" * DEEP),
    "products": const("2*" * DEEP + "1"),
    "powers": const("2^" * DEEP + "2"),
    "negative powers": const("2^-" * DEEP + "2"),
    "calls": const("sin(" * DEEP + "1" + ")" * DEEP),
    "tuples": const("(1," * DEEP + "1" + ")" * DEEP),
    "not": accept("not " * DEEP + "contains A"),
    "stars": accept("matches A" + "*" * DEEP),
    "not in formulas": satisfy("not " * DEEP + "A"),
    "always": satisfy("always " * DEEP + "A"),
    "last": satisfy("last[1 s] " * DEEP + "A"),
    "until": satisfy("A until " * DEEP + "A"),
    "implies": satisfy("A implies " * DEEP + "A"),
}
BROKEN = {
    "open parentheses": const("(" * DEEP),
    "closed parentheses": const(")" * DEEP),
    "brackets": const("[" * DEEP + "]" * DEEP),
    "braces": const("{" * DEEP + "}" * DEEP),
    "braces outside": "{" * DEEP + "}" * DEEP,
    "modules in modules": "module M {" * DEEP + "}" * DEEP,
    "blocks in blocks": "semantics G { a {" * DEEP + "}}" * DEEP,
}


@pytest.mark.parametrize("name", FLAT)
def test_grouping_has_no_depth(name: str) -> None:
    assert errors(checked(FLAT[name])) == []


@pytest.mark.parametrize("name", DEPTHS)
def test_deep_nesting_is_refused(name: str) -> None:
    """By that message alone: nobody is told what the broken statement might have said."""
    assert set(errors(checked(DEPTHS[name]))) == {"SRG0106"}


@pytest.mark.parametrize("name", BROKEN)
def test_deep_nesting_of_what_cannot_be_nested(name: str) -> None:
    found = errors(checked(BROKEN[name]))
    assert set(found) - {"SRG0202"} == {"SRG0104"}
    assert found.count("SRG0104") <= MAX_ERRORS


@pytest.mark.parametrize("name", some([*FLAT, *DEPTHS], 2))
def test_the_depth_that_is_allowed_is_formatted(name: str) -> None:
    text = {**FLAT, **DEPTHS}[name]
    with time_bound():
        format_survives(text)


# --- size ---------------------------------------------------------------------------------------


def test_ten_megabytes_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "large.srg"
    path.write_text("module M { role base; }\n" * (10 * 2**20 // 24), encoding="utf-8")
    with time_bound():
        found = check_file(path)
    assert errors(found) == ["SRG0110"]
    assert errors(checked(path.read_text(encoding="utf-8"))) == ["SRG0110"]


def test_includes_count_towards_the_limit(tmp_path: Path) -> None:
    half = b"// " + b"x" * (LIMIT // 2) + b"\n"
    for name in "ab":
        (tmp_path / f"{name}.srg").write_bytes(half)
    main = tmp_path / "main.srg"
    main.write_text('include "a.srg"; include "b.srg"; module M { role base; }', encoding="utf-8")
    with time_bound():
        assert errors(check_file(main)) == ["SRG0110"]


@pytest.mark.slow
def test_a_line_of_a_megabyte() -> None:
    names = ", ".join(f"e{i}" for i in range(120_000))
    assert errors(checked(f"module M {{ role base; }} edge {names};")) == []


LONG = {
    "a name": (f"module {'a' * MANY} {{ role base; }}", []),
    "an unknown name": (const("a" * MANY), ["SRG0201"]),
    "an unknown unit": (const(f"1 m^{'9' * MANY}"), ["SRG0302"]),
    "digits": (const("1" * MANY), ["SRG0307"]),
    "decimals": (const("0." + "1" * MANY), ["SRG0307"]),
    "an exponent": (const("1e" + "9" * MANY), ["SRG0307"]),
    "a large exponent": (const("1e999999999"), ["SRG0307"]),
    "a power": (const("9^9^9^9"), ["SRG0307"]),
    "a string": (f"edge '{'a' * MANY}';", []),
    "an open string": (f"edge '{'a' * MANY}", ["SRG0103"]),
    "an open comment": ("module M { /*" + "*" * MANY, ["SRG0104"]),
    "comments": ("/* */" * (MANY // 5) + "// end", ["SRG0105"]),
    "blanks": (" \n" * (MANY // 2), ["SRG0105"]),
}


@pytest.mark.parametrize("name", LONG)
def test_long_tokens(name: str) -> None:
    text, codes = LONG[name]
    found = checked(text)
    assert errors(found) == codes
    assert all(len(d.message) < 2 * MANY for d in found.diagnostics)


@pytest.mark.parametrize("piece", [";", "{", "}", "@"])
def test_very_many_of_one_sign_are_one_error(piece: str) -> None:
    assert len(errors(checked(piece * (MANY // len(piece))))) == 1


@pytest.mark.parametrize("piece", [";", "{", "("])
def test_very_many_of_one_sign_in_a_module(piece: str) -> None:
    found = errors(checked(f"module M {{ {piece * (MANY // len(piece))} }}"))
    assert 1 <= len(found) <= MAX_ERRORS


# --- many findings ------------------------------------------------------------------------------


def many(count: int, form: str) -> str:
    return "".join(form.format(i) for i in range(count))


CROWDS = {
    "declared twice": ("module M { role base; }\n" + many(4_000, "edge M;\n"), "SRG0202"),
    "edges twice": ("edge e;" + "edge e;" * 4_000, "SRG0202"),
    "parameters twice": (
        "module M { role base; " + "param a in [0, 1];" * 4_001 + "}",
        "SRG0202",
    ),
    "unknown symbols": (
        many(5_000, "module Mod{} {{ role base; }}\n")
        + "grammar G { start N; "
        + many(5_000, "l{0}: N -> Moc{0};")
        + "}",
        "SRG0201",
    ),
    "unknown constants": (
        "module M { role base; "
        + many(3_000, "const value{} = 1;")
        + many(3_000, "const c{0} = walue{0};")
        + "}",
        "SRG0201",
    ),
    "unknown blocks": (
        "module A { role base; } grammar G { start N; "
        + many(3_000, "label{}: N -> A;")
        + "} semantics G { "
        + many(3_000, "labil{} {{ }}")
        + "}",
        "SRG0201",
    ),
    "repeated clauses": (
        "task T { " + "horizon 1 steps of 1 s;" * 4_001 + "}",
        "SRG0702",
    ),
}


@pytest.mark.parametrize("name", CROWDS)
def test_every_one_of_many_findings_is_reported(name: str) -> None:
    text, code = CROWDS[name]
    assert errors(checked(text)).count(code) >= 3_000


def test_tens_of_thousands_of_duplicates() -> None:
    count = examples(30_000, 100_000)
    assert errors(checked("edge " + "a, " * count + "a;")) == ["SRG0202"] * count


# --- chains -------------------------------------------------------------------------------------


@pytest.mark.parametrize("backwards", some([True, False], 1))
def test_long_chains_of_attributes(backwards: bool) -> None:
    order = range(3_000, 0, -1) if backwards else range(1, 3_001)
    rules = "".join(f"this.a{i} = this.a{i - 1};" for i in order)
    text = (
        "module A { role base; } grammar G { start N; a: N -> A; } "
        f"semantics G {{ a {{ {rules} this.a0 = 1 m; }} }}"
    )
    assert errors(checked(text)) == []
    circle = text.replace("this.a0 = 1 m;", "this.a0 = this.a3000 + 1 m;")
    assert errors(checked(circle)) == ["SRG0504"]


def test_long_chains_of_constants_and_nonterminals() -> None:
    constants = "const c0 = 1;" + "".join(f"const c{i} = c{i - 1};" for i in range(1, 3_000))
    chain = "".join(f"l{i}: N{i} -> A N{i + 1};" for i in range(3_000))
    text = (
        f"module A {{ role base; {constants} }} grammar G {{ start N0; {chain} last: N3000 -> A; }}"
    )
    assert errors(checked(text)) == []


def test_counting_conditions_of_any_bound() -> None:
    for bound in (10, 100, 1_000, 10**5, 10**9):
        checked(
            "module A { role base; } edge o, c; "
            "grammar G { start N; a: N -> A; b: N -> o N c N; "
            f"accept length <= {bound}; accept count(A) < {bound}; }}"
        )


# --- files --------------------------------------------------------------------------------------

MODULE = b"module M { role base; }\n"


@pytest.mark.parametrize(
    ("data", "codes"),
    [
        (b"", ["SRG0105"]),
        (b"\xef\xbb\xbf" + MODULE, []),
        (b"\xef\xbb\xbf\xef\xbb\xbf" + MODULE, ["SRG0103"]),
        (MODULE.replace(b" ", b"\r\n"), []),
        (MODULE.replace(b" ", b"\r"), []),
        (b"\r\n" + MODULE.replace(b"\n", b"\r\n"), []),
        (MODULE + b"\0", ["SRG0103"]),
        (b"\0" * 10, ["SRG0103"]),
        ("module M { role base; }".encode("utf-16"), ["SRG0102"]),
        ("module M { role base; }".encode("utf-16-le"), ["SRG0103"]),
        (b"\xff" + MODULE, ["SRG0102"]),
        (MODULE + b"\xff", ["SRG0102"]),
        (MODULE + b"// \xe4\n", ["SRG0102"]),
        (MODULE + b"// \xc3", ["SRG0102"]),
        (MODULE + b"// \xed\xa0\x80\n", ["SRG0102"]),
        (MODULE + b"// \xf0\x9f\xa4\x96 \xc3\xa4\n", []),
        (b"edge '\xc3\xa4\xf0\x9f\xa4\x96';\n" + MODULE, []),
        (b"module \xc3\xa4 { role base; }\n", ["SRG0103"]),
        (MODULE + b"/* never closed", ["SRG0104"]),
        (MODULE + b"edge 'never closed;\n", ["SRG0103"]),
        (MODULE + b"edge 'a\nb';\n", ["SRG0103"]),
    ],
)
def test_bytes_that_are_no_plain_text(data: bytes, codes: list[str], tmp_path: Path) -> None:
    path = tmp_path / "t.srg"
    path.write_bytes(data)
    found = check_file(path)
    assert errors(found) == codes
    sound_findings(found.program, found.diagnostics, found.sources)


def test_an_include_that_comes_back(tmp_path: Path) -> None:
    for i in range(300):
        text = f'include "f{(i + 1) % 300}.srg";\n'
        (tmp_path / f"f{i}.srg").write_text(text, encoding="utf-8")
    with time_bound():
        found = check_file(tmp_path / "f0.srg")
    assert errors(found) == ["SRG0107"]


@pytest.mark.parametrize("path", ["../outside.srg", "/etc/passwd", "a/../../outside.srg"])
def test_an_include_that_climbs_out(path: str, tmp_path: Path) -> None:
    (tmp_path / "outside.srg").write_bytes(MODULE)
    (tmp_path / "inside" / "a").mkdir(parents=True)
    main = tmp_path / "inside" / "main.srg"
    main.write_text(f'include "{path}";', encoding="utf-8")
    assert errors(check_file(main)) == ["SRG0108"]


# --- numbers that cannot be computed with ---------------------------------------------------------


@pytest.mark.parametrize(
    "changed",
    [
        ("effort <= 10 N;", "effort <= 1e-200 N;"),
        ("effort <= 10 N;", "effort <= 1e160 N;"),
        ("horizon 10 steps of 0.2 s;", "horizon 10 steps of 1e250 s;"),
        ("bounds box [-1, 4] x [-1, 1] m;", "bounds box [-1, 1e200] x [-1, 1] m;"),
    ],
)
def test_numbers_whose_squares_are_no_doubles(changed: tuple[str, str]) -> None:
    assert errors(checked(replaced(SLIDER, *changed))) == ["SRG0307"]


def test_a_horizon_of_too_many_steps() -> None:
    text = replaced(SLIDER, "horizon 10 steps", "horizon 1e200 steps")
    assert errors(checked(text)) == ["SRG0703"]


def test_a_search_whose_numbers_overflow_knows_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def overflowing(*_: object, **__: object) -> object:
        raise OverflowError("too large")

    monkeypatch.setattr("solvers.search.path_search.PathSearch.attempt", overflowing)
    path = tmp_path / "slider.srg"
    path.write_text(SLIDER, encoding="utf-8")
    assert run(["synth", str(path), "-q", "-o", str(tmp_path / "out")]) == 4
    assert "too large or too small for the search" in capfd.readouterr().out
