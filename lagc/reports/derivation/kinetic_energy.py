"""The section on the kinetic energy.

K of a body is written in the unit vectors of its velocity, and in the axes in which its inertia is constant
and its rotation is short. A component with a sum of rates, or of a rate and a drive, stays together where K
is shorter so: the rotation of a top about its axis, m (x' + gamma t)^2.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite, Polynomial
from lagc.reports.derivation.document import FormulaRow, math
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.unit_vectors import Components
from lagc.reports.derivation.writer import WIDTH, in_parentheses, subscript, width_of
from lagc.reports.patterns.formula_trees import Form, Term, Total
from lagc.semantics.model import Body, Frame
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import dot, matmul, matvec, transpose

HALF = Fraction(1, 2)


def write_kinetic_energy(draft: Draft) -> None:
    """Write K of each body and K in all, by degree in the rates where drives move bodies."""
    say, writer, rates = draft.say, draft.writer, draft.rates
    draft.heading(2, say("h_kinetic"))
    for body in draft.model.bodies:
        _write_body(draft, body)
    for term in [x for x in rates.free_terms if x.is_kinetic]:
        draft.formula(
            FormulaRow(rf"K_{{{subscript(term.name)}}}", writer.lines(term.function, f"K of {term.name}"))
        )
    if rates.kinetic.is_zero:
        draft.paragraph(say("no_mass"))
        return
    draft.kinetic = _shortest(draft)
    draft.paragraph(say("in_total"))
    draft.formula(FormulaRow("K", writer.lines(draft.kinetic, "K", of=rates.kinetic)))
    parts = draft.analysis.kinetic_parts
    if (
        parts
        and rates.declared.plain
        and not rates.free_terms
        and not all(writer.is_zero(x) for x in parts[1:])
    ):
        draft.paragraph(say("degrees", math("K = K_2 + K_1 + K_0")))
        draft.formula(*[FormulaRow(f"K_{2 - k}", writer.lines(x, f"K{2 - k}")) for k, x in enumerate(parts)])


def _write_body(draft: Draft, body: Body) -> None:
    """Write K of a body by its definition, then in components."""
    writer, centre = draft.writer, draft.centres[body.name]
    linear = 0.5 * body.mass * dot(body.velocity, body.velocity)
    has_mass = not writer.is_zero(linear)
    definition, lines = list[str](), list[tuple[str, ...]]()
    if has_mass:
        mass = in_parentheses(writer.text(body.mass, f"mass of {body.name}"))
        definition.append(rf"\tfrac{{1}}{{2}}\, {mass}\, {draft.velocity_letters(centre)}^2")
        lines.append(_translation_lines(draft, body, linear))
    if body.frame is not None and body.inertia is not None:
        spin = body.frame.angular_velocity
        turning = 0.5 * dot(spin, matvec(body.inertia, spin))
        if not writer.is_zero(turning):
            omega = draft.rotation_letters(body.frame)
            definition.append(
                rf"\tfrac{{1}}{{2}}\, {omega} \cdot \mathbf{{I}}_{{{writer.name(body.name)}}}\, {omega}"
            )
            lines.append(_rotation_lines(draft, body, body.frame, turning))
    if definition:
        left = rf"K_{{{subscript(body.name)}}}"
        draft.formula(FormulaRow(left, (" + ".join(definition),)), FormulaRow("=", _added(lines)))


def _added(lines: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Return sums as one, on one line where it is short."""
    first, *others = lines
    for second in others:
        if len(first) == len(second) == 1 and width_of([*first, *second]) < WIDTH:
            first = (f"{first[0]} + {second[0]}",)
        else:
            first = (*first, f"+ {second[0]}", *second[1:])
    return first


def _translation_lines(draft: Draft, body: Body, node: Node) -> tuple[str, ...]:
    writer, about = draft.writer, f"K of {body.name}"
    try:
        components = draft.vectors.express(body.velocity)
        if components and draft.vectors.are_orthonormal(components):
            return weighted_squares(
                draft, [(writer.polynomial(body.mass), [p for p, _ in components])], node, about
            )
        return writer.lines(_translation(draft, body), about, of=node)
    except (TooLarge, NotFinite):
        return writer.lines(node, about)


def _rotation_lines(draft: Draft, body: Body, frame: Frame, node: Node) -> tuple[str, ...]:
    """Return 1/2 (A (p^2 + q^2) + C r^2), equal moments together, where products of inertia have no share."""
    about = f"K of the rotation of {body.name}"
    try:
        inertia, components = inertia_axes(draft, body, frame)
    except (TooLarge, NotFinite):
        return draft.writer.lines(node, about)
    pairs = [(i, j) for i in range(3) for j in range(3) if i != j and components[i] and components[j]]
    if any(inertia[i][j] for i, j in pairs):
        return draft.writer.lines(node, about)
    groups: list[tuple[Polynomial, list[Polynomial]]] = []
    for k in [k for k in range(3) if components[k] and inertia[k][k]]:
        same = next((own for moment, own in groups if moment == inertia[k][k]), None)
        if same is None:
            groups.append((inertia[k][k], [components[k]]))
        else:
            same.append(components[k])
    return weighted_squares(draft, groups, node, about)


