"""Messages for what the parser rejects, in the terms of the language."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import nearest
from grammar_lang.parsing.clause_forms import BLOCK, FORMS, ITEMS, MEANT, OTHERS
from grammar_lang.parsing.habits import FOREIGN, habit_hint, meant_hint
from grammar_lang.parsing.lalr import TOO_DEEP
from grammar_lang.parsing.repair import Place, Repair, mended
from grammar_lang.parsing.tables import RESERVED, tables
from grammar_lang.parsing.tokens import BAD, KEYWORDS, SKIPPED, STRING, RawItem, Tokens
from grammar_lang.source import Span
from grammar_lang.units import UNIT_NAMES

MAX_SHOWN = 40
"""Longer tokens are shortened."""

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_OPERATORS = frozenset({"+", "-", "*", "/", "^"})
_EXPRESSION = frozenset({"NUMBER", "(", "-", "world", "this", "x", "y", "z", "NAME"})
_LOOKALIKES = {
    "\N{DEGREE SIGN}": "`deg`",
    "\N{MINUS SIGN}\N{EN DASH}\N{EM DASH}\N{HYPHEN}\N{NON-BREAKING HYPHEN}": "`-`",
    "\N{MULTIPLICATION SIGN}": "`x` between sides, `*` between numbers",
    "\N{MIDDLE DOT}\N{DOT OPERATOR}": "`*`",
    "\N{LEFT DOUBLE QUOTATION MARK}\N{RIGHT DOUBLE QUOTATION MARK}": '`"`',
    "\N{LEFT SINGLE QUOTATION MARK}\N{RIGHT SINGLE QUOTATION MARK}": "`'`",
    "\N{LESS-THAN OR EQUAL TO}": "`<=`",
    "\N{GREATER-THAN OR EQUAL TO}": "`>=`",
    "\N{RIGHTWARDS ARROW}": "`->`",
    "\N{SUPERSCRIPT TWO}": "`^2`",
    "\N{SUPERSCRIPT THREE}": "`^3`",
    "\N{GREEK SMALL LETTER PI}": "`pi`",
    "\N{MICRO SIGN}\N{GREEK SMALL LETTER MU}": "a power of ten, as in `5e-6 m`",
    "\N{NO-BREAK SPACE}\N{ZERO WIDTH SPACE}\N{ZERO WIDTH NO-BREAK SPACE}": "a plain blank",
    "&": "`and`",
    "!": "`not`",
    "~": "`not`",
}
_DESCRIBED = {
    "NAME": "a name",
    "NUMBER": "a number",
    "STRING": "a quoted string",
    "UNIT": "a unit",
    "EXPRESSION": "an expression",
    "$END": "the end",
}
_TOP = {
    **dict.fromkeys(("import", "use", "require", "using", "from"), "include"),
    **dict.fromkeys(("class", "struct", "part", "component", "link", "joint"), "module"),
    **dict.fromkeys(("robot", "rules"), "grammar"),
    **dict.fromkeys(("world", "scene", "environment"), "workspace"),
    **dict.fromkeys(("goal", "problem"), "task"),
}
_AFTER_NAME = frozenset({"(", ".", ":", "{"})
"""Tokens that follow the name at the start of a body, attribute, production or block."""
_NOUNS = {"module": "statement", "semantics": "statement"}


# --- Words and places of messages -----------------------------------------------------------------


def _quoted(name: str) -> str:
    return _DESCRIBED.get(name, f"`{name}`")


def _joined(shown: Sequence[str], last: str) -> str:
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} {last} {shown[-1]}"


def _wanted(expected: frozenset[str]) -> str:
    """``expected`` as a phrase; operators and the first tokens of an expression are summarised."""
    names = set(expected)
    if {"NUMBER", "(", "-"} <= names:
        names = (names - _EXPRESSION) | {"EXPRESSION"}
    names = names - _OPERATORS - {"UNIT"} or names
    shown = sorted(_quoted(n) for n in names)
    shown.sort(key=lambda name: (name[0] != "`", name))
    return _joined(shown, "or")


def _shortened(text: str) -> str:
    return text if len(text) <= MAX_SHOWN else f"{text[: MAX_SHOWN - 1]}…"


def _near(word: str, known: Iterable[str]) -> str | None:
    """The keyword that a word probably misspells; None if the word is itself reserved."""
    keywords = sorted(e for e in known if e not in _DESCRIBED and _WORD.fullmatch(e))
    fits = _WORD.fullmatch(word) and len(word) <= MAX_SHOWN and word not in RESERVED
    return nearest(word, keywords) if fits else None


def _after(tokens: Tokens, here: int) -> Span:
    """The place just after the previous token."""
    end = tokens.ends[here - 1]
    return Span(end, end + 1, tokens.file)


# --- Slips that are reported before the parser runs -----------------------------------------------


def slips(tokens: Tokens, sink: Sink, most: int) -> None:
    """Report comments that begin with ``#``, and numbers without a digit next to the point."""
    for span in tokens.slips[:most]:
        text = tokens.text[span.start : span.end]
        if text[0] == "#":
            include = text.startswith("#include")
            hint = 'write `include "FILE.srg";`' if include else "a comment begins with `//`"
            at = Span(span.start, span.start + 1, span.file)
            message = "unexpected character `#`: it does not begin a comment"
            sink.error(Code.UNEXPECTED_CHARACTER, message, at, hint)
        elif text[0] == ".":
            hint = f"write `0{_shortened(text)}`"
            sink.error(Code.SYNTAX, "a number begins with a digit", span, hint)
        else:
            hint = f"write `{_shortened(text)}0`"
            sink.error(Code.SYNTAX, "a number does not end with a point", span, hint)


