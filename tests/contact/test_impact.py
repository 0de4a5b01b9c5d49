"""Impacts with restitution and friction: closed forms, the laws themselves, and energy."""

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from tests.contact.law_kernels import fill, in_python, values

DONE, NOTHING, PARADOX, GAINS, ENDLESS, FAILED = range(6)
Array = Any


def impact(
    rows: Array, inverse: Array, v: Array, e: Sequence[float], slips: int = 0, **more: Any
) -> tuple[int, Any, dict[str, Any]]:
    """Return the result, the speeds after, and what was found, of contacts with these rows and speeds."""
    work, n = in_python()["make"](), len(e)
    fill(
        work, rows @ inverse @ rows.T, rows @ v, [slips] * n, more.pop("mu", [0.0] * n), restitution=e, **more
    )
    code = in_python()["impact"](work)
    found = values(work)
    after = v + inverse @ rows.T @ found["p"]
    assert np.allclose(rows @ after, found["u"], atol=1e-13 * np.max(np.abs(rows @ v)))
    return code, after, found


def energy(inverse: Array, v: Array) -> float:
    return float(v @ np.linalg.solve(inverse, v)) / 2.0


def tip(angle: float) -> tuple[Array, Array]:
    """Rows of the end of a rod of length 1 and mass 1 at an angle with the floor, up and along."""
    rows = np.array([[0.0, 1.0, -0.5 * math.cos(angle)], [1.0, 0.0, 0.5 * math.sin(angle)]])
    return rows, np.diag([1.0, 1.0, 12.0])


def test_rod_that_falls_on_its_end() -> None:
    # W. J. Stronge, Impact Mechanics, 2000: impulse (1 + e) v / (1/m + d^2/I), d = cos(a) l / 2
    rows, inverse = tip(0.7)
    code, after, found = impact(rows[:1], inverse, np.array([0.0, -2.0, 0.0]), [0.5])
    assert code == DONE and found["rounds"] == 1
    assert abs(found["p"][0] - 1.08894870037899138989) < 4e-15
    assert abs(after[1] + 0.9110512996210086101101) < 4e-15
    assert abs(abs(after[2]) - 4.99724343503081283325) < 2e-14
    assert abs(found["u"][0] - 1.0) < 4e-15
    assert (
        abs(found["loss"][0] - energy(inverse, np.array([0.0, -2.0, 0.0])) + energy(inverse, after)) < 1e-14
    )


@pytest.mark.parametrize(
    ("masses", "e", "after"),
    [((3.0, 1.0), 1.0, (0.0, 8.858893836140040345325)),
     ((3.0, 1.0), 0.8, (-0.04429446918070020172662, 6.334109092840128846907)),
     ((1.0, 0.1), 0.9, (2.532838283150947898732, 10.10719251305068239398))],
)  # fmt: skip
def test_ball_on_a_ball(masses: tuple[float, float], e: float, after: tuple[float, float]) -> None:
    # W. G. Harter et al., Am. J. Phys. 39 (1971) 656-663: both fall by 1 m, the lower one hits first
    rows, inverse = np.array([[1.0, 0.0], [-1.0, 1.0]]), np.diag([1.0 / m for m in masses])
    code, v, found = impact(rows, inverse, np.full(2, -math.sqrt(2.0 * 9.81)), [e, e])
    assert code == DONE and found["rounds"] >= 2
    # After these two impacts the lower ball may hit the floor again: those with a velocity upwards do not.
    if after[0] >= 0.0:
        assert np.allclose(v, after, atol=2e-14)
    else:
        assert found["rounds"] == 3 and abs(v[0] + e * after[0]) < 2e-14 and abs(v[1] - after[1]) < 2e-14


@pytest.mark.parametrize("slip", [-0.6, -0.3, 0.2, 0.5])
def test_blows_that_two_ends_of_a_lying_rod_pass_on_fade_to_rest(slip: float) -> None:
    """One end falls, the other lies: each blow lifts the other end by half of its speed. The last blows are
    near round-off, where the rod slides, sticks and rests to the same velocities."""
    for mu in (0.1, 0.3, 0.5, 0.7):
        rows = np.array([[0.0, 1.0, 0.5], [1.0, 0.0, 0.01], [0.0, 1.0, -0.5], [1.0, 0.0, 0.01]])
        v = np.array([slip, -2.5, 5.0])
        code, after, found = impact(rows, np.diag([1.0, 1.0, 12.0]), v, [0.0, 0.0], 1, mu=[mu, mu])
        assert code == DONE and found["rounds"] > 10
        assert np.max(np.abs(rows[::2] @ after)) < 1e-10


