"""Make names of the language from the free names of other formats."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

from grammar_lang.elaboration.modules import LONGEST_NAME
from grammar_lang.parsing.tables import RESERVED

LONGEST = 60
"""The most characters of a name; longer ones are cut."""
_OTHERS = re.compile(r"[^A-Za-z0-9_]+")
_SINGLE = dict(
    zip(
        "абвгдезиклмнопрстуфыэєіґ" + "αβγδεζηικλμνξοπρσςτυφω" + "øłđðıħ",
        "abvgdeziklmnoprstufyeeig" + "avgdeziiklmnxoprsstyfo" + "olddih",
        strict=True,
    )
)
_SEVERAL = {
    "ж": "zh", "х": "kh", "ц": "ts", "ч": "ch", "ш": "sh", "щ": "shch", "ъ": "", "ь": "",
    "ю": "yu", "я": "ya", "θ": "th", "χ": "ch", "ψ": "ps", "ß": "ss", "æ": "ae", "œ": "oe",
    "þ": "th",
}  # fmt: skip
_LATIN = _SINGLE | _SEVERAL
"""Maps Cyrillic, Greek and other letters without accents to Latin ones."""


class Names:
    """Gives each thing a unique name; a name that is taken gets a number.

    With ``ignore_case`` names that differ only in case are equal, like names of files on some
    disks.
    """

    def __init__(self, taken: Iterable[str] = (), *, ignore_case: bool = False) -> None:
        self.ignore_case = ignore_case
        self.given = set(map(self._key, taken))

    def name(self, wanted: str, otherwise: str = "part") -> str:
        """A unique name close to the one wanted, valid in the language; see :func:`legible`."""
        plain = legible(wanted, otherwise)
        if not plain or plain[0].isdigit() or plain in RESERVED:
            plain = f"_{plain}"
        found, number = plain, 2
        while self._key(found) in self.given:
            found, number = f"{plain}_{number}", number + 1
        self.take(found)
        return found

    def take(self, name: str) -> None:
        """Reserve a name."""
        self.given.add(self._key(name))

    def camel(self, wanted: str, otherwise: str = "Part") -> str:
        """A unique name with a capital for each word, as modules have: ``UpperArm``."""
        words = legible(wanted, otherwise).split("_")
        return self.name("".join(word[:1].upper() + word[1:] for word in words))

    def _key(self, name: str) -> str:
        return name.lower() if self.ignore_case else name


def legible(text: str, otherwise: str) -> str:
    """A text reduced to the characters of names, with ``_`` for others, cut at :data:`LONGEST`.

    Letters of other alphabets become Latin ones where there is a usual transliteration.  If no
    letter is left, ``otherwise`` is used: the joint ``関節1`` becomes ``joint_1``.
    """
    plain = _OTHERS.sub("_", _latin(text)).strip("_")[:LONGEST].rstrip("_")
    if any(map(str.isalpha, plain)) or not any(map(str.isalpha, text)):
        return plain
    return f"{otherwise}_{plain}" if plain else otherwise


def in_quotes(text: str) -> str:
    """A name as a text of the language; empty if it cannot be one."""
    if not 0 < len(text) <= LONGEST_NAME or not text.isprintable() or text.strip() != text:
        return ""
    if '"' not in text:
        return f'"{text}"'
    return "" if "'" in text else f"'{text}'"


def is_legible(text: str) -> bool:
    """Whether a text can be recognised in the name that was made from it."""
    return text.isascii() and len(text) <= LONGEST


def _latin(text: str) -> str:
    """The text without accents, with Latin letters for those in the table."""
    found = list[str]()
    for each in unicodedata.normalize("NFKD", text):
        if unicodedata.combining(each):
            continue
        small = _LATIN.get(each.lower())
        if small is None:
            found.append(each)
        else:
            found.append(small if each == each.lower() else small.capitalize())
    return "".join(found)
