"""The widths of texts in DejaVu Sans, a wide font: most others need less room.

Source: the advance widths of DejaVu Sans 2.37, Book and Bold, rounded up; letters beyond ASCII are
taken to be as wide as the widest letter of the tables.
"""

from __future__ import annotations

from collections.abc import Sequence

LINE = 1.25
"""The height of a line, in font sizes: more than from the top of Å to the foot of g."""
BASELINE = 0.36
"""The distance from the middle of a line down to its baseline, in font sizes."""
OTHER = 1.3
"""The width of a letter that is not in the tables, in font sizes."""
_FIRST = 32
# fmt: off
_BOOK = (
    318, 401, 460, 838, 637, 951, 780, 275, 391, 391, 500, 838, 318, 361, 318, 337,
    637, 637, 637, 637, 637, 637, 637, 637, 637, 637, 337, 337, 838, 838, 838, 531,
    1000, 685, 687, 699, 771, 632, 576, 775, 752, 295, 295, 656, 558, 863, 749, 788,
    604, 788, 695, 635, 611, 732, 685, 989, 686, 611, 686, 391, 337, 391, 838, 500,
    500, 613, 635, 550, 635, 616, 353, 635, 634, 278, 278, 580, 278, 975, 634, 612,
    635, 635, 412, 521, 393, 634, 592, 818, 592, 592, 525, 637, 337, 637, 838,
)
_BOLD = (
    349, 457, 521, 838, 696, 1002, 873, 307, 458, 458, 523, 838, 380, 416, 380, 366,
    696, 696, 696, 696, 696, 696, 696, 696, 696, 696, 400, 400, 838, 838, 838, 581,
    1000, 774, 763, 734, 831, 684, 684, 821, 837, 373, 373, 775, 638, 996, 837, 851,
    733, 851, 771, 721, 683, 813, 774, 1104, 771, 725, 726, 458, 366, 458, 838, 500,
    500, 675, 716, 593, 716, 679, 436, 716, 712, 343, 343, 666, 343, 1042, 712, 688,
    716, 716, 494, 596, 479, 712, 652, 924, 646, 652, 583, 712, 366, 712, 838,
)
# fmt: on


def text_width(says: str, size: float, *, bold: bool = False) -> float:
    """The width of a text on one line, in the unit of the font size."""
    table = _BOLD if bold else _BOOK
    places = (ord(letter) - _FIRST for letter in says)
    widths = (table[k] / 1000 if 0 <= k < len(table) else OTHER for k in places)
    return size * sum(widths)


def block_size(lines: Sequence[str], size: float, *, bold: bool = False) -> tuple[float, float]:
    """The width and height of lines of text below each other."""
    width = max((text_width(line, size, bold=bold) for line in lines), default=0.0)
    return width, LINE * size * len(lines)
