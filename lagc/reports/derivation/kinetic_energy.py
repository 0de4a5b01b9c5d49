"""The section on the kinetic energy.

K of a body is made of the components of its velocity, in the unit vectors in which they are short, and of its
rotation in the axes in which the inertia is constant. A component with a sum of rates, or of a rate and a
drive, stays together where K is shorter so: the rotation of a top about its axis, m (x' + gamma t)^2.
"""

from itertools import combinations_with_replacement

from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite, Polynomial
from lagc.reports.derivation.document import Row, math
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.writer import in_parentheses, subscript, width_of
from lagc.semantics.model import Body, Frame
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import dot, matmul, matvec, transpose


def write_kinetic_energy(draft: Draft) -> None:
    """Write K of each body and K in all, by degree in the rates where drives move bodies."""
    writer, rates, bodies = draft.writer, draft.rates, draft.model.bodies
    draft.heading("h_kinetic")
    if rates.kinetic.is_zero:
        draft.paragraph("no_mass")
        return
    energies = [_shortest(draft, body) for body in bodies]
    for body, energy in zip(bodies, energies):
        _write_body(draft, body, energy)
    kinetic = [x for x in rates.free_terms if x.is_kinetic]
    for term in kinetic:
        draft.formula(draft.row(rf"K_{{{subscript(term.name)}}}", term.function, f"K of {term.name}"))
    draft.kinetic = draft.graph.sum([*energies, *[term.function for term in kinetic]])
    if len(energies) + len(kinetic) > 1:
        draft.paragraph("in_total")
        draft.formula(Row("K", writer.lines(draft.kinetic, "K", of=rates.kinetic)))
    parts = draft.analysis.kinetic_parts
    if parts and rates.declared.plain and not rates.free_terms and not all(map(writer.is_zero, parts[1:])):
        draft.paragraph("degrees", math("K = K_2 + K_1 + K_0"))
        draft.formula(*[draft.row(f"K_{2 - k}", x, f"K{2 - k}") for k, x in enumerate(parts)])


def _write_body(draft: Draft, body: Body, energy: Node) -> None:
    """Write K of a body by its definition, then in components."""
    writer, definition = draft.writer, list[str]()
    if not writer.is_zero(body.mass) and not all(map(writer.is_zero, body.velocity)):
        mass = in_parentheses(writer.text(body.mass, f"mass of {body.name}"))
        definition.append(rf"\tfrac{{1}}{{2}}\, {mass}\, \vec{{V}}({draft.centres[body.name]})^2")
    if body.frame is not None and not all(map(writer.is_zero, body.frame.spin)):
        omega, inertia = draft.omega(body.frame), rf"\mathbf{{I}}_{{{writer.name(body.name)}}}"
        definition.append(rf"\tfrac{{1}}{{2}}\, {omega} \cdot {inertia}\, {omega}")
    if definition:
        lines = writer.lines(energy, f"K of {body.name}", of=body.kinetic_energy)
        draft.formula(Row(rf"K_{{{subscript(body.name)}}}", (" + ".join(definition),)), Row("=", lines))


def _shortest(draft: Draft, body: Body) -> Node:
    """Return K of a body by its components, with sums that stay together where it is shorter so. Where it is
    too long to be multiplied out, it is as it was derived."""
    writer = draft.writer
    try:
        together, opened = (_energy(draft, body, keep) for keep in (True, False))
        widths = [
            width_of([writer.latex.total(writer.total(writer.polynomial(x)))]) for x in (together, opened)
        ]
    except (TooLarge, NotFinite):
        return body.kinetic_energy
    return together if widths[0] < widths[1] else opened


def _energy(draft: Draft, body: Body, keep: bool) -> Node:
    """Return 1/2 m V^2 + 1/2 Omega . I Omega; sums of rates are symbols of parts if they are to `keep`
    together."""
    node_of, terms = draft.writer.node_of, list[Node]()
    components = [(_component(draft, p, keep), unit) for p, unit in draft.vectors.express(body.velocity)]
    # V^2 = sum of x_i x_k e_i . e_k; unit vectors of different frames are not perpendicular.
    for i, (x, unit) in enumerate(components):
        terms.append(0.5 * body.mass * x * x)
        for y, other in components[i + 1 :]:
            cosine = draft.writer.polynomial(dot(unit.axis, other.axis))
            terms += [body.mass * x * y * node_of(cosine)] if cosine else []
    if body.frame is not None:
        inertia, rotation = _inertia_axes(draft, body, body.frame)
        own = [_component(draft, p, keep) for p in rotation]
        for i, k in combinations_with_replacement(range(3), 2):
            terms.append((0.5 if i == k else 1.0) * node_of(inertia[i][k]) * own[i] * own[k])
    return draft.graph.sum(terms)


def _inertia_axes(draft: Draft, body: Body, frame: Frame) -> tuple[list[list[Polynomial]], list[Polynomial]]:
    """Return the inertia and the rotation of a body in the axes, among those that lead to its own, in which
    the inertia is constant and the rotation is shortest."""
    writer, moving = draft.writer, {*draft.rates.states.q, draft.equations.time}
    assert body.inertia is not None
    best = [writer.polynomials(row) for row in body.inertia], writer.polynomials(frame.angular_velocity)
    for each in draft.chain(frame)[::-1]:
        turned = matmul(transpose(each.axes), frame.axes)
        inertia = [writer.polynomials(row) for row in matmul(matmul(turned, body.inertia), transpose(turned))]
        if any(writer.symbols_in(p) & moving for row in inertia for p in row):
            continue
        rotation = writer.polynomials(matvec(transpose(each.axes), frame.spin))
        if sum(map(draft.vectors.size, rotation)) < sum(map(draft.vectors.size, best[1])):
            best = inertia, rotation
    return best


def _component(draft: Draft, p: Polynomial, keep: bool) -> Node:
    """Return a component; its sum of rates, or of a rate and a drive, is the symbol of a part."""
    writer, content = draft.writer, draft.writer.algebra.content
    if keep and len(p) > 1:
        c, common, rest = content(p)
        moving = {*draft.rates.symbols, draft.equations.time}
        if writer.symbols_in(rest) & moving and not content(rest)[1]:
            return writer.node_of({common: c}) * writer.part(rest)
    return writer.node_of(p)
