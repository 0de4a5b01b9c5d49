"""Robots from MJCF, and public robots from URDF, beside MuJoCo: the same accelerations at random states.

`pip install mujoco example-robot-data` brings both; without them these tests are skipped.
"""

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from lagc.robots.read import robot_of
from lagc.robots.text import _Writer
from tests.robots.test_urdf import CART, PENDULUM

LEG = """<mujoco model="leg">
  <compiler angle="degree"/>
  <option gravity="0.5 0 -9.81"/>
  <default><joint damping="0.1"/></default>
  <worldbody>
    <body name="hip" pos="0.1 0 1" euler="0 20 0">
      <joint name="hip_x" axis="1 0 0" pos="0 0 0.05" armature="0.01" frictionloss="0.3"/>
      <joint name="hip_y" axis="0 1 0" stiffness="3" springref="10" ref="5" range="-30 60" limited="true"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03"/>
      <body name="foot" pos="0 0 -0.4">
        <joint name="slide" type="slide" axis="0 0 1" range="-0.1 0.1" limited="true"/>
        <geom type="sphere" size="0.05" mass="0.3"/>
        <body name="heel" pos="0.05 0 0" euler="30 0 0">
          <geom type="box" size=".01 .02 .03" mass="0.1"/>
        </body>
      </body>
      <body name="counter" pos="0 0 -0.1">
        <joint name="counter" axis="0 1 0"/>
        <geom type="box" size="0.05 0.02 0.02" pos="0.1 0 0" mass="0.2"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="hip_x"/></actuator>
</mujoco>
"""
TENDON = '<fixed name="t"><joint joint="slide" coef="1"/></fixed>'
END = "</worldbody>"
COUPLED = LEG.replace(
    END,
    """</worldbody>
  <equality><joint name="gear" joint1="counter" joint2="hip_y" polycoef="0.1 -0.5 0.3 0 0"/></equality>""",
)
BALL = """<mujoco model="ball">
  <worldbody>
    <body name="base" pos="0 0 1"><freejoint name="root"/>
      <inertial pos="0 0 0.02" mass="5" diaginertia="0.1 0.12 0.14"/>
      <body name="head" pos="-0.1 0 0.2">
        <joint name="neck" type="ball" pos="0 0 -0.1" damping="0.2" armature="0.02"/>
        <geom type="box" size="0.05 0.06 0.07" mass="1"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
pytestmark = [pytest.mark.long, pytest.mark.skipif(find_spec("mujoco") is None, reason="there is no MuJoCo")]


def written(path: Path, exact: bool = True) -> tuple[Any, dict[str, str], str]:
    """The robot of a file, the joints by their names in the text, and the text."""
    writer = _Writer(robot_of(str(path), exact=exact), exact)
    text = writer.text()
    return (
        writer.robot,
        {writer.names.of("joint", joint.name): joint.name for joint in writer.robot.joints},
        text,
    )


def difference(path: Path, mujoco_model: Any) -> float:
    """The largest relative difference of accelerations, at ten random states and loads of the joints."""
    import mujoco

    m, d = mujoco_model, mujoco.MjData(mujoco_model)
    m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    _, joints, text = written(path)
    system = lagc.loads(text, "robot.lag").compile(backend="numpy")
    own = system.interface
    ids = [mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_JOINT, joints[q.rsplit(".", 1)[0]]) for q in own.q_names]
    rng, worst = np.random.default_rng(1), 0.0
    for _ in range(10):
        q, v, load = rng.uniform(-1, 1, own.nq), rng.uniform(-2, 2, own.nv), rng.uniform(-5, 5, own.nv)
        inputs = {}
        for k, joint in enumerate(ids):
            d.qpos[m.jnt_qposadr[joint]] = m.qpos0[m.jnt_qposadr[joint]] + q[k]
            d.qvel[m.jnt_dofadr[joint]], d.qfrc_applied[m.jnt_dofadr[joint]] = v[k], load[k]
            named = [
                u.name for u in own.inputs if u.name.split("_", 1)[1] == own.q_names[k].rsplit(".", 1)[0]
            ]
            inputs.update(dict.fromkeys(named, load[k]))
        mujoco.mj_forward(m, d)
        found = system.rhs(0.0, [*q, *v], inputs)[own.nq :]
        wanted = np.array([d.qacc[m.jnt_dofadr[joint]] for joint in ids])
        worst = max(worst, abs(found - wanted).max() / abs(wanted).max())
    return worst


def plain_urdf(text: str) -> Any:
    """MuJoCo's model of a URDF without shapes and dry friction, under gravity."""
    import mujoco

    robot = ET.fromstring(text)
    for link in robot.findall("link"):
        for element in (*link.findall("visual"), *link.findall("collision")):
            link.remove(element)
    for element in robot.findall("mujoco"):
        robot.remove(element)
    extra = ET.SubElement(robot, "mujoco")
    ET.SubElement(extra, "compiler", fusestatic="true", discardvisual="true", inertiafromgeom="false")
    model = mujoco.MjModel.from_xml_string(ET.tostring(robot, encoding="unicode"))
    model.dof_frictionloss[:] = 0
    model.opt.gravity[:] = 0, 0, -9.81
    return model


