"""What many jobs have in common, pickled once and taken out once per process."""

from __future__ import annotations

import pickle
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from typing import Generic, TypeVar, cast

Content = TypeVar("Content")
Made = TypeVar("Made")

KEPT = 8
"""So many of the things made of parcels are kept, those used last."""

_made: OrderedDict[tuple[str, str], object] = OrderedDict()


@dataclass(frozen=True, slots=True)
class SharedPayload(Generic[Content]):
    """A pickled value, named by the digest of its bytes."""

    digest: str
    data: bytes


def packed(content: Content) -> SharedPayload[Content]:
    """A value as a parcel."""
    data = pickle.dumps(content, protocol=pickle.HIGHEST_PROTOCOL)
    return SharedPayload(sha256(data).hexdigest(), data)


def made_of(parcel: SharedPayload[Content], make: Callable[[Content], Made]) -> Made:
    """What a function of a module makes of the content; kept for the next job with this parcel."""
    name = parcel.digest, f"{make.__module__}.{make.__qualname__}"
    if name not in _made:
        keep(parcel, make, make(cast("Content", pickle.loads(parcel.data))))  # noqa: S301 (our own)
    _made.move_to_end(name)
    return cast("Made", _made[name])


def keep(parcel: SharedPayload[Content], make: Callable[[Content], Made], made: Made) -> None:
    """Say what a function makes of a parcel, where that is there already."""
    _made[parcel.digest, f"{make.__module__}.{make.__qualname__}"] = made
    while len(_made) > KEPT:
        _made.popitem(last=False)
