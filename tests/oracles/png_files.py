"""PNG images by their definition, of all kinds, and such images spoilt at random.

Source: W3C, *Portable Network Graphics (PNG) Specification (Third Edition)*, sections 5 and 8.1.
"""

from __future__ import annotations

import random
import struct
import zlib
from collections.abc import Sequence

SIGNATURE = b"\x89PNG\r\n\x1a\n"
SAMPLES = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
KINDS = [(d, c) for c, depths in ((0, (1, 2, 4, 8, 16)), (2, (8,)), (3, (1, 2, 4, 8)), (4, (8,)),
                                  (6, (8,))) for d in depths]  # fmt: skip
"""Bits of a sample and type of colours of the images that are read."""
NAMES = (
    b"IHDR", b"PLTE", b"IDAT", b"IEND", b"tRNS", b"acTL", b"fcTL", b"fdAT", b"tEXt", b"zTXt",
    b"iTXt", b"iCCP", b"eXIf", b"gAMA", b"cHRM", b"sRGB", b"pHYs", b"sBIT", b"IDOT",
)  # fmt: skip

Chunk = tuple[bytes, bytes]


def ihdr(width: int, height: int, depth: int = 8, colours: int = 0, interlace: int = 0) -> Chunk:
    data = struct.pack(">IIBBBBB", width, height, depth, colours, 0, 0, interlace)
    return b"IHDR", data


def png_of(chunks: Sequence[Chunk]) -> bytes:
    """A file of these chunks, with their checksums."""
    parts = [SIGNATURE]
    for kind, data in chunks:
        check = zlib.crc32(kind + data)
        parts += [struct.pack(">I", len(data)), kind, data, struct.pack(">I", check)]
    return b"".join(parts)


def passes(width: int, height: int, interlace: int) -> list[tuple[int, int]]:
    """Columns and rows of each pass."""
    if not interlace:
        return [(width, height)]
    steps = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2)]
    steps.append((0, 1, 1, 2))
    return [
        ((width - x + across - 1) // across, (height - y + down - 1) // down)
        for x, y, across, down in steps
    ]


def rows(
    chance: random.Random, width: int, height: int, depth: int, colours: int, interlace: int
) -> bytes:
    """Random pixels, each row without a filter."""
    bits = depth * SAMPLES[colours]
    parts: list[bytes] = []
    for columns, lines in passes(width, height, interlace):
        if columns:
            size = (columns * bits + 7) // 8
            parts += [b"\0" + chance.randbytes(size) for _ in range(lines)]
    return b"".join(parts)


def sound_chunks(chance: random.Random) -> list[Chunk]:
    """The chunks of a random sound image, with others that say nothing about its pixels."""
    depth, colours = chance.choice(KINDS)
    width, height = chance.randint(1, 20), chance.randint(1, 20)
    interlace = chance.randint(0, 1)
    chunks = [ihdr(width, height, depth, colours, interlace)]
    if colours == 3:
        chunks.append((b"PLTE", chance.randbytes(3 * 2**depth)))
    if chance.random() < 0.3 and colours in {0, 2, 3}:
        size = {0: 2, 2: 6, 3: chance.randint(1, 2**depth)}[colours]
        chunks.append((b"tRNS", chance.randbytes(size)))
    if chance.random() < 0.3:
        chunks.append((b"tEXt", b"Title\0a map"))
    data = zlib.compress(rows(chance, width, height, depth, colours, interlace))
    cut = chance.randint(0, len(data))
    return [*chunks, (b"IDAT", data[:cut]), (b"IDAT", data[cut:]), (b"IEND", b"")]


def spoilt_png(chance: random.Random) -> bytes:
    """An image spoilt in its chunks, what is packed in them, its checksums or its bytes."""
    chunks = sound_chunks(chance)
    for _ in range(chance.randint(1, 3)):
        place = chance.randrange(len(chunks))
        kind, data = chunks[place]
        match chance.randrange(8):
            case 0:
                chunks.insert(chance.randint(0, len(chunks)), chunks[place])
            case 1 if len(chunks) > 1:
                del chunks[place]
            case 2:
                chance.shuffle(chunks)
            case 3:
                made = chance.choice(NAMES), chance.randbytes(chance.randint(0, 40))
                chunks.insert(chance.randint(0, len(chunks)), made)
            case 4:
                other = ihdr(chance.choice((1, 30, 2**16, 2**31)), chance.choice((1, 2**16)))
                chunks.insert(chance.randint(0, len(chunks)), other)
            case 5 if kind == b"IDAT":
                chunks[place] = kind, zlib.compress(chance.randbytes(chance.randint(0, 2000)))
            case 6:
                chunks[place] = chance.choice(NAMES), data
            case _:
                chunks[place] = kind, spoilt(chance, data)
    data = png_of(chunks)
    return spoilt(chance, data) if chance.random() < 0.2 else data


def spoilt(chance: random.Random, data: bytes) -> bytes:
    """Bytes of which some are others, missing or new."""
    made = bytearray(data)
    for _ in range(chance.randint(1, 3)):
        place = chance.randint(0, len(made))
        match chance.randrange(4):
            case 0:
                del made[place:]
            case 1:
                made[place:place] = chance.randbytes(chance.randint(1, 9))
            case 2:
                del made[place : place + chance.randint(1, 9)]
            case _:
                made[place : place + 1] = chance.choice((b"\0", b"\xff", chance.randbytes(1)))
    return bytes(made)
