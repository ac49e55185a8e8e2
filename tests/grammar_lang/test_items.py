from __future__ import annotations

from grammar_lang.parsing.tokens import cut, tokenise, unclosed_comment


def pieces(text: str) -> list[str]:
    tokens = tokenise(text)
    spans = [tokens.span(item.first, item.stop - 1) for item in cut(tokens)]
    return [text[span.start : span.end] for span in spans]


def test_items_end_with_their_brace_or_semicolon() -> None:
    text = "module A { role base; }  // }\nedge e, '}'; /* { */ task T { }"
    assert pieces(text) == ["module A { role base; }", "edge e, '}';", "task T { }"]


def test_a_missing_brace_does_not_swallow_the_next_item() -> None:
    text = "module A { role base;\ngrammar G { start N; }\nedge e;"
    assert pieces(text) == ["module A { role base;", "grammar G { start N; }", "edge e;"]


def test_keywords_as_names_start_no_item() -> None:
    text = "grammar task { module: N -> B; } semantics task { module { } }"
    assert pieces(text) == ["grammar task { module: N -> B; }", "semantics task { module { } }"]
    text = "workspace W { obstacle task polytope { x <= 1 }; }"
    assert pieces(text) == [text]


def test_unclosed_comment() -> None:
    assert unclosed_comment(tokenise("a /* b */ c // /* d")) is None
    found = unclosed_comment(tokenise("a /* b */ /* c"))
    assert found is not None
    assert found.start == 10