# --- Tokens that do not fit -----------------------------------------------------------------------


def _character(tokens: Tokens, here: int, sink: Sink) -> None:
    character = tokens.at(here)
    meant = next((meant for like, meant in _LOOKALIKES.items() if character in like), None)
    hint = "remove it" if meant is None else f"write {meant}"
    if character in {"'", '"'}:
        hint = "a quoted string ends on its own line; there are no escapes: use the other quote"
    elif character.isalpha() and meant is None:
        hint = "names are made of the letters A to Z, digits and `_`"
    shown = f"`{character}`" if character.isprintable() else f"U+{ord(character):04X}"
    message = f"unexpected character {shown}"
    sink.error(Code.UNEXPECTED_CHARACTER, message, tokens.span(here), hint)


def _unfinished(tokens: Tokens, item: RawItem, expected: frozenset[str], sink: Sink) -> None:
    at = _after(tokens, item.stop)
    if item.braces:
        _never_closed(tokens, at, item.braces[-1], "{}", sink)
    elif ";" in expected:
        sink.error(Code.SYNTAX, "expected `;`", at, "add the `;`")
    else:
        wanted = _wanted(expected)
        sink.error(Code.SYNTAX, f"expected {wanted} after this", at, f"add {wanted}")


def _unknown_unit(tokens: Tokens, here: int, sink: Sink) -> None:
    word = _shortened(tokens.at(here))
    # `Nm` stands for a product; in `kgm` or `rads` a stroke may be missing instead.
    factors = word[:1], word[1:]
    product = factors[0].isupper() and all(factor in UNIT_NAMES for factor in factors)
    close = "*".join(factors) if product else nearest(word, UNIT_NAMES)
    known = f"the units are {' '.join(UNIT_NAMES)}, joined by `*`, `/` and `^`"
    hint = known if close is None else f"did you mean `{close}`? {known}"
    sink.error(Code.UNKNOWN_UNIT, f"unknown unit `{word}`", tokens.span(here), hint)


def _is_second_unit(tokens: Tokens, here: int) -> bool:
    same_line = not tokens.on_new_line(here)
    return same_line and tokens.kinds[here - 1] == "UNIT" and tokens.at(here) in UNIT_NAMES


def _second_unit(tokens: Tokens, here: int, sink: Sink) -> None:
    first, second = tokens.at(here - 1), tokens.at(here)
    hint = f"did you mean `{first}*{second}`? units are joined by `*` and `/`, without blanks"
    message, at = f"unknown unit `{first} {second}`", tokens.span(here - 1, here)
    sink.error(Code.UNKNOWN_UNIT, message, at, hint)


def _is_unknown_unit(tokens: Tokens, here: int, expected: frozenset[str]) -> bool:
    word = tokens.at(here)
    if _near(word, expected) is not None:
        return False
    if "UNIT" not in expected or not _WORD.fullmatch(word) or word in tables().words:
        return False
    return tokens.kinds[here - 1] in {"NUMBER", ")", "]", "}"} and not tokens.on_new_line(here)


def _opener(tokens: Tokens, here: int, first: int, pair: str) -> int | None:
    """The innermost bracket of a pair that is open at a token, from ``first`` on."""
    depth = 0
    for index in range(here - 1, first - 1, -1):
        depth += (tokens.at(index) == pair[0]) - (tokens.at(index) == pair[1])
        if depth > 0:
            return index
    return None


