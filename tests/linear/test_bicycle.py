"""The benchmark bicycle, from a model of its parts, against the published table.

J. P. Meijaard, J. M. Papadopoulos, A. Ruina, A. L. Schwab, Linearized dynamics equations for the balance and
steer of a bicycle: a benchmark and review, Proc. R. Soc. A 463 (2007) 1955-1982: equations 5.2 to 5.5 and
table 2.
"""

from typing import Any

import numpy as np
import pytest

import lagc
from lagc.simulation.linearization.linear_model import Linear

pytestmark = pytest.mark.full  # the model has 6,000 operations, its derivatives more

G = 9.81
M = [[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]]
C1 = [[0.0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]]
K0 = [[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]]
K2 = [[0.0, 76.59734589573222], [0.0, 2.65431523794604]]

# Speed: weave (one of the pair, or two real values), capsize, caster.  The last digits of the casters at 4
# and 5 m/s, which public copies of the table round differently, are those of an evaluation with 36 digits.
EIGENVALUES: dict[float, list[complex]] = {
    0: [5.53094371765393, 3.13164324790656, -3.13164324790656, -5.53094371765393],
    1: [3.52696170990070 + 0.80774027519930j, -3.13423125066578, -7.11008014637442],
    2: [2.68234517512745 + 1.68066296590675j, -3.07158645641514, -8.67387984831735],
    3: [1.70675605663975 + 2.31582447384325j, -2.63366137253667, -10.35101467245920],
    4: [0.41325331521125 + 3.07910818603206j, -1.42944427361326, -12.15861426576444],
    5: [-0.77534188219585 + 4.46486771378823j, -0.32286642900409, -14.07838969279825],
    6: [-1.52644486584142 + 5.87673060598709j, -0.00406690076970, -16.08537123098030],
    7: [-2.13875644258362 + 7.19525913329805j, 0.10268170574766, -18.15788466125262],
    8: [-2.69348683581097 + 8.46037971396931j, 0.14327879765713, -20.27940894394569],
    9: [-3.21675402252485 + 9.69377351531791j, 0.15790184030917, -22.43788559040858],
    10: [-3.72016840437287 + 10.90681139476287j, 0.16105338653172, -24.62459635017404],
}
CLOSE = 1e-10


@pytest.fixture(scope="module")
def bicycle() -> lagc.CompiledModel:
    return lagc.load("classic/whipple_bicycle").compile("straight", backend="numpy")


def straight(bicycle: lagc.CompiledModel, v: float) -> Linear:
    linear = bicycle.linearize(parameters={"v": v})
    assert linear.steady and set(linear.idle) == {"x", "y", "psi", "thetaR", "thetaF", "der(x)"}
    return linear


def matrices(linear: Linear) -> tuple[Any, Any, Any]:
    """M, C and K of M q'' + C q' + K q = f, q = (phi, delta)."""
    q = [linear.states.index(name) for name in ("phi", "delta")]
    v = [linear.states.index(f"der({name})") for name in ("phi", "delta")]
    mass = np.linalg.inv(linear.B[v])
    return mass, -mass @ linear.A[np.ix_(v, v)], -mass @ linear.A[np.ix_(v, q)]


def test_the_matrices(bicycle: lagc.CompiledModel) -> None:
    mass, damping, at_rest = matrices(straight(bicycle, 0.0))
    assert mass == pytest.approx(np.array(M), rel=CLOSE)
    assert damping == pytest.approx(np.zeros((2, 2)), abs=CLOSE)
    assert at_rest / G == pytest.approx(np.array(K0), rel=CLOSE)
    for v in (1.0, 5.0, 10.0):
        mass, damping, stiffness = matrices(straight(bicycle, v))
        assert mass == pytest.approx(np.array(M), rel=CLOSE)
        assert damping / v == pytest.approx(np.array(C1), rel=CLOSE, abs=CLOSE)
        assert (stiffness - at_rest) / v**2 == pytest.approx(np.array(K2), rel=CLOSE, abs=CLOSE)


@pytest.mark.parametrize("v", EIGENVALUES)
def test_the_eigenvalues(v: float, bicycle: lagc.CompiledModel) -> None:
    linear = straight(bicycle, v)
    found = sorted((z for z in linear.eigenvalues.tolist() if z and z.imag >= 0.0), key=lambda z: z.real)
    expected = sorted(EIGENVALUES[v], key=lambda z: complex(z).real)
    assert found == pytest.approx(expected, rel=CLOSE, abs=CLOSE)
    assert sum(1 for z in linear.eigenvalues if z == 0.0) == 6
    assert linear.stability == ("asymptotically stable" if 4.3 < v < 6.02 else "unstable")


@pytest.mark.parametrize(
    "below, above",
    [(4.29238253634111 - 1e-9, 4.29238253634111 + 1e-9), (6.02426201538837 + 1e-9, 6.02426201538837 - 1e-9)],
)
def test_it_balances_itself_between_weave_and_capsize(
    below: float, above: float, bicycle: lagc.CompiledModel
) -> None:
    assert straight(bicycle, below).stability == "unstable"
    assert straight(bicycle, above).stability == "asymptotically stable"


def test_upright_at_rest_it_stands(bicycle: lagc.CompiledModel) -> None:
    """The wheels hold nothing along the way there: rows that are nothing but rounding weigh nothing."""
    (linear,) = bicycle.equilibria(parameters={"v": 0.0}, tries=0)
    assert linear.equilibrium and linear.free == 5
    found = [z for z in linear.eigenvalues.tolist() if z]
    assert found == pytest.approx(EIGENVALUES[0], rel=CLOSE)
