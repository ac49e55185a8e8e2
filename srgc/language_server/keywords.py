"""A one-line explanation of every keyword, by the kind of item in which it occurs."""

from __future__ import annotations

from types import MappingProxyType

_TOP = {
    "module": "`module NAME { … }`: a kind of part: its role, parameters and degrees of freedom.",
    "edge": "`edge eps, '[';`: labels of connections; symbols of words beside the modules.",
    "grammar": "`grammar NAME { … }`: which words of modules and edges are robots.",
    "semantics": "`semantics GRAMMAR { … }`: what every production adds to the robot.",
    "workspace": "`workspace NAME { … }`: bounds, regions, obstacles and targets.",
    "task": "`task NAME { … }`: which robots are to do what, where and in what time.",
    "mission": "`mission NAME { … }`: several tasks, for one robot or with changes between them.",
    "include": '`include "FILE";`: the items of another file, relative to this one.',
    "std": '`include std "FILE";`: a file of the library that comes with srgc.',
}
_BODIES = {
    "rod": "A uniform rod from the origin of a frame along an axis.",
    "point": "A point mass at the origin of a frame.",
    "solid": "A rigid body with mass, centre of mass and inertia about it.",
    "effector": "An effector at the origin of a frame.",
    "sphere": "A ball about the origin of a frame, which collides and has no mass.",
    "capsule": "What is nearer than a radius to a segment along an axis; it collides.",
    "cylinder": "A cylinder from the origin of a frame along an axis; it collides.",
    "hull": "The convex hull of a mesh in a frame; it collides and has no mass.",
    "box": "A box about the origin of a frame, along its axes; it collides.",
    "visual": "A mesh in a frame for exports and views alone; it has no mass and does not collide.",
    "rot": "`rot(axis, angle)`: turned about an axis of the local frame.",
    "move": "`move(axis, d)` or `move((x, y, z))`: moved in the local frame.",
}
_MODULE = {
    "role": "`role base;` (`joint`, `link`, `effector`): what the module is for.",
    "base": "The role of the part that stands on the ground.",
    "joint": "The role of a part that moves.",
    "link": "The role of a rigid part.",
    "effector": "The role of the part that has to be somewhere; `effector(frame: f);` says where.",
    "frame": "`frame out = in * rot(z, q) * move(x, d);`: a frame of the module, from `in` on.",
    "in": "`in [lo, hi]`: a range; in an expression, the frame at which the module is mounted.",
    "port": "`port in: TYPE;`, `port out: TYPE;`: where modules meet; an output has a frame.",
    "male": "`male` fits `female` of the same type.",
    "female": "`female` fits `male` of the same type.",
    "named": '`named "TEXT";`, `dof … named "TEXT";`: the name of the part or joint in exports.',
    "param": "`param NAME in [lo, hi] unit;` or `in {v1, v2} unit;`: the synthesis chooses it.",
    "const": "`const NAME = expr;`: a value with a name.",
    "dof": (
        "`dof NAME: revolute AXIS in [lo, hi] deg rate in [lo, hi] rad/s accel <= a effort <= v;`: "
        "a coordinate with its limits."
    ),
    "drive": (
        "`drive DOF: gear G rotor J viscous B coulomb C;`: what moves a joint, from its data sheet."
    ),
    "gear": "`gear G`: turns of the rotor per turn of the joint, or rad per metre.",
    "rotor": "`rotor J`: the rotor's own moment of inertia; the joint feels gear^2 times it.",
    "coulomb": "`coulomb C`: dry friction, an effort of this size against the motion, N*m or N.",
    "viscous": "`viscous B`: friction in proportion to the rate, N*m*s or N*s/m.",
    "revolute": "The coordinate is an angle about the axis.",
    "prismatic": "The coordinate is a length along the axis.",
    "rate": "The bounds of the rate; in an expression, `rate(q)` is the rate of a coordinate.",
    "accel": "`accel <= v`: the bound of the size of the acceleration, rad/s^2 or m/s^2.",
    "state": "`state NAME unit = init;`: a state of the module's own, zero at first by default.",
    "input": "`input NAME in [lo, hi] unit;`: an input of the module's own with its bounds.",
    "der": "`der(STATE) = expr;`: the derivative of a state.",
    "torque": "`torque(DOF) = expr;`: the generalised force on it, instead of its input `u`.",
    "u": "The free input of the degree of freedom.",
}
_GRAMMAR = {
    "start": "`start N;`: the nonterminal of a whole robot; from ports, its first module.",
    "accept": "`accept CONDITION;`: only these words are robots; several hold together.",
    "contains": "The word has these symbols, one after the other, somewhere.",
    "starts": "`starts with W`: the word begins with these symbols.",
    "ends": "`ends with W`: the word ends with these symbols.",
    "count": "`count(SYM) <= n`: how often a symbol occurs.",
    "length": "`length <= n`: the number of symbols, edges too.",
    "matches": "`matches REGEX`: the whole word, with `|`, `*`, `+`, `?` and parentheses.",
    "empty": "The empty word.",
    "ports": "`grammar NAME from ports { … }`: the ports of its modules say what fits where.",
    "from": "`grammar NAME from ports { … }`: the ports of its modules say what fits where.",
    "with": "`with M1, M2;`: the modules that others may carry.",
}
_SEMANTICS = {
    "this": "The left side of the production.",
    "world": "The fixed frame.",
    "let": "`let NAME = expr;`: a value with a name, within the block.",
    "in": "`M.in = FRAME;`: mounts a module with bodies of its own.",
    **_BODIES,
}
_WORKSPACE = {
    "plane": "`plane xy;`: the robot moves in the plane.",
    "space": "`space xyz;`: the robot moves in space.",
    "bounds": "`bounds SHAPE;`: no effector ever leaves it.",
    "region": "`region NAME SHAPE;`: a closed convex set with a name.",
    "obstacle": "`obstacle NAME SHAPE;`: a region that a task is expected to `avoid`.",
    "target": "`target NAME SHAPE;`: a region that a task is expected to reach.",
    "obstacles": '`obstacles from "FILE";`: a map_server map, GeoJSON, or a mesh (STL, OBJ).',
    "in": '`obstacles from "scene.stl" in mm`: the unit of a mesh.',
    "at": '`obstacles from "scene.stl" at FRAME`: where the axes of a mesh are in the workspace.',
    "box": "`box [lo, hi] x [lo, hi] unit`: a product of intervals.",
    "polytope": "`polytope { inequalities } unit`: a bounded intersection of half-spaces.",
    "hull": "`hull (..), (..) unit`: the convex hull of points.",
    "ball": "`ball (..) unit radius r`: what is nearer than r to a point.",
    "capsule": "`capsule (..), (..) unit radius r`: what is nearer than r to a segment.",
    "cylinder": "`cylinder (..), (..) unit radius r`: likewise, without round ends.",
    "radius": "The radius of a ball, a capsule or a cylinder.",
}
_TASK = {
    "robot": "`robot GRAMMAR;`: the family of robots.",
    "workspace": "`workspace NAME;`: where the task is.",
    "start": "`start in R at rest;` or `start at (…);`: the pose at time 0.",
    "reach": "`reach R;`: an effector is in R at the final instant.",
    "avoid": "`avoid R with effector;` (`body`, `margin d`): at every instant.",
    "held": "`start in R at rest held;`: some inputs within their bounds balance the robot there.",
    "effort": "`effort <= v unit;`: the bound of free inputs; `minimize effort;`: the share used.",
    "norm": "`norm 2`: the bound is that of the Euclidean norm of all inputs.",
    "horizon": "`horizon k steps of dt;`: k inputs, each held for dt; `at most k`: up to k.",
    "at most": "`horizon at most k steps of dt;`: motions of any number of steps from 1 to k.",
    "most": "`horizon at most k steps of dt;`: motions of any number of steps from 1 to k.",
    "steps": "The number of inputs.",
    "slack": "`slack v;`: the tolerance of C.6; 1e-6 if not given.",
    "gravity": "`gravity (gx, gy) m/s^2;`: zero if not given.",
    "modules": "`modules <= n;`: robots of at most so many, edges aside; `minimize modules;`: few.",
    "bounds": "`bounds with body;`: the bounds hold for all bodies, not for effectors alone.",
    "from": "`from WORD;`: an existing robot to be changed; `carry m from A to B;`: a load in A.",
    "fixed": "`fixed L1.length = 2 m`: a parameter of a kept module that stays as it is.",
    "satisfy": "`satisfy FORMULA;`: linear temporal logic on the finite motion.",
    "robust": "`robust start …;` (`effort`, `mass`, `payload`, `measure`): disturbances.",
    "measure": "`robust measure 0.1 deg, 0.5 deg/s;`: errors of what the controller measures.",
    "mass": "`robust mass p %;`: masses (`of M`) times a constant; `minimize mass;`: of bodies.",
    "bound": "`robust effort p % of bound;`: a part of the bound, whatever is commanded.",
    "control": "`control open loop;` or `control feedback;`: either if not given.",
    "open": "`control open loop;`: the inputs are fixed in advance.",
    "loop": "`control open loop;`: the inputs are fixed in advance.",
    "repeat": "`repeat;`: the motion goes on for ever; the horizon is a prefix and one loop.",
    "feedback": "`control feedback;`: the inputs follow what is measured at the steps.",
    "effector": "The n-th effector, in word order; or all of them after `with`.",
    "body": "All rods, points and solids of the robot.",
    "margin": "`margin d`: the Euclidean distance is at least d.",
    "rest": "`at rest`: all rates are zero, at the end of a motion below 0.001 rad/s or m/s.",
    "rates": "`rates <= v`: a bound of all rates at the start, at the end, or of a load.",
    "aligned": "`aligned -z to (0, 0, -1) within 5 deg`: an axis of the effector's frame.",
    "oriented": "`oriented rot(z, 30 deg) within 2 deg`: the effector's frame, in the world.",
    "to": "The direction along which an axis points, or the region in which a load is put down.",
    "within": "The angle by which a frame may be off; `within p %`: what later objectives may add.",
    "payload": "`payload m;`: a point mass at the effector, all the time.",
    "carry": "`carry m from A to B;`: a point mass that is taken up in A and put down in B.",
    "minimize": "`minimize sum(NAME) within p % then modules;`: what there is to be least of.",
    "time": "`minimize time;`: how long the motion takes, up to the horizon.",
    "energy": "`minimize energy;`: what the drives turn over, of all joints together.",
    "then": "`then OBJECTIVE`: among what the objectives before it leave.",
    "sum": "`minimize sum(NAME);`: the sum over the modules of a `const` or `param` of theirs.",
    "for": "`reach R at rest for d;`: throughout the last d seconds.",
    "self": "`avoid self with body;`: bodies of links that no joint connects stay apart.",
    "except": "`except M1 M2, M3 M4`: bodies of the modules of a pair may touch.",
    "always": "`always F`, `always[t1, t2] F`: F at every instant from now on (of the window).",
    "eventually": "`eventually F`, `eventually[t1, t2] F`: F at some instant (of the window).",
    "until": "`F until G`: G at some instant, and F at all before it.",
    "next": "`next F`: F one step later; false at the last.",
    "last": "`last[d] F`: F throughout the last d of the motion.",
    "implies": "`F implies G`: not F, or G.",
}
_MISSION = {
    "tasks": "`tasks A, B;`: the tasks in their order, all about robots of one grammar.",
    "one robot": "`one robot;`: the same word and parameters do every task, each in its own way.",
    "one": "`one robot;`: the same word and parameters do every task, each in its own way.",
    "robot": "`one robot;`: the same word and parameters do every task, each in its own way.",
    "reconfigure": "`reconfigure add 2, remove 1;`: between two tasks the robot is rebuilt.",
    "add": "`add v`: what a module costs that is added; 1 if not given.",
    "remove": "`remove v`: what a module costs that is removed; 1 if not given.",
    "change": "`change v`: what a free parameter costs that is changed; 0 if not given.",
    "free": "`free M.p;`: modules that are kept may change this parameter; all others they keep.",
    "changes": "`changes <= n;`: what all changes cost together; `minimize changes;`: little.",
    **{
        word: _TASK[word]
        for word in (
            "minimize", "modules", "mass", "time", "energy", "effort", "sum", "then", "within",
        )
    },
}  # fmt: skip
_ANYWHERE = {
    "pi": "The circle's ratio, 3.14159…",
    "sin": "The sine of an angle in rad.",
    "cos": "The cosine of an angle in rad.",
    "tan": "The tangent of an angle in rad.",
    "sqrt": "The square root.",
    "abs": "The absolute value.",
    "and": "Both hold.",
    "or": "One of the two holds, or both.",
    "not": "It does not hold.",
}
_BY_ITEM = MappingProxyType(
    {
        "": {},
        "module": {**_BODIES, **_MODULE},
        "grammar": _GRAMMAR,
        "semantics": _SEMANTICS,
        "workspace": _WORKSPACE,
        "task": _TASK,
        "mission": _MISSION,
    }
)


def explained(word: str, item: str) -> str | None:
    """The meaning of a keyword in an item of that kind (empty: outside all items)."""
    if not item or word == item:
        return _TOP.get(word)
    return _BY_ITEM.get(item, {}).get(word) or _ANYWHERE.get(word)
