"""Which pixels of a map are obstacles: all that are not free for certain.

Source: the ROS wiki, map_server, section 1.3 (value interpretation).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from compiler.maps.grey_image import GreyImage
from compiler.maps.map_header import MapHeader

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def obstacles(image: GreyImage, header: MapHeader) -> NDArray[np.bool_]:
    """Whether each pixel is occupied or unknown, by row (the top one first) and column.

    The occupancy of a pixel of brightness v is p = (w - v) / w, or v / w if ``negate``, where w is
    white.  It is free iff p is below ``free`` (which is at most ``occupied``), and, in the modes
    that give a transparent pixel no value, opaque.  Raw values are used as they are, in negative
    if so asked: only 0 is free then.
    """
    white = image.white
    if header.mode == "raw":
        free = image.values == (white if header.negate else 0)
    elif header.negate:
        free = image.values < math.ceil(header.free * white)
    else:
        free = image.values > math.floor((1 - header.free) * white)
    if image.opaque is not None:
        free &= image.opaque
    found: NDArray[np.bool_] = ~free
    return found
