r"""The linearisation of a robot about samples (Eqn. 5), and its exact discretisation.

.. math:: \dot x \approx f_0 + F\,\delta x + G\,\delta u + H\,\delta\theta, \qquad
    x^+ = x + \Phi f_0 + e^{F\,\Delta t}\,\delta x + \Phi G\,\delta u + \Phi H\,\delta\theta, \quad
    \Phi = \int_0^{\Delta t} e^{F s}\,\mathrm ds

The affine map is exact for the linearised system with u held, so it only needs F, G and H at the
beginning of a step. The step map of the search (``NumericRobot.step``) is different: it follows the
*nonlinear* flow, and its Jacobians are those of that flow along the path of the step. Over a step
of length h, values differ by O(h^3) and Jacobians by O(h^2), while the step map differs from the
flow by O(h^5): this is why the search uses it (docs/decisions/0021-linearisation.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, factorial

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.discretisation.batched_function import BatchedFunction
from compiler.discretisation.numeric_robot import Linearisation, NumericRobot
from compiler.dynamics.controlled_system import ControlledSystem


@dataclass(frozen=True, slots=True)
class AffineSystem:
    """The linearisation about K samples x (K, N).

    Shapes: drift f0 (K, N), state F (K, N, N), input G (K, N, m), parameter H (K, N, p).
    """

    about: Array
    drift: Array
    state: Array
    input: Array
    parameter: Array

    def discretised(self, dt: float) -> Linearisation:
        """The zero-order hold over ``dt`` seconds: value and Jacobians of the affine map."""
        inputs = self.input.shape[2]
        forcing = np.concatenate([self.drift[:, :, None], self.input, self.parameter], axis=2)
        state, forced = held(self.state, forcing, dt)
        value, by_input, by_parameter = np.split(forced, [1, 1 + inputs], axis=2)
        return Linearisation(self.about + value[:, :, 0], state, by_input, by_parameter)


def linearise(numeric: NumericRobot, x: Array, u: Array, theta: Array) -> AffineSystem:
    """The controlled system about K states (K, N) and inputs (K, m) at parameters (p,)."""
    n, size, m = numeric.n, numeric.size, numeric.m
    rates, slopes = numeric.acceleration(x, u, theta)
    jacobian = np.zeros((len(x), size, size + m + numeric.p))
    jacobian[:, :n, n : 2 * n] = np.eye(n)
    jacobian[:, n:, :] = slopes
    state, by_input, by_parameter = np.split(jacobian, [size, size + m], axis=2)
    drift = np.concatenate([x[:, n : 2 * n], rates], axis=1)
    return AffineSystem(x, drift, state, by_input, by_parameter)


@dataclass(frozen=True, slots=True)
class SecondOrderForm:
    r"""The rigid bodies about K samples in the paper's form, where T are the generalised forces.

    .. math:: M\,\delta\ddot q + C\,\delta\dot q + K\,\delta q + H\,\delta\theta = T - F

    Shapes: mass M, damping C, stiffness K (K, n, n), bias F (K, n), parameter H (K, n, p).
    """

    mass: Array
    damping: Array
    stiffness: Array
    bias: Array
    parameter: Array


def second_order_form(
    system: ControlledSystem, q: Array, v: Array, a: Array, theta: Array
) -> SecondOrderForm:
    """The form about nominal coordinates, rates and accelerations (K, n), at parameters (p,)."""
    n, f = system.coordinates, system.inertial
    symbols = [ca.SX.sym(f"i{i}", f.size1_in(i)) for i in range(f.n_in())]
    *motion, parameters, k = symbols
    value = f(*symbols)
    slopes = ca.jacobian(value, ca.vertcat(*reversed(motion), parameters))
    both = ca.cse(ca.densify(ca.horzcat(value, slopes)))
    form = BatchedFunction.of(ca.Function("form", [*motion, ca.vertcat(parameters, k)], [both]))
    found = form((q, v, a), np.concatenate([theta, system.constants]))
    bias, mass, damping, stiffness, parameter = np.split(
        found, [1, 1 + n, 1 + 2 * n, 1 + 3 * n], axis=2
    )
    return SecondOrderForm(mass, damping, stiffness, bias[:, :, 0], parameter)


DEGREE = 13
LARGEST_NORM = 5.371920351148152
"""Up to this norm the approximant of degree 13 is exact in doubles (Higham 2005, Table 2.3)."""

PADE = tuple(comb(DEGREE, j) * factorial(2 * DEGREE - j) for j in range(DEGREE + 1))
"""Coefficients of the numerator of the diagonal approximant, up to a common factor."""


def matrix_exponential(matrices: Array) -> Array:
    """The exponentials of K matrices (K, n, n) by scaling, Pade and squaring (Higham 2005)."""
    norms = np.abs(matrices).sum(axis=1).max(axis=1, initial=0.0)
    squarings = np.ceil(np.log2(np.maximum(norms / LARGEST_NORM, 1.0))).astype(int)
    scaled = matrices * (0.5**squarings)[:, None, None]
    coefficients = [c / PADE[0] for c in PADE]
    square, identity = scaled @ scaled, np.eye(matrices.shape[1])
    # Even and odd parts by Horner's rule in the square.
    even, odd = coefficients[-2] * identity, coefficients[-1] * identity
    for j in range(DEGREE - 3, -1, -2):
        even = square @ even + coefficients[j] * identity
        odd = square @ odd + coefficients[j + 1] * identity
    odd = scaled @ odd
    result = np.linalg.solve(even - odd, even + odd)
    for done in range(int(squarings.max(initial=0))):
        more = squarings > done
        result[more] = result[more] @ result[more]
    return np.asarray(result)


def held(state: Array, forcing: Array, time: float) -> tuple[Array, Array]:
    r"""The flow of ``x' = F x + G w`` over a time, with w held.

    .. math:: \exp \begin{pmatrix} F & G \\ 0 & 0 \end{pmatrix} t
        = \begin{pmatrix} e^{F t} & \int_0^t e^{F s} \mathrm ds\, G \\ 0 & 1 \end{pmatrix}

    Args:
        state: F, shape (K, N, N), 1/s.
        forcing: G, shape (K, N, c).
        time: t, s.

    Returns:
        e^(F t), shape (K, N, N), and the integral times G, shape (K, N, c) (Van Loan 1978).
    """
    count, size, width = forcing.shape
    augmented = np.zeros((count, size + width, size + width))
    augmented[:, :size, :size] = state * time
    augmented[:, :size, size:] = forcing * time
    exponential = matrix_exponential(augmented)
    return exponential[:, :size, :size], exponential[:, :size, size:]