def _supplied(item: RawItem, tokens: Tokens, repair: Repair, sink: Sink) -> None:
    """Report a missing ``;`` or ``}`` just after the previous token."""
    at = _after(tokens, repair.here)
    if repair.missing == ";":
        sink.error(Code.SYNTAX, "expected `;`", at, "add the `;`")
    else:
        _never_closed(tokens, at, _opener(tokens, repair.here, item.first, "{}"), "{}", sink)


def _never_closed(tokens: Tokens, at: Span, opened: int | None, pair: str, sink: Sink) -> None:
    """Report that the closing bracket of a pair is missing."""
    notes = [] if opened is None else [(tokens.span(opened), "opened here")]
    message = f"expected `{pair[1]}`: a `{pair[0]}` is never closed"
    sink.error(Code.SYNTAX, message, at, f"add the missing `{pair[1]}`", notes)


def _mended(item: RawItem, place: Place, repair: Repair, sink: Sink) -> None:
    """Report a token that a repair mends."""
    tokens, here = place.tokens, place.here
    found = _shortened(tokens.at(here))
    new = repair.instead.get(here, repair.missing)
    written = mended(place, repair)
    code = Code.SYNTAX
    message, hint = f"expected `{new}`, found `{found}`", f"write `{new}`"
    if tokens.kinds[here] == BAD:
        code, message = Code.UNEXPECTED_CHARACTER, f"unexpected character `{found}`"
    elif new == SKIPPED:
        message = f"no `{found}` stands after `{_shortened(tokens.at(here - 1))}`"
        form = None if repair.whole else _form(item, place)
        hint = f"leave out the `{found}`" if form is None else f"write it as in `{form}`"
    if found in FOREIGN:
        hint = f"did you mean `{new}`?{_respelt(place, repair, new)}"
    elif written is not None and not repair.plain:
        hint = f"write `{written}`"
    sink.error(code, message, tokens.span(here), hint)


def _respelt(place: Place, repair: Repair, word: str) -> str:
    """What to write from a token on, to the end of its statement; empty if it is too long."""
    tokens, last = place.tokens, min(repair.stop, place.stop) - 1
    rest = " ".join(tokens.text[tokens.ends[place.here] : tokens.ends[last]].split())
    return f" write `{word} {rest}`" if len(rest) <= MAX_SHOWN else ""


def _form(item: RawItem, place: Place) -> str | None:
    """The form of the clause that a token does not fit into."""
    keyword = place.tokens.at(item.first)
    if len(place.opening) < 2:
        return ITEMS[keyword]
    return FORMS.get(keyword, {}).get(place.tokens.at(place.first))


def _begins(item: RawItem, place: Place) -> bool:
    """Whether the error is that no statement begins like this one."""
    tokens, first, block = place.tokens, place.first, place.tokens.at(item.first)
    if len(place.opening) < 2 or block not in FORMS:
        return False
    if place.here == first:
        return True
    if place.here > first + 1 or tokens.kinds[first] != "NAME" or not place.expected <= _AFTER_NAME:
        return False
    return block == "module" or _meant(block, tokens.at(first), FORMS[block]) is not None


def _meant(block: str, word: str, known: Iterable[str]) -> str | None:
    """The word meant at the start of a statement."""
    meant = MEANT[block].get(word)
    return _near(word, known) if meant is None else meant


def _beginning(item: RawItem, place: Place, sink: Sink) -> None:
    """Report a statement with an unknown beginning; the hint lists the known ones."""
    tokens, block = place.tokens, place.tokens.at(item.first)
    token = tokens.at(place.first)
    word, noun = _shortened(token), _NOUNS.get(block, "clause")
    known = sorted(FORMS[block])
    shown = [f"`{each}`" for each in known]
    hint = f"a {block} has {_joined(shown, 'and')}"
    if block in OTHERS:
        hint = f"a {block} has {', '.join(shown)}, {OTHERS[block]}"
    if block == "semantics" and not place.tables.accepts(place.opening, "let"):
        known, hint = [], f"a semantics has blocks, such as `{BLOCK}`"
    meant = _meant(block, token, known)
    elsewhere = next((other for other in FORMS if token in FORMS[other]), None)
    if meant is not None:
        hint = f"did you mean `{meant}`? {hint}"
    elif block == "module" and place.here > place.first and tokens.at(place.here) in {":", "="}:
        chosen = f"`param {word} in […];` where the synthesis chooses it"
        hint = f"write `const {word} = …;`, or {chosen}; {hint}"
    elif elsewhere is not None:
        hint = f"`{token}` stands in a {elsewhere}; {hint}"
    elif token in RESERVED:
        hint = f"`{token}` is reserved and cannot be a name; {hint}"
    message = f"no {noun} of a {block} begins with `{word}`"
    sink.error(Code.SYNTAX, message, tokens.span(place.first), hint)


