r"""How far, how fast and to what energy drives can bring a robot in a time.

Let s' = sqrt(q' M q'), the speed in the kinetic metric, so that s'^2 / 2 is the kinetic energy, and
E = s'^2 / 2 + V.  The forces on the joints are u - b q' with b >= 0.  From dE/dt = q'(u - b q'),

.. math:: s' s'' \le \dot q^\top (u - g) \le s' \lVert u - g \rVert_{M^{-1}}, \qquad
    \dot E \le s' \lVert u \rVert_{M^{-1}} \le \sqrt{2 (E - V_{\min})}\, \lVert u \rVert_{M^{-1}}

so with a >= ||u - g||, p >= ||u|| on the whole motion, and e = E - Vmin,

.. math:: s'(t) \le s'(0) + a t, \qquad \sqrt{2 e(t)} \le \sqrt{2 e(0)} + p t.

Where the joints' rates have bounds r, dE/dt is at most the power P = max of |u| . r too.

(Both quantities are Lipschitz; where one is zero, apply the bound to sqrt(x^2 + d^2) and let d go
to 0.)  Without friction the same holds backwards from the end, where the speed or the energy is
known.  The kinetic length of the motion, the integral of s', is at most that of either bound, as
s'^2 <= 2 e.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb


@dataclass(frozen=True, slots=True)
class Ramp:
    """A quantity x >= 0 on [0, T] whose size changes by at most ``growth`` per second.

    It is at most ``first`` at the start, and at most ``last`` at the end if that is known and the
    bound on the growth holds backwards too.
    """

    first: arb
    growth: arb
    last: arb | None = None

    def _turn(self, time: arb) -> arb:
        """About when the bounds from both ends meet; any time is right, exactly that is best."""
        if self.last is None:
            return time
        if not self.growth > 0:
            return time if self.first <= self.last else arb(0)
        meeting = ((self.last - self.first) / self.growth + time) / 2
        return meeting.mid().max(arb(0)).min(time)

    def highest(self, time: arb) -> arb:
        """An upper bound of x on [0, ``time``]."""
        one = self.first + self.growth * time
        if self.last is None:
            return one.upper()
        both = (self.first + self.last + self.growth * time) / 2
        return one.min(self.last + self.growth * time).min(both).upper()

    def integral(self, time: arb) -> arb:
        """An upper bound of the integral of x over [0, ``time``]."""
        turn = self._turn(time)
        area = self.first * turn + self.growth * turn * turn / 2
        if self.last is not None:
            rest = time - turn
            area += self.last * rest + self.growth * rest * rest / 2
        return area.upper()


@dataclass(frozen=True, slots=True)
class Budget:
    """Upper bounds on a motion: kinetic length, kinetic speed, and total energy E."""

    length: arb
    speed: arb
    energy: arb


@dataclass(frozen=True, slots=True)
class RateBounds:
    """What rate limits of all joints add: the largest s' at such rates, and the power P."""

    speed: arb
    power: arb


def budget(
    speed: Ramp, energy: Ramp, lowest: arb, time: arb, rates: RateBounds | None = None
) -> Budget:
    """What is left to a motion.

    Args:
        speed: s', that is sqrt(2 (E - V)).
        energy: sqrt(2 (E - Vmin)).
        lowest: a lower bound of V on the motion.
        time: T, in seconds.
        rates: None where some joint has no rate limits.
    """
    top = energy.highest(time)
    fastest = speed.highest(time)
    if rates is not None:
        last = None if energy.last is None else energy.last**2 / 2
        work = Ramp(energy.first**2 / 2, rates.power, last)
        top = top.min((2 * work.highest(time)).sqrt()).upper()
        fastest = fastest.min(rates.speed)
    fastest = fastest.min(top)
    length = speed.integral(time).min(energy.integral(time)).min(fastest * time)
    return Budget(length.upper(), fastest.upper(), (lowest + top * top / 2).upper())
