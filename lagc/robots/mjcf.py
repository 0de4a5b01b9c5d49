"""From MJCF to a `Robot`: what MuJoCo has compiled from it, read from the arrays of its model."""

from importlib import import_module
from typing import Any

from lagc.diagnostics.faults import Fault, Refused
from lagc.robots.robot import GROUND, Coupling, Joint, Robot, lumped
from lagc.robots.xml import Element

KINDS = ("Free", "Spherical", "Prismatic", "Revolute")  # by mjtJoint
LEFT_OUT = {  # arrays whose length tells of things that a model here has no counterpart of
    "nu": "actuators: each joint has a motor instead", "nsensor": "sensors", "nkey": "keyframes",
    "npair": "pairs of contacts", "nflex": "flexible bodies", "nskin": "skins",
}  # fmt: skip


def robot_of(path: str, root: Element, free: bool) -> Robot:
    """Return the robot of the file, whose outermost element is `root`.  Raises Refused: without the package
    mujoco, for a file that it does not accept, and for loops that it closes by equations."""
    try:
        mujoco: Any = import_module("mujoco")
    except ImportError:
        message = "an MJCF file is read by MuJoCo, which is not installed"
        raise Refused([Fault("LAG0709", message, remedy="pip install mujoco")]) from None
    if free:
        raise Refused([Fault("LAG0709", "--free is for a URDF; in MJCF write <freejoint/>", root.span)])
    try:
        if path == "-":
            model = mujoco.MjModel.from_xml_string(root.source.text)
        else:
            model = mujoco.MjModel.from_xml_path(path)
    except ValueError as error:
        raise root.wrong(f"MuJoCo does not read this file: {error}") from None
    return _Reader(mujoco, model, root).read()


class _Reader:
    def __init__(self, mujoco: Any, model: Any, root: Element):
        self.mujoco, self.model, self.root = mujoco, model, root
        self.robot = Robot(root.attributes.get("model") or "Robot", root.source.name)
        self.data = mujoco.MjData(model)
        self.data.qpos[:] = model.qpos0
        mujoco.mj_kinematics(model, self.data)

    def read(self) -> Robot:
        self._refuse_loops()
        groups = {0: GROUND}  # the body of lagc that holds each body
        parts: dict[str, list[Any]] = {GROUND: []}
        for body in range(1, self.model.nbody):
            parent = groups[int(self.model.body_parentid[body])]
            first, count = int(self.model.body_jntadr[body]), int(self.model.body_jntnum[body])
            for k in range(first, first + count):
                own = self._name("BODY", body)
                own += "" if k == first + count - 1 else f"_{self._name('JOINT', k)}"
                parts.setdefault(own, [])
                self._add_joint(k, parent, own)
                parent = own
            groups[body] = parent
            parts[parent].append(self._inertia(body))
        self.robot.bodies += [lumped(name, found) for name, found in parts.items() if name != GROUND]
        self._couple()
        self.robot.gravity = self.model.opt.gravity.copy()
        self._tell()
        return self.robot

    def _name(self, kind: str, k: int) -> str:
        found = self.mujoco.mj_id2name(self.model, getattr(self.mujoco.mjtObj, f"mjOBJ_{kind}"), k)
        return found or f"{kind.lower()}{k}"

    def _inertia(self, body: int) -> tuple[float, Any, Any]:
        """Return mass, centre of mass, and inertia about it in the drawing."""
        import numpy as np

        turn, flat = np.zeros(4), np.zeros(9)
        self.mujoco.mju_mulQuat(turn, self.data.xquat[body], self.model.body_iquat[body])
        self.mujoco.mju_quat2Mat(flat, turn)
        axes = flat.reshape(3, 3)
        frame = self.data.xmat[body].reshape(3, 3)
        com = self.data.xpos[body] + frame @ self.model.body_ipos[body]
        return float(self.model.body_mass[body]), com, axes @ np.diag(self.model.body_inertia[body]) @ axes.T

    def _add_joint(self, k: int, parent: str, child: str) -> None:
        model, name = self.model, self._name("JOINT", k)
        kind, dof, q = KINDS[int(model.jnt_type[k])], int(model.jnt_dofadr[k]), int(model.jnt_qposadr[k])
        simple = kind in ("Prismatic", "Revolute")
        note = ""
        if simple and model.jnt_limited[k]:
            low, high = model.jnt_range[k] - model.qpos0[q]
            note = f"from {low:g} to {high:g} {'m' if kind == 'Prismatic' else 'rad'}"
        if simple and float(model.dof_frictionloss[dof]):
            self.robot.notes.append(
                f"joint `{name}`: frictionloss {model.dof_frictionloss[dof]:g} is not imported"
            )
        if kind == "Free":
            self._leave_out_of_free(name, dof)
        stiffness = float(model.jnt_stiffness[k].flat[0])
        if stiffness and not simple:
            self.robot.notes.append(f"joint `{name}`: stiffness {stiffness:g} is not imported")
        self.robot.joints.append(Joint(
            name, kind, parent, child,
            axis=self.data.xaxis[k].copy() if simple else None, at=self.data.xanchor[k].copy(),
            damping=0.0 if kind == "Free" else float(model.dof_damping[dof].flat[0]),
            armature=0.0 if kind == "Free" else float(model.dof_armature[dof]),
            stiffness=stiffness if simple else 0.0,
            rest=float(model.qpos_spring[q] - model.qpos0[q]) if simple else 0.0,
            driven=simple, note=note))  # fmt: skip

    def _leave_out_of_free(self, name: str, dof: int) -> None:
        for what in ("damping", "armature"):
            values = getattr(self.model, f"dof_{what}")[dof : dof + 6]
            if values.any():
                self.robot.notes.append(f"free joint `{name}`: {what} is not imported")

    def _refuse_loops(self) -> None:
        """Raise Refused for constraints that are no coupling of two joints: without them the robot would be
        another mechanism."""
        model, equality = self.model, self.mujoco.mjtEq.mjEQ_JOINT
        wrong = [self._name("EQUALITY", k) for k in range(model.neq) if model.eq_type[k] != equality]
        wrong += [self._name("TENDON", k) for k in range(model.ntendon)]
        if wrong:
            named = ", ".join(f"`{name}`" for name in wrong)
            remedy = "remove them, and write constraints or joints that close the loops into the model"
            raise self.root.wrong(f"equality constraints and tendons are not imported: {named}", remedy)

    def _couple(self) -> None:
        for k in range(self.model.neq):
            if not self.model.eq_active0[k]:
                self.robot.notes.append(
                    f"the inactive equality `{self._name('EQUALITY', k)}` is not imported"
                )
                continue
            follower, leader = int(self.model.eq_obj1id[k]), int(self.model.eq_obj2id[k])
            coefficients = [float(c) for c in self.model.eq_data[k][:5]]
            self.robot.couplings.append(Coupling(
                self._name("EQUALITY", k), self._name("JOINT", follower),
                self._name("JOINT", leader) if leader >= 0 else "",
                coefficients if leader >= 0 else coefficients[:1]))  # fmt: skip

    def _tell(self) -> None:
        model, notes = self.model, self.robot.notes
        for count, what in LEFT_OUT.items():
            if getattr(model, count, 0):
                notes.append(f"not imported: {getattr(model, count)} {what}")
        if model.ngeom:
            notes.append(f"not imported: contacts, and the shapes of {model.ngeom} geoms")
        if model.opt.density or model.opt.viscosity:
            notes.append("not imported: the fluid (density, viscosity)")
        if model.body_gravcomp.any():
            notes.append("not imported: gravity compensation (gravcomp)")
