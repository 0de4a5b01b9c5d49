"""The description of an FMU: its variables, units and structure, as XML of FMI 3.0 and 2.0."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from math import isfinite
from xml.etree import ElementTree as ET

from lagc.base.records import dataclass
from lagc.codegen.identifiers import prefix
from lagc.lowering.program import Field, Interface
from lagc.semantics.units import BASE, PARTS, quotient, unit

XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
TRUE, FALSE = "true", "false"
_NAME = r"[A-Za-z_]\w*(\[\d+(,\d+)*\])?(\.[A-Za-z_]\w*(\[\d+(,\d+)*\])?)*"
NAME = re.compile(rf"{_NAME}|der\({_NAME}(,\d+)?\)", re.ASCII)  # of the structured naming convention
CHARACTERS = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # outside of XML


@dataclass(frozen=True)
class Variable:
    """A variable; `attributes` are those of FMI that are given."""

    name: str
    reference: int
    causality: str
    variability: str
    attributes: dict[str, str]
    unit: str = ""
    display: str = ""
    derivative: int | None = None  # value reference of the state that this is the derivative of
    is_boolean: bool = False


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
        states = i.nq + i.nv
        free = len(i.relations) - i.timed_relations
        sizes = {
            "p": len(i.parameters) + len(i.inputs),
            "x": i.nx,
            "d": states,
            "y": len(i.outputs),
            "z": free,
        }
        for name, size in sizes.items():
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
    yield Variable("time", 0, "independent", "continuous", {"description": "simulation time"}, "s")
    for k, field in enumerate((*i.parameters, *i.inputs)):
        yield _given(field, first["p"] + k, k < len(i.parameters))
    mirrors = {vr: first["x"] + k for k, vr in enumerate(made.derivatives)}
    initial = "exact" if made.exact else "approx"
    for k, (name, own) in enumerate(zip(i.state_names, i.state_units)):
        nominal = {"nominal": number(i.scales[name])} if i.scales.get(name) else {}
        more = {"initial": initial, "start": number(made.start[k]), **nominal}
        at = first["x"] + k
        yield Variable(name, at, "local", "continuous", more, own, "", mirrors.get(at))
    for k, (field, truth) in enumerate(zip(i.discretes, i.booleans)):
        at = first["x"] + i.nx - len(i.discretes) + k
        yield _computed(field, at, "local", "discrete", is_boolean=bool(truth))
    for k, (name, own) in enumerate(zip(i.state_names, i.state_units)):
        at = first["d"] + k
        if at in mirrors:
            base = name[4:-1] if name.startswith("der(") else ""
            label = f"der({base},2)" if base else f"der({name})"
            over = quotient(own, "s")
            more = {"initial": "calculated"}
            yield Variable(label, at, "local", "continuous", more, over, "", first["x"] + k)
    for k, field in enumerate(i.outputs):
        yield _computed(field, first["y"] + k, "output", "continuous")
    for k, words in enumerate(i.relations[i.timed_relations :]):
        more = {"initial": "calculated", "description": words}
        yield Variable(f"event_indicator[{k + 1}]", first["z"] + k, "local", "continuous", more)


def _about(field: Field) -> dict[str, str]:
    return {"description": field.description} if field.description else {}


def _given(field: Field, at: int, is_parameter: bool) -> Variable:
    more = _about(field)
    if is_parameter:
        more["initial"] = "exact"
    if isfinite(field.minimum):
        more["min"] = number(field.minimum)
    if isfinite(field.maximum):
        more["max"] = number(field.maximum)
    more["start"] = number(field.value or 0.0)
    kind = ("parameter", "tunable") if is_parameter else ("input", "continuous")
    return Variable(field.name, at, *kind, more, field.unit, field.display_unit)


def _computed(field: Field, at: int, causality: str, variability: str, is_boolean: bool = False) -> Variable:
    more = {**_about(field), "initial": "calculated"}
    own = ("", "") if is_boolean else (field.unit, field.display_unit)
    return Variable(field.name, at, causality, variability, more, *own, is_boolean=is_boolean)


def _text(attributes: dict[str, str]) -> dict[str, str]:
    return {name: CHARACTERS.sub("?", value) for name, value in attributes.items()}


def _units(found: Iterable[Variable]) -> ET.Element:
    """Return the units, each with those in which it is shown: value shown = factor * value."""
    shown: dict[str, set[str]] = {}
    for variable in found:
        if variable.unit:
            shown.setdefault(variable.unit, set()).update({variable.display} - {"", variable.unit})
    root = ET.Element("UnitDefinitions")
    for name in sorted(shown):
        own = unit(name)
        element = ET.SubElement(root, "Unit", name=name)
        powers = {base: str(e // PARTS) for base, e in zip(BASE, own.dimension) if e}
        if not any(e % PARTS for e in own.dimension):
            angle = {"rad": "1"} if re.match("rad", name) else {}
            ET.SubElement(element, "BaseUnit", {**powers, **angle})
        for display in sorted(shown[name]):
            ET.SubElement(element, "DisplayUnit", name=display, factor=number(1.0 / unit(display).factor))
    return root


def _head(made: Unit, **more: str) -> ET.Element:
    return ET.Element("fmiModelDescription", _text({
        "modelName": made.interface.model, "description": made.about, "generationTool": "lagc",
        "variableNamingConvention": "structured", **more,
    }))  # fmt: skip


def _experiment(interface: Interface) -> ET.Element:
    stop = number(interface.simulate.get("stop", 1.0))
    return ET.Element("DefaultExperiment", startTime="0.0", stopTime=stop, tolerance="1e-6")


def _categories() -> ET.Element:
    root = ET.Element("LogCategories")
    for name in ("logStatusWarning", "logStatusError"):
        ET.SubElement(root, "Category", name=name)
    return root


def _printed(root: ET.Element) -> str:
    ET.indent(root)
    return XML + ET.tostring(root, encoding="unicode") + "\n"


def _unknowns(made: Unit, found: Sequence[Variable]) -> dict[str, list[int]]:
    """Return the value references of each part of the structure. Initial unknowns are all outputs, state
    derivatives and states that the initialization computes."""
    states = range(made.first["x"], made.first["x"] + made.interface.nq + made.interface.nv)
    own, outputs = made.derivatives, [v.reference for v in found if v.causality == "output"]
    computed = {v.reference for v in found if v.attributes.get("initial") in ("approx", "calculated")}
    return {
        "Output": outputs,
        "ContinuousStateDerivative": own,
        "InitialUnknown": [vr for vr in sorted({*states, *own, *outputs}) if vr in computed],
        "EventIndicator": [v.reference for v in found if v.name.startswith("event_indicator[")],
    }


def fmi3(made: Unit) -> str:
    """Return modelDescription.xml of FMI 3.0."""
    found, name = list(variables(made)), prefix(made.interface.model)
    root = _head(made, fmiVersion="3.0", instantiationToken=made.token)
    can = {"modelIdentifier": name, "canGetAndSetFMUState": TRUE, "canSerializeFMUState": TRUE,
           "providesDirectionalDerivatives": TRUE if made.directional else FALSE}  # fmt: skip
    ET.SubElement(root, "ModelExchange", can, needsCompletedIntegratorStep=TRUE)
    ET.SubElement(
        root, "CoSimulation", can, canHandleVariableCommunicationStepSize=TRUE,
        providesIntermediateUpdate=TRUE,
        mightReturnEarlyFromDoStep=TRUE, canReturnEarlyAfterIntermediateUpdate=TRUE,
        hasEventMode=TRUE if made.interface.relations else FALSE,
    )  # fmt: skip
    root.extend([_units(found), _categories(), _experiment(made.interface)])
    listed = ET.SubElement(root, "ModelVariables")
    for v in found:
        attributes = {"name": quoted(v.name), "valueReference": str(v.reference), "causality": v.causality,
                      "variability": v.variability, **_quantity(v), **v.attributes}  # fmt: skip
        if v.derivative is not None:
            attributes["derivative"] = str(v.derivative)
        ET.SubElement(listed, "Boolean" if v.is_boolean else "Float64", _text(attributes))
    structure = ET.SubElement(root, "ModelStructure")
    for kind, references in _unknowns(made, found).items():
        for vr in references:
            ET.SubElement(structure, kind, valueReference=str(vr))
    return _printed(root)


def _quantity(variable: Variable) -> dict[str, str]:
    shown = {"displayUnit": variable.display} if variable.display not in ("", variable.unit) else {}
    return {"unit": variable.unit, **shown} if variable.unit else {}


def fmi2(made: Unit) -> str:
    """Return modelDescription.xml of FMI 2.0, which counts variables from 1 and has no variables of event
    indicators."""
    every = list(variables(made))
    found = [v for v in every if not v.name.startswith("event_indicator[")]
    index = {v.reference: str(k) for k, v in enumerate(found, 1)}
    count = str(len(every) - len(found))
    root = _head(made, fmiVersion="2.0", guid=made.token, numberOfEventIndicators=count)
    can = {"modelIdentifier": prefix(made.interface.model), "canGetAndSetFMUstate": TRUE,
           "canSerializeFMUstate": TRUE,
           "providesDirectionalDerivative": TRUE if made.directional else FALSE}  # fmt: skip
    for kind in ("ModelExchange", "CoSimulation"):
        more = {"canHandleVariableCommunicationStepSize": TRUE} if kind == "CoSimulation" else {}
        files = ET.SubElement(ET.SubElement(root, kind, {**can, **more}), "SourceFiles")
        for name in units(made.interface, 2):
            ET.SubElement(files, "File", name=name)
    root.extend([_units(found), _categories(), _experiment(made.interface)])
    listed = ET.SubElement(root, "ModelVariables")
    for v in found:
        own = {"name": quoted(v.name), "valueReference": str(v.reference), "causality": v.causality,
               "variability": v.variability, **_only(v.attributes, "description", "initial")}  # fmt: skip
        value = {**_quantity(v), **_only(v.attributes, "min", "max", "nominal", "start")}
        if v.derivative is not None:
            value["derivative"] = index[v.derivative]
        scalar = ET.SubElement(listed, "ScalarVariable", _text(own))
        ET.SubElement(scalar, "Boolean" if v.is_boolean else "Real", _text(value))
    structure = ET.SubElement(root, "ModelStructure")
    parts = _unknowns(made, found)
    for name, kind in zip(("Outputs", "Derivatives", "InitialUnknowns"), parts):
        places = [index[vr] for vr in parts[kind]]
        if places:
            listed = ET.SubElement(structure, name)
            for place in sorted(places, key=int) if name == "InitialUnknowns" else places:
                ET.SubElement(listed, "Unknown", index=place)
    return _printed(root)


def _only(attributes: dict[str, str], *names: str) -> dict[str, str]:
    return {name: attributes[name] for name in names if name in attributes}


def units(interface: Interface, version: int) -> tuple[str, ...]:
    """The C files that are compiled."""
    return f"{prefix(interface.model)}.c", f"lagc_fmi{version}.c"


def build(interface: Interface) -> str:
    """Return sources/buildDescription.xml of FMI 3.0."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=prefix(interface.model))
    files = ET.SubElement(configuration, "SourceFileSet", language="C99")
    for name in units(interface, 3):
        ET.SubElement(files, "SourceFile", name=name)
    ET.SubElement(configuration, "Library", name="m")
    return _printed(root)