def test_hinges_slides_rotors_and_springs(tmp_path: Path) -> None:
    import mujoco

    (tmp_path / "leg.xml").write_text(LEG)
    model = mujoco.MjModel.from_xml_string(LEG)
    model.dof_frictionloss[:] = 0
    assert difference(tmp_path / "leg.xml", model) < 1e-12
    robot, _, text = written(tmp_path / "leg.xml")
    assert "g = 9.82273" in text and "frictionloss 0.3" in " ".join(robot.notes)
    assert any("1 actuators" in note for note in robot.notes) and "from -0.610865 to 0.959931 rad" in text


def test_a_coupling_of_joints(tmp_path: Path) -> None:
    """counter - ref = 0.1 - 0.5 y + 0.3 y^2, with y the angle of the hip from its reference."""
    (tmp_path / "leg.xml").write_text(COUPLED)
    system = lagc.loads(written(tmp_path / "leg.xml")[2], "leg.lag").compile(backend="numpy")
    x = dict(zip(system.state_names, system.start(**{"hip_y.angle": 0.2})))
    y = x["hip_y.angle"]
    assert x["counter_joint.angle"] == pytest.approx(0.1 - 0.5 * y + 0.3 * y * y, abs=1e-12)


def test_balls_and_free_joints(tmp_path: Path) -> None:
    """The same energies, and rates of them, as MuJoCo at states with the same velocities of bodies."""
    import mujoco

    (tmp_path / "ball.xml").write_text(BALL)
    _, _, text = written(tmp_path / "ball.xml")
    system = lagc.loads(text, "ball.lag").compile(backend="numpy")
    m = mujoco.MjModel.from_xml_string(BALL)
    d = mujoco.MjData(m)
    names = list(system.state_names)
    rng = np.random.default_rng(2)
    v = rng.uniform(-1, 1, 9)
    d.qvel[:] = v  # in the reference configuration the axes of all bodies are those of the world
    mujoco.mj_forward(m, d)
    x = np.zeros(len(names))
    for joint in ("root", "neck"):
        x[names.index(f"{joint}.orientation.w")] = 1.0
    speeds = [f"der(root.{a})" for a in "xyz"] + [
        f"{j}.orientation.rate.{a}" for j in ("root", "neck") for a in "xyz"
    ]
    for name, value in zip(speeds, v):
        x[names.index(name)] = value
    found = system.rhs(0.0, x)
    assert [found[names.index(name)] for name in speeds] == pytest.approx(list(d.qacc), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("text", [PENDULUM, CART], ids=["pendulum", "cart"])
def test_small_robots(text: str, tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_text(text)
    assert difference(tmp_path / "robot.urdf", plain_urdf(text)) < 1e-12


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (LEG.replace(END, f'{END}<equality><weld name="w" body1="foot"/></equality>'), "`w`"),
        (LEG.replace(END, f"{END}<tendon>{TENDON}</tendon>"), "`t`"),
        (LEG.replace("capsule", "caps"), "MuJoCo does not read"),
        ("<mujoco><worldbody><body/></worldbody></mujoco>" + "x", "no XML"),
    ],
)  # fmt: skip
def test_files_that_are_refused(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "robot.xml").write_text(text)
    with pytest.raises(Refused, match=said):
        robot_of(str(tmp_path / "robot.xml"))


def test_a_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "leg.xml").write_text(COUPLED)
    made = tmp_path / "leg.lag"
    assert main(["import", str(tmp_path / "leg.xml"), "-o", str(made)]) == 0
    assert main(["fmt", "--check", str(made)]) == 0 and main(["check", str(made)]) == 0
    assert main(["import", str(tmp_path / "leg.xml"), "--free"]) == 1
    assert main(["import", str(tmp_path / "leg.xml"), "--json"]) == 0


PUBLIC = ("ur5_robot", "solo12", "a1", "kinova", "xarm7", "z1", "so100", "TwoDofs")


def public_robots() -> Sequence[Path]:
    """The files of the package example-robot-data."""
    spec = find_spec("cmeel")
    roots = list(spec.submodule_search_locations or ()) if spec else []
    folders = [Path(root).parent / "cmeel.prefix" for root in roots]
    return sorted(path for folder in folders for path in folder.rglob("*.urdf") if path.stem in PUBLIC)


def test_public_robots() -> None:
    if not (found := public_robots()):
        pytest.skip("there is no example-robot-data")
    for path in found:
        assert difference(path, plain_urdf(path.read_text())) < 1e-12, path.stem
