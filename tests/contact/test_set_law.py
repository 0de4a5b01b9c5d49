"""The law of contact with dry friction, against enumeration in NumPy, closed forms, and its conditions."""

import itertools
import math
import shutil
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.contact.law_kernels import (
    FOUND,
    KERNELS,
    NONE,
    ONE,
    OPEN,
    SEVERAL,
    SLIPS,
    STICKS,
    fill,
    in_python,
    values,
)

Array = Any


def law(
    W: Array, b: Array, slips: Sequence[int], mu: Sequence[float], **more: Any
) -> tuple[int, dict[str, Any]]:
    """Return the result of the law, and what it found."""
    work = in_python()["make"]()
    fill(work, W, b, slips, mu, **more)
    return in_python()["set_law"](work), values(work)


def violation(W: Array, b: Array, slips: Sequence[int], mu: Sequence[float], p: Array) -> float:
    """Return by how much forces violate the law, relative to the largest force and acceleration."""
    u, worst, row = W @ p + b, 0.0, 0
    speed, force = np.max(np.abs(b)), max(np.max(np.abs(p)), 1e-300)
    for k, m in zip(slips, mu):
        un, ut, pn, pt = u[row], u[row + 1 : row + 1 + k], p[row], p[row + 1 : row + 1 + k]
        size = np.linalg.norm(ut)
        worst = max(worst, -un / speed, -pn / force, abs(un * pn) / speed / force)
        worst = max(worst, (np.linalg.norm(pt) - m * pn) / force)
        worst = max(worst, float(np.linalg.norm(m * pn * ut + size * pt)) / speed / force)
        row += 1 + k
    return worst


def trials(
    seed: int, count: int, contacts: Sequence[int], slips: int
) -> Iterator[tuple[Array, Array, int, Any]]:
    """Yield W, b, the number of contacts, and a generator; half of W are rank deficient."""
    chance = np.random.default_rng(seed)
    for _ in range(count):
        n = int(chance.choice(contacts))
        speeds = int(chance.integers(1, 2 * n * (1 + slips) + 1))
        rows = chance.normal(size=(n * (1 + slips), speeds))
        yield rows @ rows.T, rows @ chance.normal(size=speeds), n, chance


