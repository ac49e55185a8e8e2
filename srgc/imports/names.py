"""Names of the language for what other formats call as they like."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

from grammar_lang.parsing.tables import RESERVED

LONGEST = 60
"""Names are cut after so many characters."""
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
"""Cyrillic, Greek and other letters in Latin ones, without their accents."""


class Names:
    """Gives each thing a name of its own; one that is wanted again gets a number.

    With ``ignore_case`` names that differ only in case are the same, as those of files are on some
    disks.
    """

    def __init__(self, taken: Iterable[str] = (), *, ignore_case: bool = False) -> None:
        self.ignore_case = ignore_case
        self.given = set(map(self._key, taken))

    def name(self, wanted: str, otherwise: str = "part") -> str:
        """The name, changed as little as the language demands; see :func:`legible`."""
        plain = legible(wanted, otherwise)
        if not plain or plain[0].isdigit() or plain in RESERVED:
            plain = f"_{plain}"
        found, number = plain, 2
        while self._key(found) in self.given:
            found, number = f"{plain}_{number}", number + 1
        self.take(found)
        return found

    def take(self, name: str) -> None:
        """Give a name to nothing else."""
        self.given.add(self._key(name))

    def camel(self, wanted: str, otherwise: str = "Part") -> str:
        """The name with a capital for each word, as modules have it: ``UpperArm``."""
        words = legible(wanted, otherwise).split("_")
        return self.name("".join(word[:1].upper() + word[1:] for word in words))

    def _key(self, name: str) -> str:
        return name.lower() if self.ignore_case else name


def legible(text: str, otherwise: str) -> str:
    """A text in the characters of names, ``_`` for others, of at most :data:`LONGEST`.

    Letters of other alphabets become Latin ones where that is usual.  Where no letter is left,
    ``otherwise`` says what it is: the joint ``関節1`` is ``joint_1``.
    """
    plain = _OTHERS.sub("_", _latin(text)).strip("_")[:LONGEST].rstrip("_")
    if any(map(str.isalpha, plain)) or not any(map(str.isalpha, text)):
        return plain
    return f"{otherwise}_{plain}" if plain else otherwise


def is_legible(text: str) -> bool:
    """Whether a text can be told from the name that was made of it."""
    return text.isascii() and len(text) <= LONGEST


def _latin(text: str) -> str:
    """Letters without accents, and in Latin ones where the table has them."""
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
