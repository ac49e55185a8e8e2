"""Read numbers as files of other tools mean them."""

from __future__ import annotations


def plain_index(word: str) -> int:
    """The integer in a text, spelt as :func:`plain_number` takes it.

    Raises:
        ValueError: the text is not an integer.
    """
    if "_" in word or not word.isascii():
        raise ValueError(f"{word} is not an integer")
    return int(word)


def plain_number(word: str) -> float:
    """The number in a text; unlike ``float`` it takes neither `1_0` nor digits of other scripts.

    Raises:
        ValueError: the text is not a number.
    """
    if "_" in word or not word.isascii():
        raise ValueError(f"{word} is not a number")
    return float(word)
