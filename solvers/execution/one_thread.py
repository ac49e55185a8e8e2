"""Libraries with threads of their own use one: processes together use all cores.

Matrices are small here, and sums by several threads may depend on how many those are.
"""

from __future__ import annotations

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment variables, to be set before the libraries are loaded."""
