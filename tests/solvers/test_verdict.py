from dataclasses import FrozenInstanceError

import pytest

from solvers.verdict import Fails, Holds, Reason, Unknown


@pytest.mark.parametrize("verdict", [Holds(1), Fails(()), Unknown(Reason.NUMERICS)])
def test_a_verdict_is_a_value_and_no_bool(verdict):
    assert verdict == type(verdict)(*(getattr(verdict, name) for name in verdict.__slots__))
    with pytest.raises(TypeError, match="match it"):
        bool(verdict)
    with pytest.raises(FrozenInstanceError):
        setattr(verdict, verdict.__slots__[0], None)


def test_equal_contents_of_different_kinds_differ():
    assert Holds(1) != Fails(1)
