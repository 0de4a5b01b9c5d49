"""The sections on kinematics and on virtual velocities."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite
from lagc.reports.derivation.document import FormulaRow
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.unit_vectors import WORLD, Unit
from lagc.reports.derivation.writer import seen_width
from lagc.semantics.model import Frame
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, matmul, matvec, sub, transpose
from lagc.symbolic.walk import depends

ONE_LINE = 130  # characters of the three axes of a frame that stand on one line


def write_kinematics(draft: Draft) -> None:
    """Write unit vectors, positions, velocities, rotation vectors and accelerations."""
    say, rates = draft.say, draft.rates
    draft.heading(2, say("h_kinematics"))
    positions, velocities, accelerations = [], [], []
    for letters, place in _moving_points(draft).items():
        body = next((b for b in draft.model.bodies if draft.centres[b.name] == letters), None)
        velocity = rates.velocity(place) if body is None else body.velocity
        position = draft.vector(place, f"position of {letters}")
        positions.append(FormulaRow(rf"\overrightarrow{{O\,{letters}}}", position))
        velocities.append(
            FormulaRow(draft.velocity_letters(letters), draft.vector(velocity, f"velocity of {letters}"))
        )
        acceleration = draft.vector(rates.acceleration(velocity), f"acceleration of {letters}")
        accelerations.append(FormulaRow(rf"\vec{{a}}({letters})", acceleration))
    frames = _frames_in_use(draft)
    spins = [FormulaRow(draft.rotation_letters(f), rotation(draft, f)) for f in frames]
    for rows, title in (
        (_unit_vector_rows(draft, frames), "bases"),  # last, when those in use are known
        (positions, "positions"),
        (velocities, "velocities"),
        (spins, "rotations"),
        (accelerations, "accelerations"),
    ):
        if rows:
            draft.paragraph(say(title))
            draft.formula(*rows)


def _moving_points(draft: Draft) -> dict[str, Vector]:
    """Return the declared points and the centres of bodies that move, by their letters."""
    model = draft.model
    found = {draft.writer.name(p.name): p.position for p in model.points}
    for body in model.bodies:
        found.setdefault(draft.centres[body.name], body.position)
    moving = [*draft.rates.states.q, draft.equations.time]
    return {letters: place for letters, place in found.items() if depends(place, moving)}


def _frames_in_use(draft: Draft) -> list[Frame]:
    """Return the frames of bodies, those that lead to them, and those in which vectors are written."""
    chains = {x for _, frame in draft.solids for x in draft.chain(frame)}
    vectors = draft.vectors
    return [f for f in draft.frames
            if f in chains or not vectors.used.isdisjoint(u.latex for u in vectors.of_frame[f.name])]  # fmt: skip


def _unit_vector_rows(draft: Draft, frames: Iterable[Frame]) -> list[FormulaRow]:
    """Define the unit vectors that are no axes of the world."""
    rows = []
    for turn in draft.vectors.made:
        for _, unit in (turn.u, turn.v):
            if not draft.vectors.used.isdisjoint((turn.u[1].latex, turn.v[1].latex)):
                rows.append(FormulaRow(unit.latex, _along(draft, unit, unit.axis, draft.vectors.world)))
    for frame in frames:
        rows += _axis_rows(draft, frame)
    return rows


def _axis_rows(draft: Draft, frame: Frame) -> list[FormulaRow]:
    """Define the axes of a frame in those of its parent."""
    by_name = {f.name: f for f in draft.frames}
    parent = by_name.get(frame.parent)
    axes = frame.axes if parent is None else matmul(transpose(parent.axes), frame.axes)
    units = draft.vectors.of_frame[WORLD if parent is None else parent.name]
    own = draft.vectors.of_frame[frame.name]
    rows = [
        FormulaRow(unit.latex, _along(draft, unit, column, units))
        for unit, column in zip(own, transpose(axes))
    ]
    line = r",\quad ".join([f"{row.left} = {''.join(row.lines)}" for row in rows])
    return [FormulaRow("", (line,))] if seen_width(line) < ONE_LINE else rows


def _along(draft: Draft, unit: Unit, components: Vector, units: Sequence[Unit]) -> tuple[str, ...]:
    try:
        found = [(p, u) for p, u in zip(draft.writer.polynomials(components), units) if p]
    except (TooLarge, NotFinite):
        return draft.vector(unit.axis, "a unit vector")
    return draft.components(found, unit.axis, "a unit vector")


def rotation(
    draft: Draft, frame: Frame, of: Callable[[Sequence[Node]], Sequence[Node]] = list
) -> tuple[str, ...]:
    """Return the lines of a rotation vector, the sum of simple rotations, each about an axis that both frames
    share; shorter in other unit vectors, it is written so. `of` makes virtual velocities of velocities."""
    virtual = of is not list
    about = f"{'virtual ' if virtual else ''}rotation of {frame.name}"
    leading = draft.writer.stars if virtual else None
    x, y, z = of(frame.spin)
    try:
        total, before = [], None
        for each in draft.chain(frame):
            total += _simple_rotation(draft, each, before, of)
            before = each
        best = draft.vectors.express((x, y, z))
        shortest = best if draft.vectors.cost(best) < draft.vectors.cost(total) - 1e-9 else total
        return draft.components(shortest, (x, y, z), about, leading)
    except (TooLarge, NotFinite):
        return draft.vector((x, y, z), about, leading)


def _simple_rotation(
    draft: Draft, frame: Frame, before: Frame | None, of: Callable[[Sequence[Node]], Sequence[Node]]
) -> list:  # type: ignore[type-arg]
    """Return the rotation of a frame relative to the one before it, along axes of the frame, or along that of
    the one before where it is the same."""
    writer, vectors = draft.writer, draft.vectors
    x, y, z = of(frame.spin if before is None else sub(frame.spin, before.spin))
    polynomials = writer.polynomials(matvec(transpose(frame.axes), (x, y, z)))
    own = [(p, unit) for p, unit in zip(polynomials, vectors.of_frame[frame.name]) if p]
    if len(own) == 1:
        k = next(i for i, p in enumerate(polynomials) if p)
        shared = vectors.of_frame[WORLD if before is None else before.name][k]
        if not any(writer.polynomials(sub(shared.axis, own[0][1].axis))):
            return [(own[0][0], shared)]
    return own


def write_virtual_velocities(draft: Draft) -> None:
    """Write V* and Omega*, and the virtual velocities that are compatible with the explicit constraints."""
    say, writer, rates = draft.say, draft.writer, draft.rates
    draft.heading(2, say("h_virtual"))
    rows: dict[str, FormulaRow] = {}
    driven = False
    for body in draft.model.bodies:
        letters = draft.velocity_letters(draft.centres[body.name], "^*")
        if letters not in rows:
            star = rates.virtual(body.velocity)
            rows[letters] = FormulaRow(
                letters, draft.vector(star, f"virtual velocity of {body.name}", writer.stars)
            )
        driven = driven or not all(writer.is_zero(x) for x in rates.declared.at_rest(list(body.velocity)))
    for _, frame in draft.solids:
        letters = draft.rotation_letters(frame, "^*")
        rows[letters] = FormulaRow(letters, rotation(draft, frame, rates.virtual))
    if rows:
        draft.formula(*rows.values())
    if driven:
        draft.paragraph(say("drives_stay"))
    conditions = [(row.label, row.rate, "") for row in draft.equations.rows]
    closed = rf" \quad (\text{{{say.word('closed')}}})"
    conditions += [(c.label, c.rate, closed) for c in draft.equations.contacts if not c.normals]
    if conditions:
        draft.paragraph(say("compatible"))
        found = rates.virtual([rate for _, rate, _ in conditions])
        draft.formula(*[
            FormulaRow("", writer.lines(node, f"compatible with {label}", writer.stars), f" = 0{note}")
            for (label, _, note), node in zip(conditions, found)
        ])  # fmt: skip