def test_row_of_three_balls_passes_the_blow_on() -> None:
    rows = np.array([[-1.0, 1.0, 0.0], [0.0, -1.0, 1.0]])
    code, v, found = impact(rows, np.eye(3), np.array([1.0, 0.0, 0.0]), [0.9, 0.9])
    assert (code, found["rounds"]) == (DONE, 3)
    assert np.allclose(v, [0.047625, 0.049875, 0.9025], atol=1e-15)


def test_cradle_of_five_passes_the_blow_to_the_last_ball() -> None:
    rows = np.diff(np.eye(5), axis=0)
    code, v, found = impact(rows, np.eye(5), np.array([1.0, 0.0, 0.0, 0.0, 0.0]), [1.0] * 4)
    assert (code, found["rounds"]) == (DONE, 4)
    assert np.array_equal(v, [0.0, 0.0, 0.0, 0.0, 1.0])
    code, v, found = impact(rows, np.eye(5), np.array([1.0, 1.0, 0.0, 0.0, 0.0]), [1.0] * 4)
    assert np.array_equal(v, [0.0, 0.0, 0.0, 1.0, 1.0])


def test_bar_that_falls_flat_hits_with_both_ends_at_once() -> None:
    rows = np.array([[1.0, -1.0], [1.0, 1.0]])
    code, v, found = impact(rows, np.diag([1.0, 3.0]), np.array([-1.0, 0.0]), [0.5, 0.5])
    assert (code, found["rounds"]) == (DONE, 1) and np.allclose(v, [0.5, 0.0], atol=1e-15)


def test_contacts_that_separate_or_only_touch_have_no_impact() -> None:
    code, _, found = impact(np.eye(2), np.eye(2), np.array([0.0, 1.0]), [0.5, 0.5])
    assert code == NOTHING and found["rounds"] == 0 and not np.any(found["p"])


def test_four_corners_that_fall_flat_share_the_impulse() -> None:
    # rows of rank 3 of 4: the plate rebounds as one body
    corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    rows = np.array([[1.0, y, -x] for x, y in corners])
    code, v, found = impact(rows, np.diag([1.0, 3.0, 3.0]), np.array([-2.0, 0.0, 0.0]), [0.25] * 4)
    assert code == DONE and np.allclose(v, [0.5, 0.0, 0.0], atol=1e-14)
    assert abs(np.sum(found["p"]) - 2.5) < 1e-14 and np.min(found["p"]) >= 0.0


def test_ball_between_walls_at_a_narrow_angle_is_refused_after_a_thousand_rounds() -> None:
    for angle, code in ((0.01, DONE), (0.001, ENDLESS)):
        walls = np.array([[0.0, 1.0], [math.sin(angle), -math.cos(angle)]])
        result, v, found = impact(walls, np.eye(2), np.array([-1.0, -2.0 * angle]), [1.0, 1.0])
        assert result == code
        if code == DONE:  # it has as many impacts as mirrors show walls: pi / angle
            assert (
                abs(found["rounds"] - math.pi / angle) <= 2.0
                and abs(np.hypot(*v) - np.hypot(1.0, 2.0 * angle)) < 1e-11
            )


def test_two_sided_contact_takes_part_in_an_impact() -> None:
    # a ball of 1 kg on a guide along x, rough with mu = 0.3, hits a wall at 45 degrees
    rows = np.array([[math.sqrt(0.5), math.sqrt(0.5)], [0.0, 1.0], [1.0, 0.0]])
    work = in_python()["make"]()
    v = np.array([-1.0, 0.0])
    fill(work, rows @ rows.T, rows @ v, [0, 1], [0.0, 0.3], restitution=[0.5, 0.0], two_sided=[0, 1])
    assert in_python()["impact"](work) == DONE
    after = v + rows.T @ values(work)["p"]
    assert abs(after[1]) < 1e-15 and abs(rows[0] @ after - 0.5 * math.sqrt(0.5)) < 1e-15
    p = values(work)["p"]
    assert abs(p[1] + p[0] * math.sqrt(0.5)) < 1e-15 and abs(p[2] + 0.3 * abs(p[1])) < 1e-15


