"""Which structures extend a shorter one neutrally, and at which parameters the two are the same."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.grammars.derivation import Derivation
from compiler.languages.structures import derivations_of
from compiler.semantics.family import RobotFamily
from compiler.semantics.neutral_extension import neutral_extensions, neutral_modules
from grammar_lang.load import load_text
from tests.oracles import robots

FAMILY = """
module B {{ role base; }}
module J {{ role joint; dof q: revolute z in [-1, 1]; }}
module L {{ role link; param length in [0.5, 2] m; }}
module Z {{ role link; param angle in {angle}; param length in {length} m;
            param density in [2, 3] kg/m; }}
module E {{ role effector; }}
edge eps;
grammar G {{
  start N; base: N -> B; joint: N -> N eps J; link: N -> N eps L; more: N -> N eps Z;
  tool: N -> N eps E;
}}
semantics G {{
  base {{ this.frame = world; }}
  joint {{ this.frame = N.frame * rot(z, J.q); }}
  link {{ this.frame = N.frame * move(x, L.length);
          rod(frame: N.frame, axis: x, length: L.length, density: 1 kg/m); }}
  more {{ this.frame = N.frame * rot(z, Z.angle) * move(x, Z.length);
          rod(frame: N.frame * rot(z, Z.angle), axis: x, length: Z.length, density: Z.density); }}
  tool {{ this.frame = N.frame; effector(frame: N.frame); }}
}}
"""
HOLDS = {"angle": "[-90, 90] deg", "length": "[0, 1]"}


def family_of(**domains: str) -> RobotFamily:
    loaded = load_text(FAMILY.format(**domains), "g.srg")
    assert loaded.program is not None, loaded.diagnostics
    return RobotFamily(loaded.program, loaded.program.grammars["G"], 2)


def derivation_of(family: RobotFamily, word: str) -> Derivation:
    (derivation,) = derivations_of(family.language, tuple(word.split()))
    return derivation


@pytest.mark.parametrize(
    ("longer", "shorter"),
    [
        ("B eps J eps L eps Z eps E", "B eps J eps L eps E"),
        # The extension comes before a joint and a link: the symbols behind it move by two.
        ("B eps J eps L eps Z eps J eps L eps E", "B eps J eps L eps J eps L eps E"),
    ],
)
def test_at_the_parameters_handed_on_both_robots_move_alike(longer: str, shorter: str) -> None:
    family = family_of(**HOLDS)
    long, short = derivation_of(family, longer), derivation_of(family, shorter)
    (extension,) = neutral_extensions(long, neutral_modules(family))
    assert extension.shorter == short.labels
    models = [family.robot(each) for each in (short, long)]
    theta = np.linspace(0.7, 1.6, len(models[0].parameters))
    handed = extension.parameters(models[1].parameters, models[0].parameters, theta.tolist())
    graphs = [robot_graph(model) for model in models]
    rng, n = np.random.default_rng(5), len(models[0].dofs)
    assert len(models[1].dofs) == n
    for _ in range(5):
        q, v = rng.uniform(-1, 1, n), rng.uniform(-1, 1, n)
        for name, columns in (("mass_matrix", (q,)), ("bias", (q, v)), ("effectors", (q,))):
            values: Sequence[np.ndarray] = [
                robots.evaluate(graph, name, *columns, at)
                for graph, at in zip(graphs, (theta, np.array(handed)), strict=True)
            ]
            np.testing.assert_allclose(values[0], values[1], rtol=1e-12, atol=1e-12)


def test_every_extension_of_a_word_with_several_is_found() -> None:
    family = family_of(**HOLDS)
    word = derivation_of(family, "B eps J eps Z eps L eps Z eps E")
    found = neutral_extensions(word, neutral_modules(family))
    words = {" ".join(family.replay(each.shorter).word) for each in found}
    assert words == {"B eps J eps L eps Z eps E", "B eps J eps Z eps L eps E"}
    assert {each.symbol for each in found} == {4, 8}
    assert {each.added for each in found} == {(3, 4), (7, 8)}


@pytest.mark.parametrize(
    "domains",
    [
        {"angle": "[-90, 90] deg", "length": "[0.1, 1]"},
        {"angle": "[10, 90] deg", "length": "[0, 1]"},
        {"angle": "[-90, 90] deg", "length": "{0.5, 1}"},
    ],
)
def test_without_neutral_values_nothing_extends(domains: dict[str, str]) -> None:
    family = family_of(**domains)
    word = derivation_of(family, "B eps J eps L eps Z eps E")
    assert neutral_extensions(word, neutral_modules(family)) == []


def test_a_parameter_that_may_have_any_value_has_one_of_its_domain() -> None:
    family = family_of(**HOLDS)
    long = derivation_of(family, "B eps J eps L eps Z eps E")
    short = derivation_of(family, "B eps J eps L eps E")
    (extension,) = neutral_extensions(long, neutral_modules(family))
    own = family.robot(long).parameters
    values = extension.parameters(own, family.robot(short).parameters, [1.5])
    named = {(p.module, p.name): value for p, value in zip(own, values, strict=True)}
    assert named[("L", "length")] == 1.5
    assert named[("Z", "length")] == named[("Z", "angle")] == 0
    assert 2 <= named[("Z", "density")] <= 3
