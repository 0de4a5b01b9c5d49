"""Linear models and derivatives at states at which conditions change."""

import random
import warnings

import numpy as np
import pytest

import lagc

pytestmark = pytest.mark.usefixtures("own_cache")


def line(force: str, start: str = "0 [m]", rate: str = "0 [m/s]") -> lagc.CompiledModel:
    text = f"""model Line
      parameter Mass m = 2 [kg];
      input Force u = 0;
      coordinate Length x(start = {start}, rate = {rate}), y(start = 0.5 [m]);
      body b = Particle(mass = m, at = {{x, y, 0}});
      force f = {{{force} + u, -3 [N/m]*y, 0}} at b;
      output Force pull = {force};
    end Line;"""
    return lagc.loads(text).compile(backend="numpy")


@pytest.mark.sample(0, 4)
@pytest.mark.parametrize("seed", range(6))
def test_both_sides_of_a_bend_are_told(seed: int) -> None:
    """A spring k on one side of d and c on the other, written in all ways: that on which x is larger
    is given, the other in the note."""
    chance = random.Random(seed)
    k, c, d = (round(chance.uniform(1.0, 9.0), 3) for _ in range(3))
    far = f"(x - {d} [m])"
    ways = [
        f"(if x > {d} [m] then -{k} [N/m]*{far} else -{c} [N/m]*{far})",
        f"(-{k} [N/m]*max({far}, 0 [m]) - {c} [N/m]*min({far}, 0 [m]))",
        f"({-(k + c) / 2!r} [N/m]*{far} - {(k - c) / 2!r} [N/m]*abs({far}))",
    ]
    for force in ways:
        model = line(force, f"{d} [m]")
        found = model.linearize()
        slope = found.A[2, 0]
        assert sorted([-2.0 * slope, k + c + 2.0 * slope]) == pytest.approx(sorted([k, c]))
        (note,) = found.notes
        assert "forces have a kink there" in note and "on the other side" in note
        other = -(k + c) / 2.0 - slope
        assert f"d(der(der(x)))/d(x) is {slope:.6g}, and {other:.6g} on the other side" in note
        with pytest.warns(RuntimeWarning, match="on the other side"):
            assert model.jacobian("accelerations", "x")[0, 0] == pytest.approx(slope)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            beside = model.jacobian("accelerations", "x", 0.0, [d + 1e-3, 0.5, 0.0, 0.0])
            assert beside[0, 0] == pytest.approx(-k / 2.0)
            model.jacobian("accelerations", "u")  # the same on both sides
        assert model.linearize(0.0, [d - 1e-3, 0.5, 0.0, 0.0]).notes == ()


def test_what_is_smooth_there_is_no_bend() -> None:
    """x |x| bends in its second derivative only; so does a force that conditions leave as it is."""
    for force in ("-1 [N/m2]*x*abs(x)", "(if x > 0 [m] then -2 [N/m]*x else -x*2 [N/m])"):
        assert line(force).linearize().notes == ()


def test_where_forces_jump_there_is_no_linear_model() -> None:
    for force in ("-3 [N]*sign(der(x))", "-3 [N]*sign(x)", "(if x < 0 [m] then 0 [N] else 1 [N])"):
        model = line(force)
        with pytest.raises(
            ArithmeticError, match=r"forces are discontinuous there, where (der\()?x\)? passes 0"
        ):
            model.linearize()
        with pytest.raises(ArithmeticError, match="forces are discontinuous"):
            model.jacobian("rates", "state")
        assert model.jacobian("inertia", "accelerations").tolist() == [[2.0, 0.0], [0.0, 2.0]]
        assert model.linearize(0.0, [0.1, 0.5, 0.1, 0.0]).notes == ()


def test_time_goes_on() -> None:
    """A square wave at the beginning of a period: what comes is meant."""
    found = line("(if mod(time, 1 [s]) < 0.5 [s] then -2 [N/m]*x else -4 [N/m]*x)").linearize()
    assert found.A[2, 0] == pytest.approx(-1.0) and found.notes == ()


def test_two_bends_at_one_state() -> None:
    model = line("(-1 [N/m]*abs(x) - 2 [N.s/m]*abs(der(x)))")
    found = model.linearize()
    assert found.A[2].tolist() == pytest.approx([-0.5, 0.0, -1.0, 0.0])
    assert len(found.notes) == 2
    assert np.isfinite(found.eigenvalues).all()