@pytest.mark.parametrize("poisson", [0, 1])
def test_friction_in_an_impact_meets_the_laws(poisson: int) -> None:
    chance = np.random.default_rng(3)
    seen = Counter[str]()
    for _ in range(40):
        rows, inverse = tip(chance.uniform(0.1, 1.5))
        v = np.linalg.lstsq(rows, [-1.0, chance.uniform(-1.0, 1.0)], rcond=None)[0]
        mu, e = chance.uniform(0.0, 0.8), chance.uniform(0.0, 1.0)
        code, _, found = impact(rows, inverse, v, [e], 1, mu=[mu], poisson=[poisson])
        (normal, along), (up, slip) = found["p"], found["u"]
        if code != DONE:
            assert code == GAINS and not poisson
            continue
        assert normal > 0.0 and abs(along) <= mu * normal * (1.0 + 1e-12)
        if not poisson:
            assert abs(up - e) < 1e-13
            seen["slips" if abs(slip) > 1e-12 else "sticks"] += 1
            assert abs(slip) < 1e-12 or abs(along + mu * normal * math.copysign(1.0, slip)) < 1e-12
    assert poisson or min(seen.values()) > 3


def test_poisson_without_friction_is_newton() -> None:
    rows, inverse = tip(0.7)
    one, other = [
        impact(rows[:1], inverse, np.array([0.3, -2.0, 1.0]), [0.5], poisson=[k])[1] for k in (0, 1)
    ]
    assert np.allclose(one, other, atol=1e-15)


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(40))
def test_energy_never_grows_with_poisson_and_with_newton_growth_is_refused(seed: int) -> None:
    chance, seen = np.random.default_rng(seed), Counter[int]()
    for _ in range(100):
        rows, inverse = tip(chance.uniform(0.1, 1.5))
        v = np.linalg.lstsq(rows, [-1.0, chance.uniform(-3.0, 3.0)], rcond=None)[0]
        mu, e = [chance.uniform(0.0, 1.2)], [chance.uniform(0.3, 1.0)]
        for poisson in (0, 1):
            code, after, found = impact(rows, inverse, v, e, 1, mu=mu, poisson=[poisson])
            gain = energy(inverse, after) - energy(inverse, v)
            assert abs(gain + np.sum(found["loss"])) < 1e-12 * energy(inverse, v)
            assert (code == GAINS) == (gain > 1e-9 * energy(inverse, v))
            assert code in ((DONE,) if poisson else (DONE, GAINS))
            seen[code] += 1
    assert seen[DONE] > 150


def test_newton_with_friction_may_add_energy() -> None:
    # T. R. Kane, D. A. Levinson, Dynamics: Theory and Applications, 1985, section 5.8: such impacts exist
    chance, gains = np.random.default_rng(7), 0
    for _ in range(200):
        rows, inverse = tip(chance.uniform(0.1, 1.5))
        v = np.linalg.lstsq(rows, [-1.0, chance.uniform(-3.0, 3.0)], rcond=None)[0]
        gains += impact(rows, inverse, v, [1.0], 1, mu=[chance.uniform(0.0, 1.2)])[0] == GAINS
    assert gains > 0


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("slips", [1, 2])
def test_energy_never_grows_in_impacts_of_many_contacts(slips: int, seed: int) -> None:
    chance = np.random.default_rng(100 + seed)
    for _ in range(8):
        n = int(chance.integers(1, 4))
        rows = chance.normal(size=(n * (1 + slips), n * (1 + slips) + 1))
        v, e = chance.normal(size=rows.shape[1]), list(chance.uniform(0.0, 1.0, n))
        mu, inverse = list(chance.uniform(0.0, 0.6, n)), np.eye(rows.shape[1])
        code, after, _ = impact(rows, inverse, v, e, slips, mu=mu, poisson=[1] * n)
        assert code in (DONE, NOTHING) and energy(inverse, after) <= energy(inverse, v) * (1.0 + 1e-12)
        if code == DONE:
            assert np.min((rows @ after)[:: 1 + slips]) > -1e-10
