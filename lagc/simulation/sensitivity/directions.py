"""What a motion is differentiated by: parameters, inputs and start values, by their names."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Refused
from lagc.lowering.program import Field, Interface
from lagc.simulation.request import unknown


@dataclass(frozen=True, slots=True)
class Direction:
    """`parameter`: its place in p, or `state`: in x; neither, where it reaches nothing."""

    name: str
    unit: str
    parameter: int | None = None
    state: int | None = None


def directions(
    interface: Interface, names: Sequence[str], unused: Sequence[Field], built_in: Collection[str]
) -> tuple[Direction, ...]:
    """`l`, `start(theta)`, `start(der(theta))`, each once; of an array all its entries.  Raises Refused:
    LAG0601, LAG0606 where a name is unknown, LAG0607 what is built into the compiled model."""
    fields = [*interface.parameters, *interface.inputs]
    given = {f.name: Direction(f.name, f.unit, parameter=k) for k, f in enumerate(fields)}
    given.update((f.name, Direction(f.name, f.unit)) for f in unused)
    states = [*zip(interface.q_names, interface.q_units), *zip(interface.v_names, interface.v_units)]
    starts = {name: Direction(f"start({name})", unit, state=k) for k, (name, unit) in enumerate(states)}
    faults: list[Fault] = []
    found: dict[str, Direction] = {}
    for word in names:
        name = word.strip()
        at = name[len("start(") : -1].strip() if name.startswith("start(") and name.endswith(")") else None
        meant = _meant(name, given) if at is None else _meant(at, starts)
        if name in built_in:
            fault = f"`{name}` is built into the compiled model: nothing is differentiated by it"
            faults.append(Fault("LAG0607", fault))
        elif meant:
            found.update((d.name, d) for d in meant)
        elif not (name if at is None else at):
            faults.append(Fault("LAG0601", "one of the names that a run is to be differentiated by is empty"))
        elif at is not None:
            faults.append(unknown(at, starts, "coordinate or speed", "LAG0606"))
        elif name in starts:
            fault = f"`{name}` is no parameter, and has no one value"
            faults.append(Fault("LAG0601", fault, remedy=f"by its start: `start({name})`"))
        else:
            faults.append(unknown(name, given, "parameter", "LAG0601"))
    if faults:
        raise Refused(faults)
    return tuple(found.values())


def _meant(name: str, known: Mapping[str, Direction]) -> list[Direction]:
    """What is known by a name, or as entries of an array."""
    if name in known:
        return [known[name]]
    stem, closed = (name[:-1], "])") if name.startswith("der(") else (name, "]")
    return [d for own, d in known.items() if name and own.startswith(f"{stem}[") and own.endswith(closed)]
