"""From a file to a `Robot`: its outermost element tells the format."""

from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.host.model_library import Unreadable, content, decoded, standard_input
from lagc.robots import urdf
from lagc.robots.robot import Robot
from lagc.robots.xml import parse


def robot_of(path: str, free: bool = False, exact: bool = False) -> Robot:
    """Return the robot of a file; `-` is standard input.  Raises Refused."""
    try:
        data = standard_input() if path == "-" else content(path, pipes=True)
        source = Source("<stdin>" if path == "-" else path, decoded(data))
    except Unreadable as error:
        raise Refused([Fault(error.code, f"`{path}` {error}", remedy=error.remedy)]) from None
    root = parse(source)
    if root.tag == "mujoco":
        from lagc.robots.mjcf import robot_of as robot_of_mjcf

        return robot_of_mjcf(path, root, free)
    return urdf.robot_of(root, free, exact)
