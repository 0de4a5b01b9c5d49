"""A linear model as text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from lagc.simulation.linearization.linear_model import damping, frequency

if TYPE_CHECKING:
    from lagc.simulation.linearization.linear_model import Linear

FEW = 6  # states whose matrices are shown without being asked for
MOST = 12  # values, and eigenvalues, that are shown without --verbose
PARTS = 4  # of a mode, the largest
SMALL = 1e-3  # of its largest: parts of a mode that are not shown


def heading(linear: Linear) -> str:
    """Return the lines about the point and its stability."""
    at, interface = f"t = {linear.t:g} s", linear.system.interface
    if linear.equilibrium:
        time_dependent = interface.timed or interface.driven
        kind = "an equilibrium" + (f" at {at}" if time_dependent else "")
        if linear.free:
            kind += f", one of many: it seems free in {linear.free} direction{'s' if linear.free > 1 else ''}"
    elif linear.steady:
        kind = "what seems a steady motion"
    else:
        kind = f"the motion at {at}"
    verdict = linear.stability or (
        "eigenvalues are those of this moment" if linear.states else "nothing moves"
    )
    act = "acts" if len(linear.idle) == 1 else "act"
    idle = f"; {', '.join(linear.idle)} {act} on nothing else" if linear.idle else ""
    return f"{kind}; {verdict}{idle}"


def large(linear: Linear) -> bool:
    """Whether there are more values than are shown without --verbose."""
    interface = linear.system.interface
    return interface.nq + interface.nv > MOST


def text(linear: Linear, verbose: bool = False, times: int = 1) -> str:
    """Return the state, small matrices (all if `verbose`), eigenvalues and modes; one of `times` such texts,
    among which those of large models share the space."""
    interface = linear.system.interface
    names, units = interface.state_names, interface.state_units
    most = MOST // times if large(linear) else MOST
    # States, then the matrices where they are small, then the spectrum.
    n = len(names) if verbose or len(names) <= MOST else most
    width = max((len(name) for name in names[:n]), default=0)
    lines = [f"  {names[k]:{width}} = {_value(linear.x[k], units[k])}" for k in range(n)]
    if n < len(names):
        lines.append(f"  and {len(names) - n} more: --json or -v shows them")
    lines.append(f"  states  {_listed(linear.states, verbose) or 'none: the constraints leave no motion'}")
    touching = ", ".join([f"{name} {said}" for name, said in linear.contacts.items()])
    lines += [f"  contacts {touching}"] if touching else []
    for label, of in (("inputs", linear.inputs), ("outputs", linear.outputs)):
        lines += [f"  {label:7} {_listed(of, verbose)}"] if of else []
    if verbose or len(linear.states) <= FEW:
        for name, table in (("A", linear.A), ("B", linear.B), ("C", linear.C), ("D", linear.D)):
            lines += _matrix(name, table.tolist()) if table.size else []
    if len(linear.states):
        lines.append(f"  {'eigenvalue [1/s]':>28}  {'frequency [Hz]':>14}  {'damping':>9}  mode")
    return "\n".join([*lines, *_spectrum(linear, names, most, verbose)])


def _spectrum(linear: Linear, names: Sequence[str], most: int, verbose: bool) -> list[str]:
    """Eigenvalues with their modes, of a pair one, the fastest growing first."""
    lines: list[str] = []
    values, modes = linear.eigenvalues.tolist(), linear.modes.T.tolist()
    zeros = [k for k, value in enumerate(values) if value == 0.0]
    for k, (value, mode) in enumerate(zip(values, modes)):
        if value.imag < 0.0 or (k in zeros[1:] and not verbose):
            continue  # of a pair the first stands for both, of zeros without -v for all
        parts = (
            f"{len(zeros)} of them" if k in zeros and not verbose else _parts(mode, names, linear.system.nq)
        )
        rate, ratio = frequency(value), damping(value)
        lines.append(
            f"  {_complex(value):>28}  {f'{rate:.8g}' if rate else '':>14}  "
            f"{'' if ratio is None else f'{ratio + 0.0:.6g}':>9}  {parts}".rstrip()
        )
    if verbose or len(lines) <= most:
        return lines
    return [*lines[:most], f"  and {len(lines) - most} more: --json or -v shows them"]


def _listed(names: Sequence[str], verbose: bool) -> str:
    """Return as many names as there is room for, and how many more there are."""
    if verbose or len(names) <= MOST:
        return ", ".join(names)
    return ", ".join(names[:MOST]) + f" and {len(names) - MOST} more"


def _parts(mode: Sequence[complex], names: Sequence[str], nq: int) -> str:
    """The coordinates that move most, with their phases; speeds where none moves."""
    moving = range(nq) if any(abs(part) > SMALL for part in mode[:nq]) else range(len(mode))
    order = sorted(moving, key=lambda k: -abs(mode[k]))
    shown = [k for k in order if abs(mode[k]) > SMALL * abs(mode[order[0]])][:PARTS]
    return ", ".join([f"{names[k]} {_part(mode[k])}" for k in sorted(shown)])


def _part(value: complex) -> str:
    if abs(value.imag) <= SMALL * abs(value):
        return f"{value.real:.4g}"
    real = f"{value.real:.4g}" if abs(value.real) > SMALL * abs(value) else ""
    return f"{real}{value.imag:{'+' if real else ''}.4g}i"


def _complex(value: complex) -> str:
    return f"{value.real + 0.0:.9g}" + (f" +- {abs(value.imag):.9g}i" if value.imag else "")


def _value(value: float, unit: str) -> str:
    return f"{value + 0.0:.9g}" + (f" {unit}" if unit else "")


def _matrix(name: str, table: Sequence[Sequence[float]]) -> list[str]:
    cells = [[f"{value + 0.0:.6g}" for value in row] for row in table]
    width = max(len(cell) for row in cells for cell in row)
    lead = f"  {name} = "
    rows = ["  ".join(f"{cell:>{width}}" for cell in row) for row in cells]
    return [(lead if k == 0 else " " * len(lead)) + row for k, row in enumerate(rows)]
