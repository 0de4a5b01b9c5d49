"""The functions of contacts: gaps, their rows, and the numbers of their laws."""

from __future__ import annotations

from lagc.lowering.program import Function
from lagc.lowering.program_functions import made
from lagc.lowering.storage import STATE, Places
from lagc.symbolic.derivative import gradient
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import substitute


def contact_functions(at: Places, along: Places) -> list[Function]:
    """Return `gaps`, `contact_rows`, `restitutions` and `frictions`, none without contacts.
    `at` is the state alone, `along` the branches of a run."""
    contacts = at.equations.contacts
    if not contacts:
        return []
    labels = [contact.label for contact in contacts]
    gaps = [contact.gap for contact in contacts]
    laws = [contact.restitution for contact in contacts]
    frictions = [
        node for contact in along.equations.contacts for node in (contact.frictions or (at.graph.zero,) * 2)
    ]
    made_of = (("f", frictions),)
    with_friction = any(contact.slips for contact in contacts)
    return [
        *(
            [made(along, "frictions", along.state, made_of, "friction of each contact")]
            if with_friction
            else []
        ),
        made(at, "gaps", STATE, (("g", gaps),), "gap of each contact", labels, rare=True),
        _rows(along),
        *([_normals(along)] if any(contact.normals for contact in contacts) else []),
        made(at, "restitutions", STATE, (("r", laws),), "restitution of each contact", labels, rare=True),
    ]


def _rows(along: Places) -> Function:
    """Return the gradient of each row by the speeds, its rate, and its acceleration where v' = 0."""
    equations, zero = along.equations, along.graph.zero
    contacts, columns = equations.contacts, range(len(equations.v))
    gradients = [own.get(j, zero) for contact in contacts for own in contact.jacobians for j in columns]
    rates, biases = list[Node](), list[Node]()
    for contact in contacts:
        rates += [contact.rate, *(slip.rate for slip in contact.slips)]
        biases += [contact.bias, *(slip.bias for slip in contact.slips)]
    parts = (("R", gradients), ("u", rates), ("bias", biases))
    return made(along, "contact_rows", along.state, parts, "rows of the contacts")


def _normals(along: Places) -> Function:
    """Return the components of the normal forces of two-sided contacts, sums of accelerations, multipliers
    and forces of contacts: the derivatives by these, and the rest."""
    equations, graph = along.equations, along.graph
    nodes = [node for contact in equations.contacts for node in contact.normals]
    known = [*equations.a, *equations.lam, *(f for contact in equations.contacts for f in contact.forces)]
    found: list[Node] = []
    for node in nodes:
        slopes = gradient(graph, {node: graph.one}, known)
        found += [slopes.get(x, graph.zero) for x in known]
    rest = substitute(graph, nodes, dict.fromkeys(known, graph.zero))
    return made(along, "normals", along.state, (("N", found), ("bias", rest)), "normal forces")
