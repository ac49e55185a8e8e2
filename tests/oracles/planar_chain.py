r"""The n-link planar chain of uniform rods in absolute angles, written out by hand.

.. math:: T = \tfrac12 \sum_{ij} C_{ij} \cos(\phi_i - \phi_j) \dot\phi_i \dot\phi_j, \qquad
    C_{ij} = l_i l_j \sum_{k > \max(i,j)} m_k + [i \ne j]\, m_{\max} l_i l_j / 2
    + [i = j]\, m_i l_i^2 / 3,

so that the Coriolis forces are sum_j C_ij sin(phi_i - phi_j) phi'_j^2; transformed to relative
angles by phi = T q with T lower triangular of ones.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compiler.arrays import Array


def coefficients(lengths: Array, masses: Array) -> Array:
    n = len(lengths)
    c = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            beyond = float(np.sum(masses[max(i, j) + 1 :]))
            c[i, j] = lengths[i] * lengths[j] * beyond
            if i == j:
                c[i, j] += masses[i] * lengths[i] ** 2 / 3
            else:
                c[i, j] += masses[max(i, j)] * lengths[i] * lengths[j] / 2
    return c


def chain_dynamics(
    lengths: Array, densities: Array, q: Array, v: Array, pull: Sequence[float]
) -> tuple[Array, Array, Array]:
    """M, c and g in relative angles; ``pull`` is the acceleration of gravity (gx, gy)."""
    masses = lengths * densities
    c = coefficients(lengths, masses)
    to_absolute = np.tril(np.ones((len(q), len(q))))
    phi, rate = to_absolute @ q, to_absolute @ v
    difference = phi[:, None] - phi[None, :]
    mass = c * np.cos(difference)
    coriolis = (c * np.sin(difference)) @ rate**2
    moments = np.array(
        [lengths[i] * (masses[i] / 2 + masses[i + 1 :].sum()) for i in range(len(q))]
    )
    gravity = -moments * (-np.sin(phi) * pull[0] + np.cos(phi) * pull[1])
    back = to_absolute.T
    return back @ mass @ to_absolute, back @ coriolis, back @ gravity


def chain_energy(
    lengths: Array, densities: Array, q: Array, v: Array, pull: Sequence[float]
) -> float:
    """Kinetic plus potential energy."""
    mass, _, _ = chain_dynamics(lengths, densities, q, v, pull)
    phi = np.cumsum(q)
    potential, base = 0.0, np.zeros(2)
    for length, density, angle in zip(lengths, densities, phi, strict=True):
        direction = np.array([np.cos(angle), np.sin(angle)])
        potential -= length * density * float(np.asarray(pull) @ (base + direction * length / 2))
        base = base + direction * length
    return float(v @ mass @ v / 2) + potential
