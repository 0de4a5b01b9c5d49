"""One line a kind of declaration: who finds its value."""

from __future__ import annotations

from collections.abc import Callable

from lagc.semantics.context import Context
from lagc.semantics.declarations.actions import (
    declare_constraint,
    declare_dissipation,
    declare_frame,
    declare_free_term,
    declare_load,
    declare_point,
    declare_potential,
)
from lagc.semantics.declarations.bodies import declare_body, declare_gravity
from lagc.semantics.declarations.quantities import declare_quantity
from lagc.semantics.names.scope import Entry, Thing, Value
from lagc.semantics.types.refusals import Wrong


def _function(context: Context, entry: Entry) -> Value:
    return Thing(entry)


def _instance(context: Context, entry: Entry) -> Value:
    raise Wrong(
        "LAG0205", f"the size of something depends on `{entry.path}`, which is not there yet", entry.span
    )


DECLARE: dict[str, Callable[[Context, Entry], Value]] = {
    "constant": declare_quantity, "parameter": declare_quantity, "structural": declare_quantity,
    "input": declare_quantity,
    "coordinate": declare_quantity, "speed": declare_quantity, "output": declare_quantity,
    "function": _function, "instance": _instance,
    "frame": declare_frame, "point": declare_point, "body": declare_body, "gravity": declare_gravity,
    "potential": declare_potential, "kinetic": declare_free_term, "lagrangian": declare_free_term,
    "dissipation": declare_dissipation, "force": declare_load, "torque": declare_load,
    "constraint": declare_constraint,
}  # fmt: skip


def declare(context: Context, entry: Entry) -> Value:
    """The value of a declaration; its nouns are appended to `entry.nouns`.  Raises Wrong."""
    return DECLARE[entry.kind](context, entry)