def planar_solutions(W: Array, b: Array, mu: Sequence[float], given: Sequence[int]) -> list[Array]:
    """Return u of all planar solutions, by enumeration with numpy.linalg.lstsq; `given`: direction of slip of
    contacts that move, else 0."""
    n, found = len(mu), list[Array]()
    options: list[tuple[Any, ...]] = [("open", d) if d else ("open", "stick", 1, -1) for d in given]
    for modes in itertools.product(*options):
        A, r = np.eye(2 * n), np.zeros(2 * n)
        for i, mode in enumerate(modes):
            if mode != "open":
                A[2 * i], r[2 * i] = W[2 * i], -b[2 * i]
                if mode == "stick":
                    A[2 * i + 1], r[2 * i + 1] = W[2 * i + 1], -b[2 * i + 1]
                else:
                    A[2 * i + 1, 2 * i] = mu[i] * mode
        p = np.linalg.lstsq(A, r, rcond=1e-11)[0]
        u, tiny = W @ p + b, 1e-8 * max(np.max(np.abs(p)), np.max(np.abs(b)))
        good = np.max(np.abs(A @ p - r)) < tiny
        for i, mode in enumerate(modes):
            un, ut, pn, pt = u[2 * i], u[2 * i + 1], p[2 * i], p[2 * i + 1]
            good &= un >= -tiny if mode == "open" else pn >= -tiny
            good &= mode != "stick" or abs(pt) <= mu[i] * pn + tiny
            good &= mode in ("open", "stick") or bool(given[i]) or ut * mode >= -tiny
        if good and all(np.max(np.abs(u - v)) > 1e-5 * np.max(np.abs(b)) for v in found):
            found.append(u)
    return found


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(4))
def test_without_friction_the_law_is_that_of_enumeration(seed: int) -> None:
    for W, b, n, _ in trials(seed, 30, (1, 2, 3, 4), 0):
        code, found = law(W, b, [0] * n, [0.0] * n)
        best = None
        for closed in itertools.product((False, True), repeat=n):
            rows, p = [i for i in range(n) if closed[i]], np.zeros(n)
            if rows:
                p[rows] = np.linalg.lstsq(W[np.ix_(rows, rows)], -b[rows], rcond=1e-11)[0]
            u = W @ p + b
            if np.min(p) >= -1e-9 and np.min(u) >= -1e-9 and abs(u @ p) < 1e-9:
                best = u
        assert code == ONE and best is not None
        assert np.allclose(found["u"], best, atol=1e-8 * np.max(np.abs(b)))
        assert violation(W, b, [0] * n, [0.0] * n, found["p"]) < 1e-9


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(8))
def test_in_the_plane_one_none_or_several_are_those_of_enumeration(seed: int) -> None:
    seen = Counter[int]()
    for W, b, n, chance in trials(10 + seed, 12, (1, 1, 2, 2, 3), 1):
        mu = list(chance.uniform(0.0, 1.3, n))
        given = [int(chance.choice((-1, 0, 1))) for _ in range(n)]
        code, found = law(W, b, [1] * n, mu, moves=[abs(d) for d in given], direction=[(d, 0) for d in given])
        all_u = planar_solutions(W, b, mu, given)
        seen[len(all_u)] += 1
        rests = not any(given) and any(np.max(np.abs(u)) < 1e-9 * np.max(np.abs(b)) for u in all_u)
        assert code == (NONE if not all_u else ONE if len(all_u) == 1 else FOUND if rests else SEVERAL)
        assert code != FOUND or np.max(np.abs(found["u"])) < 1e-9 * np.max(np.abs(b))
        assert not all_u or min(np.max(np.abs(found["u"] - u)) for u in all_u) < 1e-6 * np.max(np.abs(b))
    assert seen[1] > 0


@pytest.mark.parametrize("slips", [0, 1])
def test_many_contacts_in_the_plane(slips: int) -> None:
    for W, b, n, chance in trials(30, 6, (6, 7, 8), slips):
        mu = list(chance.uniform(0.0, 0.6, n))
        code, found = law(W, b, [slips] * n, mu)
        assert code == (FOUND if slips else ONE)
        assert violation(W, b, [slips] * n, mu, found["p"]) < 1e-8


@pytest.mark.parametrize("slips", [0, 1])
def test_newton_alone_finds_forces_that_meet_the_law(slips: int) -> None:
    kernels = in_python()
    for W, b, n, chance in trials(35, 8, (1, 3, 5, 8), slips):
        mu = list(chance.uniform(0.0, 0.4, n))
        work = kernels["make"]()
        fill(work, W, b, [slips] * n, mu)
        work.law.mu[:n] = mu
        kernels["set_law_scales"](work.law)
        if kernels["solve_law_equation"](work.law):
            assert violation(W, b, [slips] * n, mu, values(work)["p"]) < 1e-9
        else:
            assert slips and np.linalg.matrix_rank(W) < 2 * n


@pytest.mark.sample(1)
@pytest.mark.parametrize("contacts", [(1,), (2,), (4,), (6, 8)])
def test_in_space_forces_meet_the_law(contacts: tuple[int, ...]) -> None:
    seen = Counter[int]()
    for W, b, n, chance in trials(41, 8, contacts, 2):
        if np.linalg.matrix_rank(W) < 2 * n:
            continue  # it may jam
        mu = list(chance.uniform(0.0, 0.5, n))
        code, found = law(W, b, [2] * n, mu)
        seen[code] += 1
        if code in (ONE, FOUND):
            assert violation(W, b, [2] * n, mu, found["p"]) < 1e-6
    assert seen[ONE] + seen[FOUND] >= 3


