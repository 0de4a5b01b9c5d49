"""Robots from URDF: closed forms of small ones, names, rounding, and files that are refused."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused, Source
from lagc.robots.robot import meant
from lagc.robots.text import model
from lagc.robots.urdf import robot_of
from lagc.robots.xml import parse

PENDULUM = """<?xml version="1.0"?>
<robot name="physical pendulum">
  <link name="base"/>
  <link name="rod">
    <inertial>
      <origin xyz="0 0 -0.3" rpy="0 1.5707963 0"/>
      <mass value="2"/>
      <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.06"/>
    </inertial>
    <visual/>
  </link>
  <link name="tip"><inertial><mass value="0.5"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
  <joint name="pin" type="continuous">
    <origin xyz="0 0 1"/><parent link="base"/><child link="rod"/><axis xyz="0 2 0"/>
    <dynamics damping="0.04" friction="0.1"/>
  </joint>
  <joint name="end" type="fixed">
    <origin xyz="0 0 -0.6"/><parent link="rod"/><child link="tip"/>
  </joint>
</robot>
"""
CART = """<robot name="cart-pole">
  <link name="world"/>
  <link name="cart"><inertial><origin xyz="0 0.2 0"/><mass value="3"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="pole"><inertial><origin xyz="0 0 0.5"/><mass value="0.4"/>
    <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.001"/></inertial></link>
  <joint name="rail" type="prismatic"><parent link="world"/><child link="cart"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="100" velocity="2"/></joint>
  <joint name="model" type="revolute"><origin xyz="0.1 0 0.05"/><parent link="cart"/><child link="pole"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="0" velocity="9"/></joint>
</robot>
"""
GEARS = """<robot name="gears">
  <link name="frame"/>
  <link name="one"><inertial><mass value="1"/>
    <inertia ixx="0.2" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.3"/></inertial></link>
  <link name="two"><inertial><mass value="1"/>
    <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.03"/></inertial></link>
  <joint name="a" type="continuous"><parent link="frame"/><child link="one"/><axis xyz="0 0 1"/></joint>
  <joint name="b" type="continuous"><origin xyz="1 0 0"/><parent link="frame"/><child link="two"/>
    <axis xyz="0 0 1"/><mimic joint="a" multiplier="-3" offset="0.5"/></joint>
</robot>
"""


def imported(text: str, free: bool = False, exact: bool = False) -> tuple[Any, str]:
    """The robot and its model."""
    robot = robot_of(parse(Source("robot.urdf", text)), free, exact)
    return robot, model(robot, exact)


def system_of(text: str, **given: bool) -> Any:
    return lagc.loads(imported(text, **given)[1], "robot.lag").compile(backend="numpy")


def test_a_physical_pendulum() -> None:
    """(J + m d^2 + m' l^2) a = -(m d + m' l) g sin - c w + tau, about the pin."""
    system = system_of(PENDULUM)
    J = 0.06 + 2 * 0.09 + 0.5 * 0.36
    for angle, rate, tau in ((0.3, 0.0, 0.0), (2.0, -1.5, 0.7), (-1.0, 4.0, -2.0)):
        found = system.rhs(0.0, [angle, rate], {"tau_pin": tau})[1]
        wanted = (-(2 * 0.3 + 0.5 * 0.6) * 9.81 * math.sin(angle) - 0.04 * rate + tau) / J
        assert found == pytest.approx(wanted, rel=1e-12)
    robot, text = imported(PENDULUM)
    assert "dry friction 0.1 of joint `pin`" in robot.notes[0] and "1 <visual>" in text
    assert "inertia = {0.4" not in text and "axis = world.y" in text and "1.57" not in text


def test_a_cart_with_a_pole() -> None:
    """(M + m) x'' + m d (a cos - w^2 sin) = f,  m d x'' cos + (J + m d^2) a - m g d sin = tau."""
    system = system_of(CART)
    M, m, d, J = 3.0, 0.4, 0.5, 0.02
    for angle, rate, force, torque in ((0.2, 0.0, 0.0, 0.0), (-1.2, 3.0, 5.0, 0.3)):
        mass = np.array([[M + m, m * d * math.cos(angle)], [m * d * math.cos(angle), J + m * d * d]])
        right = [force + m * d * rate**2 * math.sin(angle), torque + m * 9.81 * d * math.sin(angle)]
        x = [0.1, angle, -0.5, rate]
        found = system.rhs(0.0, x, {"f_rail": force, "tau_model_joint": torque})[2:]
        assert found == pytest.approx(np.linalg.solve(mass, right), rel=1e-12)
    assert "// rail: from -1 to 1 m, effort to 100 N, velocity to 2 m/s" in imported(CART)[1]


def test_a_joint_that_mimics_another_one() -> None:
    """(J1 + 9 J2) a = tau: the second wheel turns three times as fast, and back."""
    system = system_of(GEARS)
    x = system.start()
    assert x[1] == pytest.approx(0.5 - 3 * x[0])
    found = system.rhs(0.0, x, {"tau_a": 2.0})[2:]
    assert found == pytest.approx([2 / (0.3 + 9 * 0.03), -6 / (0.3 + 9 * 0.03)], rel=1e-12)
    assert [u.name for u in system.interface.inputs] == ["tau_a"]


def test_a_free_body() -> None:
    """Euler's equations of a free body that falls, with a fixed part: about the common centre of mass."""
    text = CART.replace('type="prismatic"', 'type="fixed"').replace('type="revolute"', 'type="fixed"')
    system = system_of(text, free=True)
    names = system.state_names
    x = np.zeros(len(names))
    x[names.index("floating.orientation.w")] = 1.0
    w = np.array([0.3, -2.0, 1.1])
    for axis, value in zip("xyz", w):
        x[names.index(f"floating.orientation.rate.{axis}")] = value
    parts = [
        (3.0, np.array([0, 0.2, 0]), np.eye(3)),
        (0.4, np.array([0.1, 0, 0.55]), np.diag([0.02, 0.02, 0.001])),
    ]
    com = sum(m * r for m, r, _ in parts) / 3.4
    J = sum(own + m * ((r - com) @ (r - com) * np.eye(3) - np.outer(r - com, r - com)) for m, r, own in parts)
    xdot = system.rhs(0.0, x)
    turn = [xdot[names.index(f"floating.orientation.rate.{axis}")] for axis in "xyz"]
    wanted = np.linalg.solve(J, -np.cross(w, J @ w))
    assert turn == pytest.approx(wanted, rel=1e-9)
    fall = [xdot[names.index(f"der(floating.{axis})")] for axis in "xyz"]
    # The joint follows the origin of the base: the centre of mass falls freely.
    of_origin = np.array([0, 0, -9.81]) - np.cross(wanted, com) - np.cross(w, np.cross(w, com))
    assert fall == pytest.approx(of_origin, rel=1e-8, abs=1e-8)


