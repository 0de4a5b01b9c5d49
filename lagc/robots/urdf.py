"""From URDF to a `Robot`, with NumPy alone.

Links that fixed joints connect become one body.  The drawing is the configuration in which all joints are at
zero.
"""

from collections import Counter
from typing import Any

from lagc.diagnostics.faults import Fault
from lagc.robots.robot import GROUND, Coupling, Joint, Matrix, Robot, Vector, lumped, meant, possible
from lagc.robots.xml import Element

KINDS = {"revolute": "Revolute", "continuous": "Revolute", "prismatic": "Prismatic", "floating": "Free",
         "planar": "Planar"}  # fmt: skip
IMPORTED = {"inertial", "origin", "mass", "inertia", "parent", "child", "axis", "dynamics", "limit", "mimic"}
Frame = tuple[Matrix, Vector]  # axes as columns, and the origin, in the drawing
Parts = dict[str, list[tuple[float, Vector, Matrix]]]


def robot_of(root: Element, free: bool, exact: bool) -> Robot:
    """Return the robot of an element <robot>.  `free`: its root link moves freely, else it is the world.
    `exact`: take angles as they are written.  Raises Refused."""
    if root.tag != "robot":
        raise root.wrong(f"a URDF begins with <robot>, not <{root.tag}>")
    for element in root.children:
        if element.tag.startswith("xacro:"):
            remedy = "run `xacro FILE > robot.urdf` first"
            raise element.wrong("this is a xacro file, from which a URDF is made", remedy)
    return _Reader(root, free, exact).read()