def test_one_contact_in_space_has_the_slip_directions_of_a_scan() -> None:
    for W, b, _, chance in trials(50, 12, (1,), 2):
        mu = chance.uniform(0.1, 0.8)
        code, found = law(W, b, [2], [mu])
        if code != ONE or found["mode"] != [SLIPS]:
            continue
        angles = np.linspace(0.0, 2.0 * math.pi, 20001)
        d = np.array([np.cos(angles), np.sin(angles)])
        normal = -b[0] / (W[0, 0] - mu * W[0, 1:] @ d)
        u = W[1:, :1] * normal - mu * W[1:, 1:] @ d * normal + b[1:, None]
        aside = d[0] * u[1] - d[1] * u[0]
        here = (aside[:-1] * aside[1:] < 0) & (normal[:-1] > 0) & (np.sum(d * u, 0)[:-1] > 0)
        place = float(np.arctan2(*found["direction"][0][::-1])) % (2.0 * math.pi)
        assert np.count_nonzero(here) == 1 and abs(angles[:-1][here][0] - place) < 1e-3


def slope(angle: float, mu: float, static: float) -> tuple[int, dict[str, Any]]:
    """A block of 2 kg on a slope; its rows are away from it and down it."""
    gravity = 9.81 * np.array([-math.cos(angle), math.sin(angle)])
    return law(np.eye(2) / 2.0, gravity, [1], [mu], static=[static])


def test_block_on_a_slope_sticks_up_to_static_friction_and_slips_with_the_other() -> None:
    angle = 0.5
    for static, sticks in ((math.tan(angle) * 1.0001, True), (math.tan(angle) * 0.9999, False)):
        code, found = slope(angle, 0.3, static)
        assert code == ONE and found["mode"] == [STICKS if sticks else SLIPS]
        assert found["u"][0] == 0.0 and abs(found["p"][0] - 2.0 * 9.81 * math.cos(angle)) < 1e-13
        slip = 9.81 * (math.sin(angle) - 0.3 * math.cos(angle))
        assert abs(found["u"][1] - (0.0 if sticks else slip)) < 1e-14
        force = math.sin(angle) if sticks else 0.3 * math.cos(angle)
        assert abs(found["p"][1] + 2.0 * 9.81 * force) < 1e-13


def corners(load: Sequence[float], force: Sequence[float], slips: int) -> tuple[Array, Array]:
    """W and b of a plate of 1 kg on its four corners (+-1, +-1), with a second force `force` at `load`;
    the rows of 3 or 12 directions have rank 3 or 6."""
    inverse = np.diag([1.0, 1.0, 1.0, 3.0, 3.0, 1.5])
    rows = []
    for x, y in ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)):
        for axis in np.eye(3)[[2, 0, 1][: 1 + slips]]:
            rows.append([*axis, *np.cross((x, y, 0.0), axis)])
    wrench = np.array([*force, *np.cross((*load, 0.0), force)]) + np.array([0, 0, -9.81, 0, 0, 0])
    R = np.array(rows)
    return R @ inverse @ R.T, R @ inverse @ wrench


@pytest.mark.parametrize("slips", [0, 2])
def test_four_corners_stay_while_their_forces_can_balance_the_load(slips: int) -> None:
    mu = [0.4] * 4
    for place, tips in ((0.0, False), (1.0, False), (1.97, False), (2.03, True)):
        # Half of the weight at x = place beyond the edge at x = 1: it tips where place > 1 + 2 (1 - 0).
        W, b = corners((1.0 + place, 0.0), (0.0, 0.0, -9.81 / 2.0), slips)
        code, found = law(W, b, [slips] * 4, mu)
        assert code in (ONE, FOUND)
        closed = STICKS if slips else SLIPS
        assert found["mode"] == ([OPEN, closed, closed, OPEN] if tips else [closed] * 4)
        normal = found["p"][:: 1 + slips]
        assert np.min(normal) >= -1e-8 and violation(W, b, [slips] * 4, mu, found["p"]) < 1e-7
        if not tips:
            assert abs(np.sum(normal) - 1.5 * 9.81) < 1e-6 and not np.any(found["u"])


