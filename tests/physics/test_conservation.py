"""What is conserved stays so; what is not, does what theory says."""

import numpy
import pytest

from tests.physics.runs import motion, spread

# runs are asked for 1e-10 of the state; conserved quantities are functions of the state
TOLERANCE = 1e-8


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("name", "stop"),
    [
        ("course/simple_pendulum", 10.0), ("course/string_pendulum", 5.0), ("classic/double_pendulum", 3.0),
        ("classic/chain", 2.0), ("classic/elastic_pendulum", 10.0), ("classic/henon_heiles", 50.0),
        ("classic/pleiades", 1.0), ("classic/relativistic_particle", 10.0), ("classic/rolling_disc", 2.0),
        ("classic/gyroscope", 0.2), ("classic/four_bar", 5.0),
    ],
)  # fmt: skip
def test_energy_of_a_conservative_system(name: str, stop: float) -> None:
    # a speed of the gyroscope moves by 6e-3 rad/s, with terms of 300 rad/s
    run = motion(name, stop, points=51, accuracy=1e-9 if name == "classic/gyroscope" else 1e-10)
    energy = run.energy
    assert energy.work == 0.0
    assert abs(energy.imbalance) <= TOLERANCE * max(1.0, abs(energy.start))


def test_kepler_keeps_angular_momentum_and_the_direction_of_the_pericentre() -> None:
    run = motion("classic/kepler", 20.0, "comet")
    assert spread(run["L"]) <= TOLERANCE
    assert spread(run["ex"]) <= TOLERANCE
    assert spread(run["ey"]) <= TOLERANCE
    assert abs(run["ex"][0] - 0.9) <= 1e-12


def test_spherical_pendulum_keeps_its_momentum_about_the_vertical() -> None:
    assert spread(motion("classic/spherical_pendulum", 5.0)["Lz"]) <= TOLERANCE


def test_heavy_top_has_three_integrals() -> None:
    run = motion("classic/heavy_top", 10.0)
    for name in ("E", "Lz", "L3"):
        assert spread(run[name]) <= TOLERANCE


def test_free_top_keeps_its_angular_momentum_in_space() -> None:
    run = motion("classic/euler_top", 10.0)
    w, x, y, z = (run[f"o.{i}"] for i in "wxyz")
    l1, l2, l3 = 3.0 * run["w1"], 2.0 * run["w2"], 1.0 * run["w3"]
    rotation = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    for row in rotation:
        assert spread(row[0] * l1 + row[1] * l2 + row[2] * l3) <= TOLERANCE


def test_bead_on_a_driven_hoop_keeps_the_jacobi_integral_and_not_its_energy() -> None:
    run = motion("classic/bead_on_hoop", 3.0)
    momentum = run["x"] * run["der(y)"] - run["y"] * run["der(x)"]
    assert spread(run["E"] - 6.0 * momentum) <= TOLERANCE * 20.0
    assert spread(run["E"]) > 1.0


def test_bead_on_a_free_hoop_keeps_energy_and_angular_momentum() -> None:
    run = motion("classic/spinning_hoop", 5.0)
    assert spread(run["E"]) <= TOLERANCE * 10.0
    assert spread(run["p"]) <= TOLERANCE * 10.0


@pytest.mark.parametrize(
    ("name", "stop", "accuracy"), [("arenstorf_orbit", 17.0, 1e-8), ("lagrange_points", 50.0, 1e-10)]
)
def test_jacobi_integral_of_the_restricted_three_bodies(name: str, stop: float, accuracy: float) -> None:
    """Close encounters make rounding grow: orbits of Arenstorf that start an ulp apart end 2e-9 apart."""
    assert spread(motion(f"classic/{name}", stop, accuracy=accuracy)["jacobi"]) <= 1e-7


@pytest.mark.full
def test_isolated_bodies_keep_their_momentum() -> None:
    run = motion("classic/two_bodies_on_a_spring", 5.0)
    for name, value in (("px", 0.0), ("py", 2.0), ("pz", 0.8)):
        assert numpy.abs(run[name] - value).max() <= TOLERANCE
    run = motion("classic/pleiades", 1.0)
    assert spread(run["px"]) <= 1e-7 and spread(run["py"]) <= 1e-7


def test_sleigh_keeps_its_energy_and_not_its_momentum() -> None:
    run = motion("classic/chaplygin_sleigh", 5.0)
    assert spread(run["E"]) <= TOLERANCE
    assert spread(run["der(x)"]) > 0.5


def test_geodesic_of_the_torus_has_constant_speed_and_clairauts_integral() -> None:
    run = motion("classic/particle_on_torus", 10.0)
    assert spread(run["E"]) <= TOLERANCE * 2.0
    assert spread(run["Lz"]) <= TOLERANCE * 6.0


def test_toda_lattice_keeps_the_eigenvalues_of_flaschkas_matrix() -> None:
    run = motion("classic/toda_lattice", 10.0, points=11)
    n = 6
    found = []
    for k in range(len(run)):
        x = [run[f"x[{i}]"][k] for i in range(1, n + 1)]
        p = [run[f"der(x[{i}])"][k] for i in range(1, n + 1)]
        a = [0.5 * numpy.exp(-0.5 * (x[(i + 1) % n] - x[i])) for i in range(n)]
        matrix = numpy.diag([0.5 * v for v in p])
        for i in range(n):
            j = (i + 1) % n
            matrix[i, j] += a[i]
            matrix[j, i] += a[i]
        found.append(numpy.linalg.eigvalsh(matrix))
    assert numpy.ptp(found, axis=0).max() <= TOLERANCE


def test_swinging_atwood_machine_of_ratio_three_has_a_second_integral() -> None:
    # N. B. Tufillaro, Am. J. Phys. 54 (1986) 142
    run = motion("classic/swinging_atwood_machine", 1.5)
    r, theta, v, w = run["r"], run["theta"], run["der(r)"], run["der(theta)"]
    half = theta / 2.0
    integral = (
        r**2 * w * (v * numpy.cos(half) - r * w / 2.0 * numpy.sin(half))
        + 9.81 * r**2 * numpy.sin(half) * numpy.cos(half) ** 2
    )
    assert spread(integral) <= 1e-7


def test_wedge_and_block_keep_their_horizontal_momentum() -> None:
    assert spread(motion("classic/wedge_and_block", 1.0)["p"]) <= TOLERANCE


def test_axis_of_the_gimballed_rotor_keeps_its_spin() -> None:
    run = motion("classic/gyroscope", 0.2, accuracy=1e-9)
    assert spread(run["L3"]) <= TOLERANCE * 0.12


def test_wheels_of_the_cart_differ_by_the_turn() -> None:
    # the one integrable relation among the rolling constraints, 2 b theta = r (phi2 - phi1)
    run = motion("classic/wheelset", 3.0, "driven")
    assert numpy.abs(2 * 0.3 * run["theta"] - 0.1 * (run["phi2"] - run["phi1"])).max() <= TOLERANCE


def test_drag_takes_the_energy_it_is_said_to_take() -> None:
    run = motion("course/simple_pendulum", 5.0, "room")
    assert run.energy.work < 0.0
    assert abs(run.energy.imbalance) <= TOLERANCE * abs(run.energy.start)
