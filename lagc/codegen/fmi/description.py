"""The description of an FMU: its variables, units and structure, as XML of FMI 3.0 and 2.0."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isfinite
from xml.etree import ElementTree as ET

from lagc.base.records import dataclass
from lagc.codegen.identifiers import prefix
from lagc.lowering.program import Field, Interface
from lagc.semantics.units import BASE, PARTS, quotient, unit

XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
_NAME = r"[A-Za-z_]\w*(\[\d+(,\d+)*\])?(\.[A-Za-z_]\w*(\[\d+(,\d+)*\])?)*"
NAME = re.compile(rf"{_NAME}|der\({_NAME}(,\d+)?\)", re.ASCII)  # of the structured naming convention
CHARACTERS = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # outside of XML

# The versions differ in spelling, and in what 2.0 does not have.
TOKEN = {3: "instantiationToken", 2: "guid"}
STATE, DIRECTIONAL = {3: "FMUState", 2: "FMUstate"}, {3: "Derivatives", 2: "Derivative"}
COMPLETED_STEP = {3: {"needsCompletedIntegratorStep": "true"}, 2: {}}
OF_CO_SIMULATION = {
    3: ("canHandleVariableCommunicationStepSize", "providesIntermediateUpdate", "mightReturnEarlyFromDoStep",
        "canReturnEarlyAfterIntermediateUpdate"),
    2: ("canHandleVariableCommunicationStepSize",),
}  # fmt: skip
OF_VALUE = (
    "unit",
    "displayUnit",
    "min",
    "max",
    "nominal",
    "start",
    "derivative",
)  # in 2.0 not of the variable
GROUPS = {"Output": "Outputs", "ContinuousStateDerivative": "Derivatives",
          "InitialUnknown": "InitialUnknowns"}  # fmt: skip


@dataclass(frozen=True)
class Variable:
    """A variable; `attributes` are those of FMI, except its names and references."""

    name: str
    reference: int
    attributes: dict[str, str]
    derivative: int | None = None  # value reference of the state that this is the derivative of
    is_boolean: bool = False

    @property
    def is_indicator(self) -> bool:
        return self.name.startswith("event_indicator[")


@dataclass(frozen=True)
class Unit:
    """A model as an FMU describes it: `start` are its initial coordinates and speeds, which parameters and
    constraints change unless they are `exact`; `constants` are parameters that are part of the code."""

    interface: Interface
    token: str
    start: Sequence[float]
    exact: bool
    directional: bool
    constants: Sequence[str] = ()

    @property
    def first(self) -> dict[str, int]:
        """The first value reference of each kind of variable, as in `lagc_instance.h`."""
        i, found, at = self.interface, dict[str, int](), 1
        given, states = len(i.parameters) + len(i.inputs), i.nq + i.nv
        for name, size in {"p": given, "x": i.nx, "d": states, "y": len(i.outputs), "z": 0}.items():
            found[name] = at
            at += size
        return found

    @property
    def derivatives(self) -> list[int]:
        """The value reference of the derivative of each state. That of a coordinate whose rate is a speed is
        this speed."""
        i, first = self.interface, self.first
        speeds = {name: i.nq + k for k, name in enumerate(i.v_names)}
        return [
            first["x"] + speeds[f"der({name})"] if f"der({name})" in speeds else first["d"] + k
            for k, name in enumerate(i.state_names)
        ]

    @property
    def about(self) -> str:
        i = self.interface
        scene = f", scene {i.scene}" if i.scene else ""
        constants = f" Constants of this code: {', '.join(self.constants)}." if self.constants else ""
        return (f"{i.model}{scene}. Co-Simulation keeps its tolerance in each step; it does not estimate the "
                f"global error.{constants}")  # fmt: skip


def quoted(name: str) -> str:
    """Return a name of the structured naming convention: `impulse(floor)` becomes `'impulse(floor)'`."""
    name = name.replace(", ", ",")
    if NAME.fullmatch(name):
        return name
    return "'" + name.replace("\\", "\\\\").replace("'", "\\'") + "'"


def number(value: float) -> str:
    return repr(float(value))


def variables(made: Unit) -> Iterator[Variable]:
    """Yield the variables in the order of their value references."""
    i, first = made.interface, made.first
    initial = "exact" if made.exact else "approx"
    yield Variable("time", 0, _kind("independent", "continuous", "s", description="simulation time"))

    # Parameters and inputs, which an importer sets.
    for k, field in enumerate((*i.parameters, *i.inputs)):
        kind = ("parameter", "tunable") if k < len(i.parameters) else ("input", "continuous")
        more = {"initial": "exact"} if k < len(i.parameters) else {}
        bounds = {"min": field.minimum, "max": field.maximum}
        more |= {name: number(bound) for name, bound in bounds.items() if isfinite(bound)}
        more["start"] = number(field.value or 0.0)
        yield Variable(field.name, first["p"] + k, {**_of(field, *kind), **more})

    # States: a speed is the derivative of its coordinate.
    mirrors = {vr: first["x"] + k for k, vr in enumerate(made.derivatives)}
    for k, (name, own) in enumerate(zip(i.state_names, i.state_units)):
        more = {"initial": initial, "start": number(made.start[k])}
        if i.scales.get(name):
            more["nominal"] = number(i.scales[name])
        at = first["x"] + k
        yield Variable(name, at, _kind("local", "continuous", own, **more), mirrors.get(at))
    for k, (field, truth) in enumerate(zip(i.discretes, i.booleans)):
        at = first["d"] - len(i.discretes) + k
        attributes = {**_of(field, "local", "discrete", not truth), "initial": "calculated"}
        yield Variable(field.name, at, attributes, is_boolean=bool(truth))

    # Computed values: accelerations, outputs, indicators.
    for k, (name, own) in enumerate(zip(i.state_names, i.state_units)):
        at = first["d"] + k
        if at in mirrors:
            label = f"{name[:-1]},2)" if name.startswith("der(") else f"der({name})"
            over = _kind("local", "continuous", quotient(own, "s"), initial="calculated")
            yield Variable(label, at, over, first["x"] + k)
    for k, field in enumerate(i.outputs):
        attributes = {**_of(field, "output", "continuous"), "initial": "calculated"}
        yield Variable(field.name, first["y"] + k, attributes)
    for k, words in enumerate(i.relations[i.timed_relations :]):
        attributes = _kind("local", "continuous", initial="calculated", description=words)
        yield Variable(f"event_indicator[{k + 1}]", first["z"] + k, attributes)


def _kind(causality: str, variability: str, own: str = "", display: str = "", **more: str) -> dict[str, str]:
    """Return the attributes of a variable; its unit is absent if it has none."""
    units = {"unit": own} if own else {}
    if own and display not in ("", own):
        units["displayUnit"] = display
    return {"causality": causality, "variability": variability, **units, **more}


def _of(field: Field, causality: str, variability: str, has_unit: bool = True) -> dict[str, str]:
    """Return the attributes that the declaration of a field gives."""
    about = {"description": field.description} if field.description else {}
    units = (field.unit, field.display_unit) if has_unit else ()
    return _kind(causality, variability, *units, **about)


def _add(
    parent: ET.Element, tag: str, attributes: Mapping[str, str] | None = None, **more: str
) -> ET.Element:
    """Add an element; characters that XML does not have become `?`."""
    cleaned = {name: CHARACTERS.sub("?", value) for name, value in {**(attributes or {}), **more}.items()}
    return ET.SubElement(parent, tag, cleaned)


def _add_units(root: ET.Element, found: Iterable[Variable]) -> None:
    """Add the units, each with those in which it is shown: value shown = factor * value."""
    shown: dict[str, set[str]] = {}
    for variable in found:
        if own := variable.attributes.get("unit"):
            shown.setdefault(own, set()).update({variable.attributes.get("displayUnit", own)} - {own})
    units = _add(root, "UnitDefinitions")
    for name in sorted(shown):
        powers = unit(name).dimension
        element = _add(units, "Unit", name=name)
        # FMI has whole powers of the units of SI.
        if not any(e % PARTS for e in powers):
            angle = {"rad": "1"} if re.match("rad", name) else {}
            _add(element, "BaseUnit", {base: str(e // PARTS) for base, e in zip(BASE, powers) if e} | angle)
        for display in sorted(shown[name]):
            _add(element, "DisplayUnit", name=display, factor=number(1.0 / unit(display).factor))


def _add_kinds(root: ET.Element, made: Unit, version: int) -> None:
    """Add Model Exchange and Co-Simulation, each with what it can do."""
    can = {
        "modelIdentifier": prefix(made.interface.model),
        f"canGetAndSet{STATE[version]}": "true",
        f"canSerialize{STATE[version]}": "true",
        f"providesDirectional{DIRECTIONAL[version]}": str(made.directional).lower(),
    }
    events = {"hasEventMode": str(bool(made.interface.relations)).lower()} if version == 3 else {}
    co = {**dict.fromkeys(OF_CO_SIMULATION[version], "true"), **events}
    for tag, more in {"ModelExchange": COMPLETED_STEP[version], "CoSimulation": co}.items():
        element = _add(root, tag, can, **more)
        if version == 2:  # later versions have a file buildDescription.xml
            files = _add(element, "SourceFiles")
            for name in units(made.interface, 2):
                _add(files, "File", name=name)


def _unknowns(made: Unit, found: Sequence[Variable]) -> dict[str, list[int]]:
    """Return the value references of each part of the structure. Initial unknowns are all outputs, state
    derivatives and states that the initialization computes."""
    states = range(made.first["x"], made.first["x"] + made.interface.nq + made.interface.nv)
    own, outputs = made.derivatives, [v.reference for v in found if v.attributes["causality"] == "output"]
    computed = {v.reference for v in found if v.attributes.get("initial") in ("approx", "calculated")}
    return {
        "Output": outputs,
        "ContinuousStateDerivative": own,
        "InitialUnknown": [vr for vr in sorted({*states, *own, *outputs}) if vr in computed],
        "EventIndicator": [v.reference for v in found if v.is_indicator],
    }


def description(made: Unit, version: int) -> str:
    """Return modelDescription.xml. FMI 2.0 counts variables from 1 and has no variables of event
    indicators."""
    every = list(variables(made))
    found = every if version == 3 else [v for v in every if not v.is_indicator]
    index = {v.reference: str(v.reference if version == 3 else k) for k, v in enumerate(found, 1)}

    # The order of the elements is that of the schema.
    root = _add(ET.Element("root"), "fmiModelDescription", {
        "fmiVersion": f"{version}.0", "modelName": made.interface.model, TOKEN[version]: made.token,
        "description": made.about, "generationTool": "lagc", "variableNamingConvention": "structured",
    })  # fmt: skip
    if version == 2:
        root.set("numberOfEventIndicators", str(len(every) - len(found)))
    _add_kinds(root, made, version)
    _add_units(root, found)
    categories = _add(root, "LogCategories")
    for name in ("logStatusWarning", "logStatusError"):
        _add(categories, "Category", name=name)
    stop = number(made.interface.simulate.get("stop", 1.0))
    _add(root, "DefaultExperiment", startTime="0.0", stopTime=stop, tolerance="1e-6")

    listed = _add(root, "ModelVariables")
    for v in found:
        attributes = {"name": quoted(v.name), "valueReference": str(v.reference), **v.attributes}
        if v.derivative is not None:
            attributes["derivative"] = index[v.derivative]
        of_value = (
            {} if version == 3 else {name: attributes.pop(name) for name in OF_VALUE if name in attributes}
        )
        if version == 2:
            _add(_add(listed, "ScalarVariable", attributes), "Boolean" if v.is_boolean else "Real", of_value)
        else:
            _add(listed, "Boolean" if v.is_boolean else "Float64", attributes)

    structure = _add(root, "ModelStructure")
    for kind, references in _unknowns(made, found).items():
        if version == 2 and references:
            group = _add(structure, GROUPS[kind])
            for vr in references:
                _add(group, "Unknown", index=index[vr])
        elif version == 3:
            for vr in references:
                _add(structure, kind, valueReference=index[vr])
    return _printed(root)


def units(interface: Interface, version: int) -> tuple[str, ...]:
    """The C files that are compiled."""
    return f"{prefix(interface.model)}.c", f"lagc_fmi{version}.c"


def build(interface: Interface) -> str:
    """Return sources/buildDescription.xml of FMI 3.0."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = _add(root, "BuildConfiguration", modelIdentifier=prefix(interface.model))
    files = _add(configuration, "SourceFileSet", language="C99")
    for name in units(interface, 3):
        _add(files, "SourceFile", name=name)
    _add(configuration, "Library", name="m")
    return _printed(root)


def _printed(root: ET.Element) -> str:
    ET.indent(root)
    return XML + ET.tostring(root, encoding="unicode") + "\n"
