"""Limit libraries with threads of their own to one: the processes together use all cores.

Matrices are small here, and sums by several threads may depend on the number of threads.
"""

from __future__ import annotations

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment variables, to be set before the libraries are loaded."""
