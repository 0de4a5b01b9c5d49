"""Facts about declarations and expressions, in words: values in SI, bounds, starts, expanded expressions."""

from collections.abc import Mapping
from math import inf

from lagc.editor.names import Declared
from lagc.semantics import model as objects
from lagc.semantics.names.scope import Array, Scalar, Value
from lagc.semantics.units import describe
from lagc.symbolic.expression_text import brief
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate, symbols

# By start and end of an expression; whether it has no other value in another instance or pass of a loop.
Values = dict[tuple[int, int], tuple[Value, bool]]


def said(found: tuple[Value, bool] | None, known: Mapping[Node, float]) -> str:
    """Return a value in words, `Length [m]`, with its number if it follows from parameters, whose values are
    `known`."""
    value, alone = found or (None, False)
    if isinstance(value, Scalar):
        text = "0" if value.dimension is None else describe(value.dimension)
        if alone and known.keys() >= symbols([value.node]):
            return f"{text}: {evaluate([value.node], known)[0]:.12g}"
        return text
    if isinstance(value, Array):
        first = next((e for e in value.elements if isinstance(e, Scalar) and e.dimension is not None), None)
        size = "vector" if len(value.elements) == 3 else f"array of {len(value.elements)}"
        if isinstance(first, Scalar) and first.dimension is not None:
            return f"{size}, {describe(first.dimension)}"
    return ""


def fact(declared: Declared, model: objects.Model) -> str:
    """Return what a model knows of a declaration, or ""."""
    if declared.kind == "model":
        return _of_model(model) if model.name == declared.name else ""
    found = (
        *model.parameters, *model.inputs, *model.coordinates, *model.speeds, *model.outputs, *model.bodies,
        *model.points, *model.actions, *model.constraints,
    )  # fmt: skip
    for each in found:
        span, name = each.span, each.name.split(".")[-1].split("[")[0]
        inside = (
            span.source is declared.place.source and declared.span.start <= span.start < declared.span.end
        )
        if name == declared.name and inside:
            return _of_object(each)
    return ""


def _of_model(model: objects.Model) -> str:
    equations = sum(len(c.residuals) for c in model.constraints)
    counts = {
        "coordinates": len(model.coordinates),
        "constraint equations": equations,
        "bodies": len(model.bodies),
    }
    return "; ".join([f"{what}: {n}" for what, n in (*counts.items(), ("scenes", ", ".join(model.scenes)))])


def _of_object(found: objects.ModelObject) -> str:
    match found:
        case objects.Parameter() | objects.Input():
            value = found.value if isinstance(found, objects.Parameter) else found.default
            bounds = [f"min {found.minimum:g}"] * (found.minimum > -inf)
            bounds += [f"max {found.maximum:g}"] * (found.maximum < inf)
            number = "no value" if value is None else f"= {value:.12g} {found.unit}".rstrip()
            return number + (f" ({', '.join(bounds)})" if bounds else "")
        case objects.Coordinate():
            start = f"starts at `{brief(found.start)}` with the rate `{brief(found.rate)}`"
            return f"generalized coordinate [{found.unit or '1'}]; {start}"
        case objects.Orientation():
            return "orientation, a unit quaternion w x y z"
        case objects.Speed() | objects.Output():
            return f"[{found.unit or '1'}] = `{brief(found.expression)}`"
        case objects.Body():
            return f"mass `{brief(found.mass)}` kg, centre of mass at {_vector(found.position)}"
        case objects.Point():
            return f"at {_vector(found.position)}"
        case objects.Potential():
            return f"V = `{brief(found.energy)}` J"
        case objects.Force() | objects.Torque():
            return f"{_vector(found.vector)} in world axes"
        case objects.Constraint():
            return "\n".join(f"0 = `{brief(r)}` [{u or '1'}]" for r, u in zip(found.residuals, found.units))
    return ""


def _vector(vector: tuple[Node, Node, Node]) -> str:
    return f"`{{{', '.join(map(brief, vector))}}}`"
