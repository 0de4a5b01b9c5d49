"""Long chains: accelerations against an independent recursion along the links."""

import math

import numpy

import lagc


def test_small_swings_of_a_chain_are_its_normal_modes() -> None:
    links, link, g = 12, 0.2, 9.81
    share = numpy.array([links + 1.0 - max(i, j) for i in range(1, links + 1) for j in range(1, links + 1)])
    mass = link**2 * share.reshape(links, links)
    stiffness = numpy.diag([g * link * (links + 1.0 - i) for i in range(1, links + 1)])
    values, modes = numpy.linalg.eig(numpy.linalg.solve(mass, stiffness))
    slowest = int(numpy.argmin(values))
    w, mode = math.sqrt(values[slowest]), modes[:, slowest]
    # close to the hanging rope of the same length: the first zero of J0
    assert math.isclose(w, 1.2024 * math.sqrt(g / (links * link)), rel_tol=0.05)

    system = lagc.load("classic/chain").compile(parameters={"n": links})
    size = 1e-5  # the nonlinear terms are size^2 smaller
    starts = {f"th[{i + 1}]": size * float(m) for i, m in enumerate(mode)}
    run = system.simulate(2.0, method="dop853", rtol=1e-11, atol=1e-16, points=21, starts=starts)
    assert run.status == "ok", run.message
    for i, m in enumerate(mode):
        assert abs(run[f"th[{i + 1}]"] - size * m * numpy.cos(w * run.t)).max() <= 1e-8 * size