class _Reader:
    def __init__(self, root: Element, free: bool, exact: bool):
        self.root, self.free, self.exact = root, free, exact
        self.links = _named(root, "link")
        self.joints = _named(root, "joint")
        self.robot = Robot(root.attributes.get("name") or "Robot", root.source.name)
        self.angles: list[float] = []  # changes of those that are taken as multiples of 15 deg

    def read(self) -> Robot:
        base = self._base()
        first = base if self.free else GROUND
        parts: Parts = {first: []}
        frames = {base: self._identity()}
        if self.free:
            self.robot.joints.append(
                Joint("floating", "Free", GROUND, base, at=self._identity()[1], driven=False)
            )
        children: dict[str, list[Element]] = {}
        for joint in self.joints.values():
            children.setdefault(self._link(joint, "parent"), []).append(joint)
        waiting = [(base, first)]
        while waiting:
            link, group = waiting.pop()
            self._add_inertia(self.links[link], frames[link], parts[group])
            for joint in children.get(link, ()):
                child = self._link(joint, "child")
                frames[child] = self._placed(frames[link], joint)
                own = group
                if joint.get("type") != "fixed":
                    own = child
                    parts[own] = []
                    self.robot.joints.append(self._joint(joint, group, child, frames[child]))
                waiting.append((child, own))
        order = [first, *(joint.child for joint in self.robot.joints)]
        for name in dict.fromkeys(name for name in order if name != GROUND):
            self._add_body(name, parts[name])
        self._couple()
        self._tell()
        return self.robot

    def _base(self) -> str:
        """Return the root of the tree of links.  Raises Refused if the joints make none."""
        if not self.links:
            raise self.root.wrong("the robot has no <link>")
        above: dict[str, Element] = {}
        for joint in self.joints.values():
            child = self._link(joint, "child")
            if child in above:
                raise joint.wrong(f"link `{child}` is the child of two joints; a URDF is a tree")
            above[child] = joint
        roots = [name for name in self.links if name not in above]
        if len(roots) != 1:
            named = ", ".join(f"`{name}`" for name in roots) or "none: the joints make a circle"
            raise self.root.wrong(
                f"a robot has one link without a parent; here there are {len(roots)}: {named}"
            )
        seen, waiting = set(roots), list(roots)
        below: dict[str, list[str]] = {}
        for child, joint in above.items():
            below.setdefault(self._link(joint, "parent"), []).append(child)
        while waiting:
            more = below.get(waiting.pop(), [])
            seen.update(more)
            waiting += more
        lost = next((name for name in self.links if name not in seen), None)
        if lost is not None:
            raise self.links[lost].wrong(f"the joints around link `{lost}` make a circle; a URDF is a tree")
        return roots[0]

    def _link(self, joint: Element, which: str) -> str:
        """Return the name of the parent or child of a joint."""
        element = joint.need(which)
        name = element.get("link")
        if name not in self.links:
            raise element.wrong(f"there is no link `{name}`")
        return name

    @staticmethod
    def _identity() -> Frame:
        import numpy as np

        return np.eye(3), np.zeros(3)

    def _placed(self, frame: Frame, element: Element) -> Frame:
        """Return the frame of the <origin> of an element, which stands in `frame`."""
        axes, at = frame
        origin = element.find("origin")
        if origin is None:
            return frame
        import numpy as np

        place = np.array(origin.numbers("xyz", 3, "0 0 0"))
        return axes @ self._turned(origin), at + axes @ place

    def _turned(self, origin: Element) -> Matrix:
        """Return the rotation by roll, pitch and yaw about fixed axes."""
        import numpy as np

        angles = origin.numbers("rpy", 3, "0 0 0")
        if not self.exact:
            words = origin.get("rpy", "0 0 0").split()
            found = [meant(word) for word in words]
            self.angles += [abs(a - b) for a, b in zip(found, angles) if a != b]
            angles = found
        (cr, sr), (cp, sp), (cy, sy) = [(np.cos(a), np.sin(a)) for a in angles]
        return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                         [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                         [-sp, cp * sr, cp * cr]])  # fmt: skip

    def _add_inertia(self, link: Element, frame: Frame, parts: list[tuple[float, Vector, Matrix]]) -> None:
        inertial = link.find("inertial")
        if inertial is None:
            return
        import numpy as np

        axes, at = self._placed(frame, inertial)
        (mass,) = inertial.need("mass").numbers("value", 1)
        if mass < 0.0:
            raise inertial.need("mass").wrong(f"a mass is not negative, {mass:g} kg")
        own = inertial.need("inertia")
        xx, xy, xz, yy, yz, zz = [
            own.numbers(name, 1)[0] for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        ]
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        change = possible(inertia)
        if change is not None:
            inertia, moments = change
            shown = ", ".join(f"{moment:.4g}" for moment in moments)
            message = (f"no body has the inertia of link `{link.get('name')}`, whose principal moments are "
                       f"{shown} kg.m2; the nearest ones that a body has are written")  # fmt: skip
            self.robot.warnings.append(Fault("LAG0708", message, own.span, severity="warning"))
        parts.append((mass, at, axes @ inertia @ axes.T))

    def _add_body(self, name: str, parts: list[tuple[float, Vector, Matrix]]) -> None:
        body = lumped(name, parts)
        self.robot.bodies.append(body)
        if self.free and len(self.robot.bodies) == 1 and not body.mass:
            self.robot.notes.append(f"link `{name}` moves freely and has no mass: give it one")

    def _joint(self, joint: Element, parent: str, child: str, frame: Frame) -> Joint:
        import numpy as np

        kind = KINDS.get(joint.get("type"))
        if kind is None:
            known = ", ".join(("fixed", *KINDS))
            raise joint.wrong(f"a joint has the type {known}; `{joint.get('type')}` is none of these")
        axes, at = frame
        direction: Any = None
        if kind != "Free":
            element = joint.find("axis")
            direction = np.array([1.0, 0.0, 0.0] if element is None else element.numbers("xyz", 3))
            length = np.linalg.norm(direction)
            if not length > 0.0:
                raise joint.wrong(f"the axis of joint `{joint.get('name')}` is zero")
            direction = axes @ (direction / length)
        damping = self._dynamics(joint)
        driven = kind in ("Revolute", "Prismatic") and joint.find("mimic") is None
        return Joint(joint.get("name"), kind, parent, child, direction, at, damping, driven=driven,
                     note=self._limits(joint, kind))  # fmt: skip

    def _dynamics(self, joint: Element) -> float:
        dynamics = joint.find("dynamics")
        if dynamics is None:
            return 0.0
        (damping,), (friction,) = dynamics.numbers("damping", 1, "0"), dynamics.numbers("friction", 1, "0")
        if friction:
            self.robot.notes.append(f"not imported: the dry friction {friction:g} of joint "
                                    f"`{joint.get('name')}`, whose law a URDF does not tell")  # fmt: skip
        return damping

    @staticmethod
    def _limits(joint: Element, kind: str) -> str:
        """Return the limits of a joint, as a comment."""
        limit = joint.find("limit")
        if limit is None:
            return ""
        length, force = ("m", "N") if kind == "Prismatic" else ("rad", "N.m")
        found = []
        if "lower" in limit.attributes or "upper" in limit.attributes:
            (lower,), (upper,) = limit.numbers("lower", 1, "0"), limit.numbers("upper", 1, "0")
            if kind != "Revolute" or joint.get("type") != "continuous":
                found.append(f"from {lower:g} to {upper:g} {length}")
        for name, unit in (("effort", force), ("velocity", f"{length}/s")):
            if name in limit.attributes:
                found.append(f"{name} to {limit.numbers(name, 1)[0]:g} {unit}")
        return ", ".join(found)

    def _couple(self) -> None:
        for joint in self.joints.values():
            mimic = joint.find("mimic")
            if mimic is None:
                continue
            name, leader = joint.get("name"), mimic.get("joint")
            if leader not in self.joints:
                raise mimic.wrong(f"there is no joint `{leader}`")
            (offset,), (multiplier,) = mimic.numbers("offset", 1, "0"), mimic.numbers("multiplier", 1, "1")
            movable = [
                KINDS.get(other.get("type")) in ("Revolute", "Prismatic")
                for other in (joint, self.joints[leader])
            ]
            if movable[0]:
                values = (offset, multiplier) if movable[1] else (offset,)
                self.robot.couplings.append(
                    Coupling(f"mimic_{name}", name, leader if movable[1] else "", values)
                )
            else:
                self.robot.notes.append(f"the mimic of joint `{name}` has no effect: that does not move")

    def _tell(self) -> None:
        """Note what was changed, and what was left out."""
        notes = self.robot.notes
        if self.angles:
            largest = f"by up to {max(self.angles):.1e} rad"
            notes.append(f"rounded: {len(self.angles)} angles of `rpy` to multiples of 15 deg, {largest}")
        left = Counter[str]()
        for element in self.root.children:
            inner = element.children if element.tag in ("link", "joint") else [element]
            left.update(found.tag for found in inner if found.tag not in IMPORTED)
        if left:
            named = ", ".join(f"{count} <{tag}>" for tag, count in sorted(left.items()))
            notes.append(f"not imported: {named}")


def _named(root: Element, tag: str) -> dict[str, Element]:
    """Return elements by name.  Raises Refused if two have one name."""
    found: dict[str, Element] = {}
    for element in root.named(tag):
        name = element.get("name")
        if not name:
            raise element.wrong(f"a <{tag}> has a name")
        if name in found:
            raise element.wrong(f"there are two <{tag}> with the name `{name}`")
        found[name] = element
    return found
