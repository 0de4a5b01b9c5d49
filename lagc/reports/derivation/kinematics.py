"""The sections on kinematics and on virtual velocities."""

from collections.abc import Callable, Iterable, Sequence

from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite
from lagc.reports.derivation.document import Row
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.unit_vectors import WORLD, Components, Unit
from lagc.reports.derivation.writer import seen_width
from lagc.semantics.model import Frame
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, matmul, matvec, sub, transpose
from lagc.symbolic.walk import depends

ONE_LINE = 110  # characters of the three axes of a frame that stand on one line
LESS = 1e-9  # a difference of lengths


def write_kinematics(draft: Draft) -> None:
    """Write unit vectors, positions, velocities, rotation vectors and accelerations."""
    rates, bodies = draft.rates, {draft.centres[b.name]: b for b in draft.model.bodies}
    draft.heading("h_kinematics")
    positions, velocities, accelerations = [], [], []
    for point, place in _moving_points(draft).items():
        velocity = bodies[point].velocity if point in bodies else rates.velocity(place)
        acceleration = rates.acceleration(velocity)
        positions.append(Row(rf"\overrightarrow{{O\,{point}}}", draft.vector(place, f"position of {point}")))
        velocities.append(Row(rf"\vec{{V}}({point})", draft.vector(velocity, f"velocity of {point}")))
        lines = draft.vector(acceleration, f"acceleration of {point}")
        accelerations.append(Row(rf"\vec{{a}}({point})", lines))
    frames = _frames_in_use(draft)
    spins = [Row(draft.omega(f), rotation(draft, f)) for f in frames]
    # Velocities of bodies are those of the model, which drives may move; those of other points follow from
    # places.
    for rows, title in (
        (_unit_vector_rows(draft, frames), "bases"),  # last, when those in use are known
        (positions, "positions"),
        (velocities, "velocities"),
        (spins, "rotations"),
        (accelerations, "accelerations"),
    ):
        if rows:
            draft.paragraph(title)
            draft.formula(*rows)


def _moving_points(draft: Draft) -> dict[str, Vector]:
    """Return the declared points and the centres of bodies that move, by their letters."""
    found = {draft.writer.name(p.name): p.position for p in draft.model.points}
    for body in draft.model.bodies:
        found.setdefault(draft.centres[body.name], body.position)
    moving = [*draft.rates.states.q, draft.equations.time]
    return {letters: place for letters, place in found.items() if depends(place, moving)}


def _frames_in_use(draft: Draft) -> list[Frame]:
    """Return the frames of bodies, those that lead to them, and those in which vectors are written."""
    chains, vectors = {x for _, frame in draft.solids for x in draft.chain(frame)}, draft.vectors
    written = [f for f in draft.frames if vectors.used & {unit.latex for unit in vectors.of_frame[f.name]}]
    return [f for f in draft.frames if f in chains or f in written]


def _unit_vector_rows(draft: Draft, frames: Iterable[Frame]) -> list[Row]:
    """Define the unit vectors that are no axes of the world, axes of a frame in those of its parent."""
    vectors, rows = draft.vectors, list[Row]()
    for turn in vectors.made:
        units = [unit for _, unit in (turn.u, turn.v)]
        if vectors.used & {unit.latex for unit in units}:
            rows += [_unit_row(draft, unit, unit.axis, vectors.world) for unit in units]
    by_name = {f.name: f for f in draft.frames}
    for frame in frames:
        parent = by_name.get(frame.parent)
        axes = frame.axes if parent is None else matmul(transpose(parent.axes), frame.axes)
        base = vectors.of_frame[WORLD if parent is None else parent.name]
        pairs = zip(vectors.of_frame[frame.name], transpose(axes))
        own = [_unit_row(draft, unit, column, base) for unit, column in pairs]
        line = r",\quad ".join([f"{row.left} = {''.join(row.lines)}" for row in own])
        rows += [Row("", (line,))] if seen_width(line) < ONE_LINE else own
    return rows


def _unit_row(draft: Draft, unit: Unit, components: Vector, base: Sequence[Unit]) -> Row:
    try:
        found = [(p, u) for p, u in zip(draft.writer.polynomials(components), base) if p]
    except (TooLarge, NotFinite):
        return Row(unit.latex, draft.vector(unit.axis, "a unit vector"))
    return Row(unit.latex, draft.components(found, unit.axis, "a unit vector"))


Velocities = Callable[[Sequence[Node]], list[Node]]


def rotation(draft: Draft, frame: Frame, of: Velocities = list) -> tuple[str, ...]:
    """Return the lines of a rotation vector, the sum of simple rotations, each about an axis that both frames
    share; where it is shorter in other unit vectors, in these. `of` makes virtual velocities of others."""
    vector, stars, vectors = of(frame.spin), of is not list, draft.vectors
    about = f"{'virtual ' if stars else ''}rotation of {frame.name}"
    try:
        total: Components = []
        before = None
        for each in draft.chain(frame):
            total += _simple_rotation(draft, each, before, of)
            before = each
        best = vectors.express(vector)
        shortest = best if vectors.cost(best) < vectors.cost(total) - LESS else total
        return draft.components(shortest, vector, about, stars)
    except (TooLarge, NotFinite):
        return draft.vector(vector, about, stars)


def _simple_rotation(draft: Draft, frame: Frame, before: Frame | None, of: Velocities) -> Components:
    """Return the rotation of a frame relative to the one before it, along an axis of that where it is the
    same."""
    writer, units = draft.writer, draft.vectors.of_frame
    x, y, z = of(frame.spin if before is None else sub(frame.spin, before.spin))
    polynomials = writer.polynomials(matvec(transpose(frame.axes), (x, y, z)))
    own = [(p, k) for k, p in enumerate(polynomials) if p]
    if len(own) == 1:
        ((p, k),) = own
        shared = units[WORLD if before is None else before.name][k]
        if not any(writer.polynomials(sub(shared.axis, units[frame.name][k].axis))):
            return [(p, shared)]
    return [(p, units[frame.name][k]) for p, k in own]


def write_virtual_velocities(draft: Draft) -> None:
    """Write V* and Omega*, and the virtual velocities that are compatible with the explicit constraints."""
    writer, rates, model = draft.writer, draft.rates, draft.model
    draft.heading("h_virtual")
    rows: dict[str, Row] = {}
    for body in model.bodies:
        letters = rf"\vec{{V}}^*({draft.centres[body.name]})"
        star = draft.vector(rates.virtual(body.velocity), f"virtual velocity of {body.name}", stars=True)
        rows.setdefault(letters, Row(letters, star))
    for _, frame in draft.solids:
        rows[draft.omega(frame, "^*")] = Row(draft.omega(frame, "^*"), rotation(draft, frame, rates.virtual))
    if rows:
        draft.formula(*rows.values())
    # Virtual velocities are taken at fixed time: the share of drives is left out, and named where there is
    # one.
    drives = rates.declared.at_rest([x for body in model.bodies for x in body.velocity])
    if not all(map(writer.is_zero, drives)):
        draft.paragraph("drives_stay")
    closed = rf" \quad (\text{{{draft.say('closed')}}})"
    conditions = [(row.label, row.rate, "") for row in draft.equations.rows]
    conditions += [(c.label, c.rate, closed) for c in draft.equations.contacts if not c.normals]
    if conditions:
        draft.paragraph("compatible")
        virtual = rates.virtual([rate for _, rate, _ in conditions])
        draft.formula(*[draft.row("", node, f"compatible with {label}", f" = 0{note}", stars=True)
                        for (label, _, note), node in zip(conditions, virtual)])  # fmt: skip
