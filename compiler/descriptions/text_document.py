"""Documents as plain text."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.descriptions.document import Entry, Equation, Fact, Item, Pieces, Remark, Section

WIDTH = 96
INDENT = "  "


def to_text(sections: Sequence[Section]) -> str:
    """Sections with underlined titles, columns aligned, long sums broken before an operator."""
    return "\n".join("\n".join(_section(section)) + "\n" for section in sections)


def _section(section: Section) -> list[str]:
    lines = [section.title, "-" * len(section.title)]
    names = [item.name for item in section.items if isinstance(item, Fact)]
    names += [item.symbol[0] for item in section.items if isinstance(item, Entry)]
    meanings = [item.meaning for item in section.items if isinstance(item, Entry)]
    widths = max(map(len, names), default=0), max(map(len, meanings), default=0)
    for item in section.items:
        lines += _item(item, *widths)
    return lines


def _item(item: Item, first: int, second: int) -> list[str]:
    match item:
        case Remark(text):
            return [text]
        case Fact(name, text):
            return [f"{name:<{first}}  {text}"]
        case Entry((symbol, _), meaning, bounds):
            return [f"{symbol:<{first}}  {meaning:<{second}}  {bounds}".rstrip()]
        case Equation((left, _), (right, _)):
            return _broken(left, right)


def _broken(left: str, right: Pieces) -> list[str]:
    """An equation in lines of at most ``WIDTH`` characters where its summands allow it."""
    lines = [f"{left} ="]
    for number, (negative, text) in enumerate(right):
        sign = ("-" if negative else "") if number == 0 else ("- " if negative else "+ ")
        if number and len(lines[-1]) + len(sign) + len(text) + 1 > WIDTH:
            lines.append(INDENT * 2 + sign + text)
        else:
            lines[-1] += f" {sign}{text}"
    return lines