def test_four_corners_that_stick_in_the_cone_and_slip_beyond() -> None:
    for pull, slips in ((0.39, False), (0.41, True)):
        W, b = corners((0.0, 0.0), (pull * 9.81 * 0.6, pull * 9.81 * 0.8, 0.0), 2)
        code, found = law(W, b, [2] * 4, [0.4] * 4)
        assert code == FOUND and found["mode"] == [SLIPS if slips else STICKS] * 4
        rate = 9.81 * (pull - 0.4) if slips else 0.0
        assert np.allclose(found["u"].reshape(4, 3), [0.0, 0.6 * rate, 0.8 * rate], atol=1e-7)
        if slips:
            assert np.allclose(found["direction"], [0.6, 0.8], atol=1e-9)


def rod(angle: float, mu: float, accelerates: float) -> int:
    """A rod of length 2 and mass 1 whose tip slides with it; b_n = `accelerates`."""
    jacobian = np.array([[0.0, 1.0, -math.cos(angle)], [1.0, 0.0, math.sin(angle)]])
    W = jacobian @ np.diag([1.0, 1.0, 3.0]) @ jacobian.T
    code, _ = law(W, np.array([accelerates, 0.5]), [1], [mu], moves=[1], direction=[(-1.0, 0.0)])
    return code


def test_painleve_rod_has_no_or_several_solutions_in_its_range() -> None:
    # F. Genot, B. Brogliato, Eur. J. Mech. A/Solids 18 (1999) 653-677: 1 + 3 cos(a) (cos(a) - mu sin(a)) < 0
    for low, high, inside in (
        (0.8838626263729, 0.8838626263731, (False, True)),
        (1.2749363039693, 1.2749363039696, (True, False)),
    ):
        for angle, paradox in zip((low, high), inside):
            assert rod(angle, 1.5, -9.81) == (NONE if paradox else ONE)
            assert rod(angle, 1.5, 9.81) == (SEVERAL if paradox else ONE)
    for mu in (4.0 / 3.0 - 1e-12, 4.0 / 3.0 + 1e-12):
        assert rod(math.atan(2.0), mu, -9.81) == (NONE if mu > 4.0 / 3.0 else ONE)


def test_block_on_a_wedge_without_friction() -> None:
    # wedge 3 kg, block 1 kg, 30 degrees (H. Goldstein, Classical Mechanics, chapter 1): speeds X, x, y
    alpha = math.radians(30.0)
    normal = np.array([[-math.sin(alpha), math.sin(alpha), math.cos(alpha)]])
    inverse = np.diag([1 / 3.0, 1.0, 1.0])
    free = np.array([0.0, 0.0, -9.81])
    code, found = law(normal @ inverse @ normal.T, normal @ free, [0], [0.0])
    a = free + inverse @ normal.T @ found["p"]
    assert code == ONE and found["mode"] == [SLIPS]
    assert abs(a[0] + 1.307032186326975865346) < 1e-14
    assert abs((a[1] - a[0]) * math.cos(alpha) - a[2] * math.sin(alpha) - 6.036923076923076923077) < 1e-14


def test_two_sided_contact_rubs_on_either_side() -> None:
    for push in (-3.0, 3.0):
        for mu, mode in ((0.5, STICKS), (0.2, SLIPS)):
            # a collar of 1 kg on a rod, pushed across it by 3 N and along it by 1 N
            code, found = law(np.eye(2), np.array([push, 1.0]), [1], [mu], two_sided=[1])
            assert code == ONE and found["mode"] == [mode]
            assert np.allclose(found["p"], [-push, -1.0 if mode == STICKS else -0.6], atol=1e-15)