def inertia_axes(draft: Draft, body: Body, frame: Frame) -> tuple[list[list[Polynomial]], list[Polynomial]]:
    """Return the inertia and the rotation of a body in the axes, among those that lead to its own, in which
    the inertia is constant and the rotation is shortest."""
    writer, best = draft.writer, None
    assert body.inertia is not None
    moving = {*draft.rates.states.q, draft.equations.time}
    for each in draft.chain(frame):
        turned = matmul(transpose(each.axes), frame.axes)
        inertia = [writer.polynomials(row) for row in matmul(matmul(turned, body.inertia), transpose(turned))]
        if any(writer.symbols_in(p) & moving for row in inertia for p in row):
            continue
        components = writer.polynomials(matvec(transpose(each.axes), frame.spin))
        cost = sum(draft.vectors.size(p) for p in components)
        if best is None or cost <= best[0]:
            best = (cost, inertia, components)
    if best is None:  # the axes of the body, where its inertia is constant as it was declared
        return [writer.polynomials(row) for row in body.inertia], writer.polynomials(frame.angular_velocity)
    return best[1], best[2]


def weighted_squares(
    draft: Draft, groups: Sequence[tuple[Polynomial, Sequence[Polynomial]]], node: Node, about: str
) -> tuple[str, ...]:
    """Return the lines of the sum of 1/2 weight (p^2 + q^2 + ...)."""
    writer, terms = draft.writer, list[Term]()
    for weight, components in groups:
        squares = [_square(writer.factored(p)) for p in components]
        inner: list[tuple[Form, int]] = (
            list(squares[0].factors) if len(squares) == 1 else [(Total(tuple(squares)), 1)]
        )
        form = writer.factored(weight)
        size = HALF * (squares[0].size if len(squares) == 1 else 1)
        if len(form.terms) == 1 and not form.terms[0].negative:
            (term,) = form.terms
            terms.append(Term(False, size * term.size, (*term.factors, *inner)))
        else:
            terms.append(Term(False, size, ((form, 1), *inner)))
    return writer.shown(Total(tuple(terms)), about, node)


def _square(form: Total) -> Term:
    """Return the square of a form."""
    if len(form.terms) == 1:
        (term,) = form.terms
        return Term(False, term.size**2, tuple([(f, 2 * e) for f, e in term.factors]))
    return Term(False, 1, ((form, 2),))


# -- K in all ---------------------------------------------------------------------------------------


def _shortest(draft: Draft) -> Node:
    """Return K made of the components that are written, with sums that stay together where it is shorter so.
    Where it is too long to be multiplied out, it is as it was derived."""
    writer, rates = draft.writer, draft.rates
    try:
        together, opened = (_sum(draft, keep) for keep in (True, False))
        widths = [
            width_of([writer.latex.total(writer.total(writer.polynomial(x)))]) for x in (together, opened)
        ]
    except (TooLarge, NotFinite):
        return rates.kinetic
    return together if widths[0] < widths[1] else opened


def _sum(draft: Draft, keep: bool) -> Node:
    """Return K, with sums of rates as the symbols of parts if they are to `keep` together."""
    terms = [_translation(draft, body, keep) for body in draft.model.bodies]
    for body, frame in draft.solids:
        inertia, components = inertia_axes(draft, body, frame)
        own = [_kept(draft, p, keep) for p in components]
        for i in range(3):
            for k in range(i, 3):
                if components[i] and components[k] and inertia[i][k]:
                    weight = draft.writer.node_of(inertia[i][k])
                    terms.append((0.5 if i == k else 1.0) * weight * own[i] * own[k])
    return draft.graph.sum([*terms, *[x.function for x in draft.rates.free_terms if x.is_kinetic]])


def _translation(draft: Draft, body: Body, keep: bool = True) -> Node:
    """Return 1/2 m V^2, with V in the unit vectors that make it short and the cosines between these."""
    components: Components = draft.vectors.express(body.velocity)
    own = [(_kept(draft, p, keep), unit) for p, unit in components]
    terms = []
    for i, (x, unit) in enumerate(own):
        terms.append(0.5 * body.mass * x * x)
        for y, other in own[i + 1 :]:
            cosine = draft.writer.polynomial(dot(unit.axis, other.axis))
            if cosine:
                terms.append(body.mass * x * y * draft.writer.node_of(cosine))
    return draft.graph.sum(terms)


def _kept(draft: Draft, p: Polynomial, keep: bool) -> Node:
    """Return a component; its sum of rates, or of a rate and a drive, is the symbol of a part."""
    writer = draft.writer
    c, common, rest = writer.algebra.content(p)
    moving = {*draft.rates.symbols, draft.equations.time}
    if keep and len(rest) > 1 and writer.symbols_in(rest) & moving and not writer.algebra.content(rest)[1]:
        return writer.node_of({common: c}) * writer.part(rest)
    return writer.node_of(p)
