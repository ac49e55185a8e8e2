"""The formatter: turn a text into its canonical form.

The result is parsed again.  Unless it has the same abstract syntax, the same tokens and the same
comments between the same tokens, it is not returned: a formatter must never change a specification.
"""

from __future__ import annotations

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.comments import Written, written
from grammar_lang.formatting.layout import lay_out
from grammar_lang.parsing.parse import parse_tokens, without_collection
from grammar_lang.syntax.tasks import File


class NotFaithful(Exception):
    """The canonical text does not mean what the original means: a fault of the formatter."""

    def __init__(self, what: str) -> None:
        super().__init__(f"the canonical form has {what}")


def _read(text: str, sink: Sink) -> tuple[File, Written]:
    file, tokens = parse_tokens(text, sink)
    return file, written(tokens)


def _comments(text: Written) -> list[tuple[str, ...]]:
    return [tuple(comment.text for comment in gap.comments) for gap in text.gaps]


def _compare(before: tuple[File, Written], after: tuple[File, Written]) -> None:
    if before[1].texts != after[1].texts or before[1].kinds != after[1].kinds:
        raise NotFaithful("other tokens than the text")
    if _comments(before[1]) != _comments(after[1]):
        raise NotFaithful("other comments than the text")
    if before[0] != after[0]:
        raise NotFaithful("other syntax than the text")


@without_collection
def canonical(text: str, sink: Sink) -> str | None:
    """The canonical form of a text, or None if it has syntax errors; takes linear time.

    Args:
        text: the text, without byte order mark.
        sink: collects the errors.

    Raises:
        NotFaithful: the formatter is at fault.
    """
    before = _read(text, sink)
    if sink.has_errors:
        return None
    made = lay_out(before[1])
    if made != text:
        again = Sink()
        after = _read(made, again)
        if again.has_errors:
            raise NotFaithful("syntax errors")
        _compare(before, after)
    return made
