from numpy import bool_, float64, int32
from numpy.typing import NDArray

def coefficients(
    code: NDArray[int32],
    mid: NDArray[float64],
    rad: NDArray[float64],
    fixed: NDArray[bool_],
    first: int,
    last: int,
    smooth: int,
    /,
) -> int: ...