def test_frozen_modes_have_the_forces_of_the_law() -> None:
    for W, b, n, chance in trials(60, 10, (1, 2, 3), 1):
        mu = list(chance.uniform(0.0, 0.5, n))
        code, found = law(W, b, [1] * n, mu)
        if code == ONE and np.linalg.matrix_rank(W) == 2 * n:
            work = in_python()["make"]()
            fill(work, W, b, [1] * n, mu, mode=found["mode"], direction=found["direction"])
            assert in_python()["solve_frozen"](work)
            assert np.allclose(values(work)["p"], found["p"], atol=1e-12 * np.max(np.abs(found["p"])))


def test_frozen_modes_that_contradict_each_other_are_refused() -> None:
    work = in_python()["make"]()
    fill(work, np.ones((2, 2)), np.array([-1.0, -2.0]), [0, 0], [0.0, 0.0], mode=[SLIPS, SLIPS])
    assert not in_python()["solve_frozen"](work)


def test_the_law_does_not_depend_on_units() -> None:
    for W, b, n, chance in trials(70, 6, (2, 3), 1):
        mu = list(chance.uniform(0.0, 1.0, n))
        code, found = law(W, b, [1] * n, mu)
        for mass, time in ((1e-12, 1.0), (1.0, 1e9), (1e15, 1e-6)):
            other, scaled = law(W / mass, b / time**2, [1] * n, mu)
            assert (other, scaled["mode"]) == (code, found["mode"])


@pytest.mark.parametrize(("terms", "closed"), [(0.0, [OPEN, SLIPS]), (1e6, [SLIPS, SLIPS])])
def test_accelerations_below_the_roundoff_of_their_terms_are_zero(terms: float, closed: list[int]) -> None:
    work = in_python()["make"]()
    fill(work, np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([1e-11, -1e-11]), [0, 0], [0.0, 0.0])
    work.law.terms[:2] = [terms, terms]
    assert in_python()["set_law"](work) == ONE
    assert values(work)["mode"] == closed


def test_a_paradox_names_its_contact() -> None:
    # a block that is pressed on the floor, and a rod as in the test of Painleve
    angle, W, b = 1.0, np.eye(4), np.array([-9.81, 0.0, -9.81, 0.5])
    rows = np.array([[0.0, 1.0, -math.cos(angle)], [1.0, 0.0, math.sin(angle)]])
    W[2:, 2:] = rows @ np.diag([1.0, 1.0, 3.0]) @ rows.T
    for lifts, code in ((-20.0, NONE), (9.81, SEVERAL)):
        work = in_python()["make"]()
        b[2] = lifts
        fill(work, W, b, [1, 1], [0.3, 1.5], moves=[0, 1], direction=[(0.0, 0.0), (-1.0, 0.0)])
        assert in_python()["set_law"](work) == code and work.law.culprit == 1


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not there")
def test_c_and_python_return_the_same_bits(tmp_path: Path) -> None:
    compiled, seen = KERNELS.c(tmp_path), Counter[int]()
    for slips in (0, 1, 2):
        for W, b, n, chance in trials(80 + slips, 24, (1, 2, 3, 5), slips):
            mu, works = list(chance.uniform(0.0, 1.0, n)), []
            for kernels in (compiled, in_python()):
                work = kernels["make"]()
                fill(work, W, b, [slips] * n, mu, restitution=[0.5] * n, poisson=[n % 2] * n)
                code = kernels["set_law"](work)
                seen[code] += 1
                works += [[code, *work.law.p, *work.law.u, *work.law.mode, *work.law.direction]]
                code = kernels["impact"](work)
                works[-1] += [code, *work.law.p, *work.law.u, *work.impact.loss, work.impact.rounds]
            assert works[0] == works[1]
    assert {ONE, FOUND} <= set(seen)
