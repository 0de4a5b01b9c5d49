"""Seeded random systems as texts: trees of particles and solids, loops closed by rows, random actions."""

import random

from lagc.compiler.stages import Choice, parse, resolve
from lagc.diagnostics.faults import Source
from lagc.semantics.model import Model

UNITS = {"free": "", "x": "rad", "y": "rad", "z": "rad", "X": "m", "Y": "m", "Z": "m"}


def random_system(seed: int, lossless: bool = False) -> Model:
    """Return a system of 1 to 5 links; `lossless`: without drives, friction and rows of speeds."""
    text = random_text(seed, lossless)
    return resolve(parse(Source(f"random{seed}.lag", text)), Choice())


def random_text(seed: int, lossless: bool = False) -> str:
    r = random.Random(seed)
    planar, n = r.random() < 0.4, r.randint(1, 5)
    free = not planar and r.random() < 0.3

    def number(low: float, high: float) -> str:
        return repr(round(r.uniform(low, high), 3))

    def vector(frame: str, unit: str = "m") -> str:
        """A random vector in the axes of a frame, in the plane x, y of a planar system."""
        axes = "xy" if planar else "xyz"
        return " + ".join(f"{number(-1, 1)} [{unit}]*{frame}.{axis}" for axis in axes)

    lines: list[str] = []
    numbers: list[str] = []  # coordinates without a dimension
    rates: list[str] = []
    frames, places = {-1: "world"}, {-1: "{0, 0, 0} [m]"}
    for i in range(n):
        kind = "free" if free and i == 0 else r.choice(["z", "z", "X", "Y"] if planar else [*"xyzXYZ"])
        parent = i - 1 if r.random() < 0.7 else r.randint(-1, i - 1)
        above, place = frames[parent], f"{places[parent]} + {vector(frames[parent])}"
        if r.random() < 0.2 and not lossless:  # the joint is moved along x
            place += f" + {number(0.1, 0.5)} [m]*sin({number(0.5, 3)}*T)*{above}.x"
        frames[i] = f"F{i}" if kind in ("free", *"xyz") else above
        if kind == "free":
            lines.append(f"coordinate Orientation o; frame F{i} = rotate(world, o);")
            numbers += ["o.x"]
            rates += [f"o.rate.{axis}/(1 [rad/s])" for axis in "xyz"]
        else:
            lines.append(f"coordinate {'Angle' if kind in 'xyz' else 'Length'} q{i}(start = 0.3);")
            numbers.append(f"q{i}/(1 [{UNITS[kind]}])")
            rates.append(f"der(q{i})/(1 [{UNITS[kind]}/s])")
            if kind in "xyz":
                lines.append(f"frame F{i} = rotate_{kind}({above}, q{i});")
            else:
                place += f" + q{i}*{above}.{kind.lower()}"
        places[i] = f"O{i}"
        lines.append(f"point O{i} = {place}; point C{i} = O{i} + {vector(frames[i])};")
        mass = f"mass = {number(0.2, 2)} [kg]"
        if r.random() < 0.6 or kind == "free":
            moments = ", ".join(number(0.5, 1) for _ in range(3))  # each less than the two others together
            solid = f"inertia = {{{moments}}} [kg.m2], frame = {frames[i]}, com = C{i}"
            lines.append(f"body b{i} = Solid({mass}, {solid});")
        else:
            lines.append(f"body b{i} = Particle({mass}, at = C{i});")
        if r.random() < 0.2 and not lossless:
            square = f"dot(velocity(b{i}), velocity(b{i}))/(1 [m2/s2])"
            lines.append(
                f"force drag{i} = -{number(0.05, 0.5)} [kg/s]*(1 + {square})*velocity(b{i}) at b{i};"
            )
        if r.random() < 0.2 and kind in ("free", *"xyz") and not lossless:
            on = f"F{i}" + (f" from {above}" if above != "world" else "")
            lines.append(f"torque torque{i} = {vector('world', 'N.m')} on {on};")
    first, last = numbers[0], numbers[-1]
    lines.append(f"Gravity field(direction = {'{0, -1, 0}' if planar else '{0, 0, -1}'});")
    pairs = [(i, j) for i in range(n) for j in range(i)]
    for i, j in [pair for pair in pairs if r.random() < 0.2]:
        lines.append(f"potential spring{i}{j} = {number(0.2, 1)} [N/m]*dot(C{i} - C{j}, C{i} - C{j});")
    wave = f"{number(-1, 1)}*{first} + {number(-1, 1)}*{last}" + ("" if lossless else f" + {number(-1, 1)}*T")
    lines.append(f"potential wave = {number(-1, 1)} [J]*sin({wave});")
    for k, (i, j) in enumerate([pair for pair in pairs if r.random() < 0.15][:2]):
        lines.append(f"constraint loop{k}: dot(C{i} - C{j}, C{i} - C{j}) = {number(0.5, 2)} [m2];")
    if lossless:
        return _model(seed, lines)
    if r.random() < 0.4:
        squares = " + ".join(f"({rate})^2" for rate in rates)
        lines.append(f"dissipation damping = {number(0, 0.5)} [W]*(1.5 + sin({first}))*({squares});")
    if r.random() < 0.3:  # with parts linear and quadratic in the rates
        terms = f"sin({last} + T)*({rates[0]})*(1 + {first}) + 0.3*cos({first})*({rates[0]})*({rates[-1]})"
        lines.append(f"lagrangian magnetic = {number(0, 1)} [J]*({terms});")
    if r.random() < 1 / 3:
        a, b = number(-1, 1), number(-1, 1)
        terms = " + ".join(
            f"({a} + sin({b}*{first} + {k} + {last}))*({rate})" for k, rate in enumerate(rates)
        )
        lines.append(f"constraint pfaffian: {number(-1, 1)}*cos({a}*T) + {terms} = 0;")
    if n > 2 and r.random() < 0.3:  # of fewer links, the speeds would be over-determined
        lines.append(f"constraint quadratic: {' + '.join(f'({rate})^2' for rate in rates)} = 2;")
    return _model(seed, lines)


def _model(seed: int, lines: list[str]) -> str:
    text = "\n".join(lines).replace("*T", "*time/(1 [s])").replace("+ T)", "+ time/(1 [s]))")
    return f"model Random{seed}\n{text}\nend Random{seed};\n"