def _unclosed(place: Place) -> int | None:
    """The ``(`` that is still open at the end of the statement."""
    tokens, here = place.tokens, place.here
    ends = tokens.at(here) in {";", "}"} or tokens.on_new_line(here)
    if ")" not in place.expected or not ends:
        return None
    return _opener(tokens, here, place.first, "()")


def _hint(item: RawItem, place: Place, wanted: str) -> str:
    """What to write instead of a token that no repair mends."""
    tokens, here, expected = place.tokens, place.here, place.expected
    word = tokens.at(here)
    close, form = _near(word, expected), _form(item, place)
    if word in RESERVED and "NAME" in expected:
        other = f", such as `p{word}`" if word in {"x", "y", "z"} else ""
        return f"`{word}` is reserved; choose another name{other}"
    meant = meant_hint(tokens, here, wanted) or (close and f"did you mean `{close}`?")
    if meant is not None:
        return meant
    if tokens.kinds[here] == STRING and _WORD.fullmatch(word[1:-1]):
        return f"write a name without quotes: `{_shortened(word[1:-1])}`"
    habit = habit_hint(tokens, here, wanted)
    if habit is not None:
        return habit
    if form is None or not any(each in form or each in _DESCRIBED for each in expected):
        return f"write {wanted} here"
    return f"write it as in `{form}`"


def _wrong(item: RawItem, place: Place, sink: Sink) -> None:
    """Report a token that does not fit and that no repair mends."""
    tokens, here = place.tokens, place.here
    opened = _unclosed(place)
    if opened is not None:
        _never_closed(tokens, _after(tokens, here), opened, "()", sink)
        return
    wanted = _wanted(place.expected)
    message = f"expected {wanted}, found `{_shortened(tokens.at(here))}`"
    hint = _hint(item, place, wanted)
    said = any((each.message, each.hint) == (message, hint) for each in sink.found)
    if not (said and tokens.at(here) in RESERVED and "NAME" in place.expected):
        sink.error(Code.SYNTAX, message, tokens.span(here), hint)


def explain(item: RawItem, place: Place, repair: Repair | None, sink: Sink) -> None:
    """Report the token of an item where one of the expected terminals should stand."""
    tokens, here, expected = place.tokens, place.here, place.expected
    if expected is TOO_DEEP:
        at = tokens.span(min(here, item.stop - 1))
        hint = "split it into constants or attributes"
        sink.error(Code.TOO_DEEP, "this is nested too deeply", at, hint)
    elif here >= item.stop:
        _unfinished(tokens, item, expected, sink)
    elif repair is not None and repair.supplied:
        _supplied(item, tokens, repair, sink)
    elif _is_second_unit(tokens, here):
        _second_unit(tokens, here, sink)
    elif _is_unknown_unit(tokens, here, expected):
        _unknown_unit(tokens, here, sink)
    elif repair is not None:
        _mended(item, place, repair, sink)
    elif tokens.kinds[here] == BAD:
        _character(tokens, here, sink)
    elif _begins(item, place):
        _beginning(item, place, sink)
    else:
        _wrong(item, place, sink)


def stray(tokens: Tokens, item: RawItem, sink: Sink) -> None:
    """Report tokens outside all items."""
    word = tokens.at(item.first)
    at = tokens.span(item.first)
    if tokens.kinds[item.first] == BAD:
        _character(tokens, item.first, sink)
        return
    shown = _joined([f"`{keyword}`" for keyword in sorted(KEYWORDS)], "or")
    meant = _TOP.get(word) or _near(word, KEYWORDS)
    hint = f"a declaration begins with {shown}"
    if word == "}":
        hint = "remove it: no `{` is open here"
    elif word == ";":
        hint = "remove it: no `;` stands after a `}`"
    elif meant is not None:
        hint = f"did you mean `{meant}`? {hint}"
    sink.error(Code.SYNTAX, f"no declaration begins with `{_shortened(word)}`", at, hint)
