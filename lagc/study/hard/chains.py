"""Long chains: accelerations against a recursion in 50 digits."""

from __future__ import annotations

from time import process_time
from typing import Any

import numpy as np

from lagc.simulation.system import Options
from lagc.study.hard.case import Case, Figure, Found, Lab
from lagc.study.hard.exact import chain_accelerations

ROUNDS = 5  # the fastest counts


def _random_state(n: int, angle: float) -> tuple[Any, Any]:
    """Angles and rates up to `angle` and twice as much."""
    random = np.random.default_rng(1)
    return random.uniform(-angle, angle, n), random.uniform(-2.0 * angle, 2.0 * angle, n)


def _error(lab: Lab, name: str, n: int, angle: float, masses: list[float], **parameters: float) -> float:
    model = lab.compile(name, parameters={"n": n, **parameters})
    angles, rates = _random_state(n, angle)
    found = model.rhs(0.0, [*angles, *rates])[n:]
    expected = np.array(chain_accelerations(angles.tolist(), rates.tolist(), masses, 0.2, 9.81))
    return float(abs(found - expected).max() / abs(expected).max())


def chain(lab: Lab) -> Found:
    n = 1000
    error = _error(lab, "classic/chain", n, 1.0, [1.0] * n)
    if lab.backend != "c":
        return Found((error, None), "right-hand side")
    model = lab.compile("classic/chain", parameters={"n": n})
    x = [1e-3] * n + [0.0] * n
    times = []
    for _ in range(ROUNDS):
        began = process_time()
        done = model.system.integrate(Options("rk4", step=1e-4), 0.0, x, [0.0, 0.025])
        times.append((process_time() - began) / done.rhs)
    said = f"{model.operations / n:.0f} operations a link"
    return Found((error, 1e6 * min(times)), "right-hand side", said)


def tip_mass(lab: Lab) -> Found:
    n = 100
    error = _error(lab, "hard/tip_mass", n, 1e-3, [1.0] * (n - 1) + [1e6], tip=1e6)
    return Found((error,), "right-hand side")


def tip_strings(lab: Lab) -> Found:
    n, link = 100, 0.2
    model = lab.compile("hard/tip_strings", parameters={"n": n, "tip": 1e6})
    angles, rates = _random_state(n, 1e-3)
    sine, cosine = np.sin(angles), np.cos(angles)
    state = [link * sine, -link * cosine, link * cosine * rates, link * sine * rates]
    found = model.rhs(0.0, [value for part in state for value in np.cumsum(part)])[2 * n : 3 * n]
    turns = chain_accelerations(angles.tolist(), rates.tolist(), [1.0] * (n - 1) + [1e6], link, 9.81)
    expected = np.cumsum(link * (cosine * np.array(turns) - sine * rates**2))
    return Found((float(abs(found - expected).max() / abs(expected).max()),), "right-hand side")


CASES = (
    Case(
        "chain", "a chain of 1,000 links",
        "A dense mass matrix has 10^6 entries and takes 3 10^8 operations to factor.",
        "The tridiagonal system of the tensions, an independent formulation, in 50 digits",
        "The lifted form carries the links' accelerations as unknowns: its elimination is a recursion along "
        "the chain, with a fixed number of operations for each link.",
        "classic/chain", "lagc sim chain -p n=1000 --stop 0.1",
        (Figure("accelerations, relative", 1e-12), Figure("an evaluation in C [us]", 50.0)), chain,
    ),
    Case(
        "tip_strings", "100 strings, nearly straight, with a tip 1e6 times as heavy as a bob",
        "Tensions are 1e6 times the weight of a bob, and the mass matrix has a condition number above 1e8.",
        "The tridiagonal system of the tensions, an independent formulation, in 50 digits",
        "The residual of each solution is watched; a step of iterative refinement with it brings the "
        "error to that of the terms of one equation (N. J. Higham, Accuracy and Stability, 2002, chapter "
        "12).",
        "hard/tip_strings", "lagc sim tip_strings -p n=100 -p tip=1e6 --stop 1e-3",
        (Figure("accelerations, relative", 1e-13),), tip_strings,
    ),
    Case(
        "tip_angles", "the same chain in angles",
        "The condition number of the mass matrix is above 1e8: a dense solution loses that many digits.",
        "The tridiagonal system of the tensions, an independent formulation, in 50 digits",
        "Articulated bodies are eliminated link by link.  The inertia of the tip across its link is a "
        "difference of numbers 1e6 times as large, which costs digits that one refinement would bring back; "
        "it is made for models with constraints alone.",
        "hard/tip_mass", "lagc sim tip_mass -p n=100 -p tip=1e6 --stop 1e-3",
        (Figure("accelerations, relative", 1e-13),), tip_mass,
    ),
)  # fmt: skip