def test_a_free_link_without_mass_is_named() -> None:
    assert "link `frame` moves freely and has no mass: give it one" in imported(GEARS, free=True)[0].notes


def test_names_and_formatting(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Names that the language does not have, keywords, and names that become equal; the text is formatted."""
    text = GEARS.replace('"one"', '"left-wheel"').replace('"two"', '"left wheel"').replace('"a"', '"end"')
    text = text.replace('name="gears"', 'name="3 &quot;gears&quot; \u00e9"')
    (tmp_path / "robot.urdf").write_text(text, encoding="utf-8")
    made = tmp_path / "robot.lag"
    assert main(["import", str(tmp_path / "robot.urdf"), "-o", str(made)]) == 0
    assert main(["import", str(tmp_path / "robot.urdf"), "-o", str(made)]) == 2
    assert "--force" in capsys.readouterr().err
    assert main(["import", str(tmp_path / "robot.urdf"), "-o", str(tmp_path / "far" / "robot.lag")]) == 2
    assert "there is no folder" in capsys.readouterr().err
    assert main(["fmt", "--check", str(made)]) == 0 and main(["check", str(made)]) == 0
    assert "body left_wheel_body" in made.read_text() and "joint end_joint" in made.read_text()


@pytest.mark.parametrize(
    ("text", "value"),
    [("1.5708", math.pi / 2), ("1.570796", math.pi / 2), ("-3.1415", -math.pi), ("0.26179938", math.pi / 12),
     ("1.57", 1.57), ("1.5707", math.pi / 2), ("1.5709", 1.5709), ("0", 0.0), ("0.00000", 0.0),
     ("1.2345", 1.2345), ("1.5708e0", 1.5708)],
)  # fmt: skip
def test_angles_that_are_meant(text: str, value: float) -> None:
    """A multiple of 15 deg is one that is rounded or cut to all digits that are written, at least five."""
    assert meant(text) == value


def test_rounding_and_exactness() -> None:
    """An axis that is off by round-off of an angle becomes exact, and that is said; --exact keeps it."""
    text = PENDULUM.replace('<origin xyz="0 0 1"/>', '<origin xyz="0 0 1" rpy="1.57079632679 0 0"/>')
    text = text.replace('axis xyz="0 2 0"', 'axis xyz="0 0 -1"')
    robot, rounded = imported(text)
    assert "axis = world.y" in rounded and any("rounded: 2 angles" in note for note in robot.notes)
    _, kept = imported(text, exact=True)
    assert "axis = world.y" not in kept and "rounded" not in kept


def test_an_inertia_that_no_body_has() -> None:
    """It is named, and the nearest one that a body has is written."""
    robot, text = imported(GEARS.replace('iyz="0" izz="0.3"', 'iyz="0" izz="0.9"'))
    (fault,) = robot.warnings
    assert fault.code == "LAG0708" and "0.2, 0.2, 0.9" in fault.message and fault.line == 4
    assert "inertia = {0.2, 0.2, 0.4}" in text


BOMB = """<?xml version="1.0"?>
<!DOCTYPE lolz [<!ENTITY lol "lol"><!ENTITY lol1 "&lol;&lol;&lol;&lol;&lol;&lol;&lol;&lol;&lol;&lol;">
<!ENTITY lol2 "&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;">]>
<robot name="&lol2;"/>
"""
ONE, TWO = [f'<parent link="frame"/><child link="{name}"/>' for name in ("one", "two")]
WRONG = {
    "a bomb": (BOMB, "document type"),
    "a file": ('<!DOCTYPE r [<!ENTITY f SYSTEM "file:///etc/passwd">]><robot name="&f;"/>', "document type"),
    "no XML": ("model Pendulum", "no XML"),
    "nothing": ("", "no XML"),
    "cut": (GEARS[:200], "no XML"),
    "another format": ("<sdf/>", "begins with <robot>"),
    "xacro": ('<robot name="r"><xacro:include filename="x"/></robot>', "xacro"),
    "no link": ('<robot name="r"/>', "no <link>"),
    "two parents": (GEARS.replace('child link="two"', 'child link="one"'), "child of two joints"),
    "two roots": (GEARS.replace("</robot>", '<link name="three"/></robot>'), "there are 2: `frame`, `three`"),
    "a circle": (GEARS.replace(ONE, ONE.replace("frame", "two")).replace(TWO, TWO.replace("frame", "one")),
                 "circle"),
    "an unknown link": (GEARS.replace('parent link="frame"', 'parent link="fram"'), "no link `fram`"),
    "an unknown leader": (GEARS.replace('joint="a"', 'joint="c"'), "no joint `c`"),
    "no mass": (GEARS.replace('<mass value="1"/>', ""), "has no <mass>"),
    "a negative mass": (GEARS.replace('mass value="1"', 'mass value="-1"'), "not negative"),
    "no number": (GEARS.replace('mass value="1"', 'mass value="1 kg"'), "a finite number"),
    "not finite": (GEARS.replace('mass value="1"', 'mass value="nan"'), "a finite number"),
    "two numbers": (GEARS.replace('xyz="1 0 0"', 'xyz="1 0"'), "3 finite numbers"),
    "no axis": (GEARS.replace('axis xyz="0 0 1"', 'axis xyz="0 0 0"'), "is zero"),
    "a kind": (GEARS.replace('type="continuous"', 'type="ball"', 1), "`ball` is none"),
    "no type": (GEARS.replace(' type="continuous"', "", 1), "no attribute `type`"),
    "no name": (GEARS.replace('link name="two"', 'link name=""'), "has a name"),
    "two links": (GEARS.replace('link name="two"', 'link name="one"'), "two <link>"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_files_that_are_refused(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A diagnostic with a place, no traceback, and nothing is written."""
    text, said = WRONG[name]
    file, made = tmp_path / "robot.urdf", tmp_path / "robot.lag"
    file.write_text(text)
    assert main(["import", str(file), "-o", str(made)]) == 1
    error = capsys.readouterr().err
    assert "LAG0707" in error and said in error and not made.exists()
    assert "robot.urdf:" in error and ":0" not in error


def test_a_file_that_is_not_there(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "no_robot.urdf"]) != 0
    assert "no_robot.urdf" in capsys.readouterr().err


def test_every_beginning_of_a_file_is_refused() -> None:
    for text in (PENDULUM, CART):
        for end in range(0, len(text) - 12, 7):
            with pytest.raises(Refused) as found:
                imported(text[:end])
            assert found.value.code == "LAG0707"


def test_a_long_chain() -> None:
    """Its depth is no limit of the importer."""
    n = 3000
    links = "".join(f'<link name="l{k}"/>' for k in range(n + 1))
    joints = "".join(
        f'<joint name="j{k}" type="fixed"><parent link="l{k}"/><child link="l{k + 1}"/></joint>'
        for k in range(n)
    )
    robot = robot_of(parse(Source("chain.urdf", f'<robot name="chain">{links}{joints}</robot>')), True, False)
    assert len(robot.bodies) == 1 and len(robot.joints) == 1
