"""What random drives do bring a robot to is never said to be out of their reach."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
import pytest

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import closed_ball, constant_ball
from tests.oracles.driven_chains import Segment, answers, problem, robot_of, spot
from tests.oracles.some_cases import examples

STEPS, FINE = 8, 40
FREE = {"revolute": "", "prismatic": "in [-4, 4] m"}
LIMITS = {"revolute": "in [-4, 4]", "prismatic": "in [-4, 4] m"}
DRAG = {"revolute": "0.2 N*m*s/rad", "prismatic": "0.2 N*s/m"}


def random_arm(rng, dimension, joints, *, wheels=True):
    """Joints and rods in all directions, half of the turning ones without limits.

    With ``wheels``, some joints have rotors, from light to very heavy.
    """
    segments = []
    for _ in range(joints):
        kind = "prismatic" if rng.random() < 0.3 else "revolute"
        plane = "x" if kind == "prismatic" else "z"
        limits = rng.choice([FREE, LIMITS])[kind]
        own = f"torque(q) = u - {DRAG[kind]} * rate(q);" if rng.random() < 0.3 else ""
        if wheels and not own and rng.random() < 0.4:
            gear = f"{rng.choice([1, 20])}{'' if kind == 'revolute' else ' m^-1'}"
            own = f"drive q: gear {gear} rotor {rng.choice([0.001, 0.2, 50])} kg*m^2;"
        segments.append(
            Segment(
                round(rng.uniform(0.3, 1.2), 2),
                rng.choice("xyz") if dimension == 3 else plane,
                rng.choice("xyz"[:dimension]),
                kind,
                limits,
                own,
                round(rng.uniform(0.5, 3), 1),
            )
        )
    return segments


def flow(graph, q, v, inputs, seconds):
    """Coordinates and rates, each (steps, n), of a motion by the classical Runge-Kutta method.

    None: it leaves the limits, or the equations have no value.
    """
    constants = [float(constant_ball(item)) for item in graph.constants]

    def slope(q, v, u):
        return v, np.array(graph.acceleration(q, v, u, [], constants)).ravel()

    h, course = seconds / FINE, [(q, v)]
    for u in inputs:
        for _ in range(FINE):
            one = slope(q, v, u)
            if not np.isfinite(one[1]).all():
                return None  # a rod turns about its own axis, without any inertia
            two = slope(q + h / 2 * one[0], v + h / 2 * one[1], u)
            three = slope(q + h / 2 * two[0], v + h / 2 * two[1], u)
            four = slope(q + h * three[0], v + h * three[1], u)
            q = q + h / 6 * (one[0] + 2 * two[0] + 2 * three[0] + four[0])
            v = v + h / 6 * (one[1] + 2 * two[1] + 2 * three[1] + four[1])
            limited = [abs(x) for x, dof in zip(q, graph.model.dofs, strict=True) if dof.range]
            if max(limited, default=0) > 4:
                return None
            course.append((q, v))
    return [np.array(each) for each in zip(*course, strict=True)]


def driven_to(seed, excess):
    """A problem whose goal a motion gets to, with inputs that exceed their bounds by a factor.

    None where the motion leaves the ranges of the joints.
    """
    rng = random.Random(seed)
    dimension, joints = rng.choice([2, 2, 3]), rng.choice([1, 2, 2, 3])
    segments = random_arm(rng, dimension, joints, wheels=excess == 1)
    effort, seconds = round(rng.uniform(0.5, 20), 3), round(rng.uniform(0.02, 0.2), 4)
    rates = rng.choice([0, 0, 1])
    pull = ("(1, -9.81)" if dimension == 2 else "(0, 1, -9.81)") if rng.random() < 0.5 else ""
    gravity = f"gravity {pull} m/s^2;" if pull else ""
    kinds = {segment.kind for segment in segments}
    efforts = f"effort <= {effort} N*m;" if "revolute" in kinds else ""
    efforts += f"effort <= {effort} N;" if "prismatic" in kinds else ""
    load = f"payload {rng.choice([0.2, 5])} kg;" if excess == 1 and rng.random() < 0.3 else ""
    rest = f"{efforts} {gravity} {load} horizon {STEPS} steps of {seconds} s;"
    nowhere = spot([0.0] * dimension)
    model, _, task = robot_of(
        problem(segments, nowhere, f"start in A; reach T; {rest}", start=nowhere)
    )
    graph, n = robot_graph(model, task.gravity), len(model.dofs)
    q = np.round([rng.uniform(-1.5, 1.5) for _ in range(n)], 9)
    v = np.array([rng.uniform(-rates, rates) for _ in range(n)])
    first = [excess * effort * rng.choice([-1, 1]) for _ in range(n)]
    signs = [rng.choice([1, 1, -1]) for _ in range(STEPS)]
    inputs = [[sign * x for x in first] for sign in signs]
    found = flow(graph, q, v, inputs, seconds)
    constants = [float(constant_ball(item)) for item in graph.constants]

    def tip(q):
        return np.array(graph.effectors(q, [], constants)).ravel()[:dimension]

    if found is None or not n:
        return None
    reach, last = "reach T;", 1
    if excess == 1 and rng.random() < 0.6:
        last = rng.choice([1, FINE // 4, 2 * FINE])
        slow = np.abs(found[1][-last:]).max() * 1.0001 + 1e-6
        hold = f" for {(last - 1) * seconds / FINE:.9f} s" if last > 1 else ""
        reach = f"reach T rates <= {slow:.9f}{hold};"
    tips = np.array([tip(each) for each in found[0][-last:]])
    middle, size = (tips.max(axis=0) + tips.min(axis=0)) / 2, np.ptp(tips, axis=0).max() / 2
    if not np.abs(middle).max() + size < 29:
        return None
    start = f"start in A rates <= {rates};" if rates else f"start at ({', '.join(map(str, q))});"
    target = spot(middle, size + 1e-3)
    text = problem(segments, target, f"{start} {reach} {rest}", start=spot(tip(q)))
    return text, [4, 3, 1][:n] if n > 1 else [7]


def refuted(seeds, excess):
    """How many of the problems are refuted, and how many there are.

    Nothing is asked where the effector starts at its goal.
    """
    made = [found for seed in seeds if (found := driven_to(seed, excess)) is not None]
    found = [[bound for row in answers(*case) for bound in row] for case in made]
    return sum(any(bound is not None for bound in bounds) for bounds in found), len(made)


def test_what_was_reached_is_not_refuted():
    wrong, tried = refuted(range(examples(6, 9)), 1)
    assert wrong == 0
    assert tried >= 5


def test_what_takes_thirty_times_the_effort_is_refuted_now_and_then():
    right, _ = refuted(range(examples(6, 12)), 30)
    assert right >= 2


@pytest.mark.slow
def test_what_was_reached_is_not_refuted_at_large():
    wrong, tried = refuted(range(100, 260), 1)
    assert wrong == 0
    assert tried >= 90


def moved_to(seed, excess):
    """A problem with limits of rates and accelerations whose goal a motion gets to, and stays at.

    Every joint moves from rest to rest, some as far as its limits allow in the time before the stay
    times ``excess``; drives are strong enough for anything.
    """
    rng = random.Random(seed)
    dimension, joints = rng.choice([2, 2, 3]), rng.choice([1, 1, 1, 2, 3])
    segments = []
    for each in random_arm(rng, dimension, joints, wheels=False):
        unit = "rad" if each.kind == "revolute" else "m"
        limits = f"in [-2.6, 2.6] {unit} rate in [-{rng.choice([0.5, 1, 2])}, 1.5] {unit}/s"
        limits += f" accel <= {rng.choice([2, 8])} {unit}/s^2" if rng.random() < 0.5 else ""
        segments.append(replace(each, limits=limits, own=""))
    step, moving, resting = 0.05, rng.choice([6, 10]), rng.choice([0, 1, 7])
    before = 0 if resting == 7 else rng.random() * 0.05
    hold = f" for {resting * step + before:.6f} s" if resting or before else ""
    steps = moving + resting + (before > 0)
    units = {"revolute": "N*m", "prismatic": "N"}
    strong = (f"effort <= 1e6 {units[kind]};" for kind in sorted({s.kind for s in segments}))
    horizon = f"horizon {rng.choice(['', 'at most '])}{steps} steps of {step} s; {' '.join(strong)}"
    nowhere = spot([0.0] * dimension)
    model, _, task = robot_of(
        problem(segments, nowhere, f"start in A; reach T; {horizon}", start=nowhere)
    )
    graph, n = robot_graph(model, task.gravity), len(model.dofs)
    if not n or len(model.word_dofs) != n:
        return None  # a start pose has a value for each joint of the word
    seconds = steps * step - resting * step - before
    ways = []
    for dof in model.dofs:
        low, high = (float(closed_ball(end).mid()) for end in (dof.rate.lower, dof.rate.upper))
        # Without a limit of the acceleration, a jump of the rate is as good as reached.
        accel = np.inf if dof.accel is None else float(closed_ball(dof.accel).mid())
        sign = rng.choice([-1, 1])
        rate = min(-low if sign < 0 else high, accel * seconds / 2)
        ways.append(sign * rng.choice([0, 0.999, 0.999]) * rate * (seconds - rate / accel))
    constants = [float(constant_ball(item)) for item in graph.constants]
    q = np.round([rng.uniform(-1.5, 1.5) for _ in range(n)], 9)
    way = excess * np.array(ways)
    tip = np.array(graph.effectors(q + way, [], constants)).ravel()[:dimension]
    clauses = f"start at ({', '.join(map(str, q))}); reach T at rest{hold}; {horizon}"
    return problem(segments, spot(tip), clauses), [4, 3, 1][:n] if n > 1 else [7]


def limited(seeds, excess):
    """How many of the problems with limits are refuted, and how many there are."""
    made = [found for seed in seeds if (found := moved_to(seed, excess)) is not None]
    found = [[bound for row in answers(*case) for bound in row] for case in made]
    return sum(any(bound is not None for bound in bounds) for bounds in found), len(made)


def test_a_stay_that_limits_allow_is_not_refuted():
    wrong, tried = limited(range(examples(5, 16)), 1)
    assert wrong == 0
    assert tried >= 4


def test_a_stay_a_fifth_too_far_away_is_refuted_now_and_then():
    right, _ = limited(range(examples(5, 16)), 1.2)
    assert right >= 2


@pytest.mark.slow
def test_a_stay_that_limits_allow_is_not_refuted_at_large():
    wrong, tried = limited(range(100, 260), 1)
    assert wrong == 0
    assert tried >= 130
