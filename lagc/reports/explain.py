"""Facts that were inferred from a model: as plain data, and as text."""

import math
from collections.abc import Iterable
from typing import Any

from lagc.diagnostics.faults import as_json
from lagc.lowering.program import Interface, Program
from lagc.mechanics.analysis.analysis import RowKind, analyse
from lagc.mechanics.formulation.equations import Contribution, EquationsOfMotion, StartValue, WhenEquations
from lagc.reports.equations.write import Expressions
from lagc.reports.names import ranged, where
from lagc.semantics.joints import KINDS
from lagc.semantics.model import UNSTATED, Contact, Joint, Lagrangian
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import derived
from lagc.symbolic.walk import evaluate, symbols

Facts = dict[str, Any]  # what JSON can hold
MOST = 20  # lines of a section, without --verbose


def explanation(equations: EquationsOfMotion, program: Program, whole: bool = True) -> Facts:
    """The facts of one scene of a model; numbers in SI; expressions `whole`, or as long as people read."""
    model, analysis = equations.model, analyse(equations)
    written = Expressions(equations, whole)
    interface = program.interface
    parts = analysis.kinetic_parts or ()
    (*texts, potential), energy_parts = written.texts([*parts, equations.potential])
    kinetic = dict(zip(("K2", "K1", "K0"), texts)) or None
    # Speeds of coordinates that were dropped count nowhere.
    idle, until = analysis.speeds - interface.nv, _until(equations)

    def said(node: Node) -> str:
        return written.short(node) or _energy(equations, node, kinetic, potential) or written.text(node)

    # The energies are written above, because what is conserved refers to them; short names come last, when
    # everything that has one is written.
    facts: Facts = {
        **_declared(equations, interface, written),
        "constraints": [_constraint(equations, kind) for kind in analysis.constraints],
        "contacts": [_contact(c.contact, written) for c in equations.contacts],
        "redundant": list(analysis.redundant),
        "open_reactions": list(analysis.open_reactions),
        "unseen": list(analysis.unseen),
        "count": _count(interface),
        "dropped": list(interface.dropped),
        "degrees_of_freedom": analysis.degrees_of_freedom - idle,
        "positional_freedom": analysis.positional_freedom - idle,
        "more_at_start": analysis.more_at_start,
        "actions": [_action(equations, c, written if whole else None) for c in equations.contributions],
        "cyclic": [name for name in analysis.cyclic if name not in interface.dropped],
        "conserved": [
            {"name": c.name, "expression": said(c.expression), "reason": c.reason + until, "proved": c.proved}
            for c in analysis.conserved
            if not c.expression.is_zero
        ],
        "seems": _fields(analysis.seems, "cyclic redundant degrees_of_freedom positional_freedom"),
        "not_examined": list(analysis.not_examined),
        "kinetic": kinetic,
        "potential": potential,
        **({"energy_parts": energy_parts} if energy_parts else {}),
        "pruned": _pruned(equations, program),
        "relations": _relations(interface),
        "whens": [_when(when, written) for when in equations.whens],
        "operations": _operations(program),
        "notes": list(model.notes),
        "warnings": as_json(equations.warnings),
    }
    facts["short_names"] = dict(where(written.seen))
    return facts


def _declared(equations: EquationsOfMotion, interface: Interface, written: Expressions) -> Facts:
    """Return the declarations of a scene."""
    model = equations.model
    return {
        "model": model.name,
        "scene": model.scene,
        "description": model.description,
        "scenes": list(model.scenes),
        "effects": {
            "used": [_fields(e, "name description") for e in model.effects if e.used],
            "left_out": [_fields(e, "name description") for e in model.effects if not e.used],
        },
        "coordinates": _coordinates(equations),
        "speeds": [{"name": n, "unit": u} for n, u in zip(equations.v_names, equations.v_units)],
        "parameters": [_fields(p, "name unit value description") for p in interface.parameters],
        "inputs": [{"name": i.name, "unit": i.unit, "default": i.value} for i in interface.inputs],
        **_discretes(equations, written),
        **({"joints": [_joint(joint) for joint in model.joints]} if model.joints else {}),
    }


def _until(equations: EquationsOfMotion) -> str:
    """Return where what is conserved stays so: between events, and apart from contacts and friction."""
    if any(when.changes for when in equations.whens):
        return ", between events"
    rough = [bool(c.normals) for c in equations.contacts]  # and the others are one-sided
    open_ones = [", while contacts are open"] if not all(rough) else []
    smooth = [" and without friction" if open_ones else ", without friction"] if any(rough) else []
    return "".join([*open_ones, *smooth])


def _energy(equations: EquationsOfMotion, node: Node, kinetic: Facts | None, potential: str) -> str:
    """The energy by its parts, which are shown with it; "" for anything else."""
    free = any(isinstance(action, Lagrangian) for action in equations.model.actions)
    if node is not equations.energy or kinetic is None or free:
        return ""
    text = "K2" + (" - K0" if kinetic["K0"] != "0" else "")
    return text + (" + V" if potential != "0" else "")


def _fields(record: object, names: str) -> Facts:
    """Return some fields of a record by their names; tuples become lists."""
    found = {name: getattr(record, name) for name in names.split()}
    return {name: list(value) if isinstance(value, tuple) else value for name, value in found.items()}


def _joint(joint: Joint) -> Facts:
    return {**_fields(joint, "name kind between coordinates equations"), "torsor": KINDS[joint.kind].torsor}


def _action(equations: EquationsOfMotion, c: Contribution, written: Expressions | None) -> Facts:
    """The kind of an action; `written`, also its generalized force on each speed, Q_j, whose virtual power is
    the sum of Q_j times the virtual speeds."""
    facts = _fields(c, "name kind effect conservative")
    if written is None:
        return facts
    forces = {equations.v_names[j]: written.text(x) for j, x in sorted(c.forces.items()) if not x.is_zero}
    power = " + ".join([f"({force})*virtual({name})" for name, force in forces.items()]) or "0"
    return {**facts, "generalized_forces": forces, "virtual_power": power}


def _relations(interface: Interface) -> list[Facts]:
    return [
        {"condition": words, "known": k < interface.timed_relations}
        for k, words in enumerate(interface.relations)
        if interface.drives(k)
    ]


def _operations(program: Program) -> Facts:
    interface, functions = program.interface, program.functions
    return {
        "right_hand_side": interface.operations,
        "watching": functions["watch"].cost if "watch" in functions else 0,
        "preparation": interface.preparation,
        "solve": interface.solve,
        "lifted": interface.velocity_unknowns,
        "functions": {name: function.cost for name, function in functions.items()},
    }


def _coordinates(equations: EquationsOfMotion) -> list[Facts]:
    values = {p.symbol: p.value for p in equations.model.parameters if p.value is not None}
    described = {c.name: c.description for c in equations.model.coordinates}
    parts = {i + k for i in equations.quaternions for k in range(4)}
    held = [row.residual for row in equations.rows if row.holonomic]
    searched = symbols([*held, *(residual for residual, _ in equations.initial_conditions)])
    found: list[Facts] = []
    whole = zip(equations.q, equations.q_names, equations.q_units, equations.starts_q)
    for i, (q, name, unit, start) in enumerate(whole):
        found.append({
            "name": name,
            "kind": "part of a unit quaternion" if i in parts else "scalar",
            "unit": unit,
            "start": _start(start, values),
            "fixed": start.fixed,
            "found": q in searched and start.stated.level == UNSTATED,
            "description": described.get(name, ""),
        })  # fmt: skip
    return found


def _start(start: StartValue, values: dict[Any, float]) -> float | None:
    """Its value with the default parameters; None where one has no default."""
    try:
        value = evaluate([start.value], values)[0]
    except KeyError:
        return None
    return value if math.isfinite(value) else None


def _constraint(equations: EquationsOfMotion, kind: RowKind) -> Facts:
    row = next(r for r in equations.rows if r.label == kind.label)
    return {
        "name": kind.constraint,
        "row": kind.label,
        "kind": "holonomic" if kind.holonomic else "non-holonomic",
        "time": "rheonomic" if kind.time_dependent else "scleronomic",
        **_fields(kind, "affine integrable"),
        "reason": kind.explanation,
        "proved": kind.proved,
        "effect": row.effect,
        "line": row.span.line,
        "unit": row.unit,
    }


def _count(interface: Interface) -> Facts:
    """n accelerations and p multipliers, n equations of motion and p constraint equations; dropped equations
    are counted apart."""
    return {
        "coordinates": interface.nq,
        "speeds": interface.nv,
        "rows": interface.nc,
        "unknowns": interface.nv + interface.nc,
        "equations": interface.nv + interface.nc,
        "dropped": len(interface.dropped),
    }


def _pruned(equations: EquationsOfMotion, program: Program) -> list[str]:
    model, interface = equations.model, program.interface
    lines = [f"effect `{e.name}` is left out" for e in model.effects if not e.used]
    lines += [f"`{name}` is dropped: nothing asked for depends on it" for name in interface.dropped]
    return lines + [note for note in interface.notes if note not in model.notes]


# -- as text -------------------------------------------------------------------


def text(facts: Facts, verbose: bool = False) -> str:
    """The facts for people; `verbose` adds the operation count of every function."""
    title = f"{facts['model']}, scene {facts['scene']}"
    blocks = [
        [title + _about(facts)],
        [f"note: {note}" for note in facts["notes"]],
        [f"warning: {fault['message']}; {fault['remedy']}" for fault in facts["warnings"]],
        _effects_text(facts),
        _section("coordinates", map(_coordinate_line, facts["coordinates"]), verbose),
        _section("speeds", _speed_lines(facts), verbose),
        _section("discrete variables", map(_discrete_line, facts.get("discretes", ())), verbose),
        _section("joints", map(_joint_line, facts.get("joints", ())), verbose),
        _section("constraints", map(_constraint_line, facts["constraints"]), verbose),
        _section("contacts", map(_contact_line, facts["contacts"]), verbose),
        _section("actions", map(_action_line, facts["actions"]), verbose),
        _count_text(facts),
        _section("cyclic coordinates", _cyclic_lines(facts) or ["none"], verbose),
        _section("conserved", [_conserved_line(c) for c in facts["conserved"]] or ["nothing found"], verbose),
        _energies_text(facts),
        _section("not examined", facts["not_examined"], verbose),
        _section("when", map(_when_line, facts["whens"]), verbose),
        _section("relations", map(_relation_line, facts["relations"]), verbose),
        _section("pruned", facts["pruned"] or ["nothing"], verbose),
        _operations_text(facts, verbose),
        _short_names_text(facts),
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _section(title: str, lines: Iterable[str], verbose: bool = True) -> list[str]:
    found = [f"  {line}" for line in lines]
    if len(found) > MOST and not verbose:
        found = ranged(found)
    if len(found) > MOST and not verbose:
        found[MOST - 1 :] = [f"  and {len(found) - MOST + 1} more: -v shows them"]
    return [title, *found] if found else []


def _effects_text(facts: Facts) -> list[str]:
    effects = facts["effects"]
    lines = [f"{e['name']}{_about(e)}" for e in effects["used"]]
    lines += [f"{e['name']}{_about(e)} (left out)" for e in effects["left_out"]]
    return _section("effects", lines)


def _about(fact: Facts) -> str:
    return f": {fact['description']}" if fact["description"] else ""


def _in_unit(fact: Facts) -> str:
    return f" [{fact['unit']}]" if fact["unit"] else ""


def _coordinate_line(fact: Facts) -> str:
    line = f"{fact['name']}{_in_unit(fact)}"
    if fact["start"] is not None:
        starts = "is computed, from the guess" if fact["found"] else "starts at"
        line += f" {starts} {quantity(fact['start'], fact['unit'])}{', held' if fact['fixed'] else ''}"
    if fact["kind"] != "scalar":
        line += f", {fact['kind']}"
    return line + _about(fact)


def _discretes(equations: EquationsOfMotion, written: Expressions) -> Facts:
    """The discrete variables, in models that have some; not the states of contacts."""
    states = {contact.state for contact in equations.model.contacts}
    found = [
        {"name": x.name, "unit": x.unit, "type": "Boolean" if x.boolean else "Real",
         "start": written.text(x.start), "description": x.description}
        for x in equations.model.discretes
        if x.symbol not in states
    ]  # fmt: skip
    return {"discretes": found} if found else {}


def _contact(contact: Contact, written: Expressions) -> Facts:
    opens = {"gap": contact.gap, **({} if contact.bounds_rate else {"restitution": contact.restitution})}
    given = {"friction": contact.friction, "static": contact.static}
    slip = [written.text(node) for node in contact.slip]
    return {
        "name": contact.label,
        "line": contact.span.line,
        **({} if contact.normals else {name: written.text(node) for name, node in opens.items()}),
        "unit": contact.unit,
        **({"law": "poisson"} if contact.poisson else {}),
        **{name: written.text(node) for name, node in given.items() if node is not None},
        **({"slip": slip[0] if len(slip) == 1 else f"{{{', '.join(slip)}}}"} if slip else {}),
        "states": contact.states,
    }


def _contact_line(fact: Facts) -> str:
    laws = [f"{n} {fact[n]}" for n in ("restitution", "law", "friction", "static", "slip") if n in fact]
    gap = fact["gap"] + " >= 0" if "gap" in fact else "always touches"
    return f"{fact['name']} (line {fact['line']}): {', '.join([gap, *laws])}"


def _discrete_line(fact: Facts) -> str:
    unit = " (true or false)" if fact["type"] == "Boolean" else _in_unit(fact)
    return f"{fact['name']}{unit} starts at {fact['start']}, changed by `when` alone{_about(fact)}"


def quantity(value: float, unit: str) -> str:
    """A value with its unit; angles in degrees."""
    if unit in ("rad", "rad/s"):
        return f"{math.degrees(value):.9g} {unit.replace('rad', 'deg')}"
    return f"{value:.9g} {unit}".rstrip()


def _speed_lines(facts: Facts) -> list[str]:
    """Return the speeds, unless they are the rates of the coordinates."""
    speeds = facts["speeds"]
    rates = {derived(c["name"]) for c in facts["coordinates"]}
    if all(s["name"] in rates for s in speeds):
        return []
    return [f"{s['name']}{_in_unit(s)}" for s in speeds]


def _joint_line(fact: Facts) -> str:
    brings = f"brings {', '.join(fact['coordinates'])}" if fact["coordinates"] else "no coordinates"
    count = fact["equations"]
    what = f"{count} {'equation' if count == 1 else 'equations'}" if count else brings
    torsor = f"; {{{fact['torsor']}}}" if fact["torsor"] else ""
    return f"{fact['name']}: {fact['kind']} of {' and '.join(fact['between'])}, {what}{torsor}"


def _constraint_line(fact: Facts) -> str:
    words = [fact["kind"], fact["time"]]
    if fact["kind"] != "holonomic":
        words.append("affine in the speeds" if fact["affine"] else "not affine in the speeds")
    if fact["integrable"]:
        words.append("integrable")
    seems = "" if fact["proved"] else ", it seems"
    return f"{fact['row']} (line {fact['line']}): {', '.join(words)}; {fact['reason']}{seems}"


def _action_line(fact: Facts) -> str:
    forces = [f"Q of {name} = {text}" for name, text in fact.get("generalized_forces", {}).items()]
    kind = f"{fact['kind']}{', conservative' if fact['conservative'] else ''}"
    return f"{fact['name']}: {'; '.join([kind, *forces])}"


def _conserved_line(fact: Facts) -> str:
    if fact["proved"]:
        return f"{fact['name']} = {fact['expression']}, since {fact['reason']}"
    return f"{fact['name']} = {fact['expression']}, it seems: {fact['reason']} on the states tried"


def _cyclic_lines(facts: Facts) -> list[str]:
    seeming = facts["seems"]["cyclic"]
    return [f"{name}, it seems" if name in seeming else name for name in facts["cyclic"]]


def _count_text(facts: Facts) -> list[str]:
    count = facts["count"]
    n, p = count["speeds"], count["rows"]
    lines = [f"n + p = {n} + {p}: as many unknowns (accelerations, multipliers) as equations"]
    seems = facts["seems"]
    # Configurations and velocities have the same freedom unless constraints on velocities are not
    # integrable.
    freedom = str(facts["degrees_of_freedom"])
    if facts["positional_freedom"] != facts["degrees_of_freedom"]:
        freedom += f" of the velocities, {facts['positional_freedom']} of the positions"
    if seems["degrees_of_freedom"] or seems["positional_freedom"]:
        freedom += ", it seems from states on the constraints"
    lines.append(f"degrees of freedom: {freedom}")
    if facts["dropped"]:
        lines.append(f"dropped, as nothing depends on them: {', '.join(facts['dropped'])}")
    if facts["more_at_start"]:
        lines.append(f"at the initial configuration: {facts['more_at_start']} more")
    if facts["redundant"]:
        how = "redundant rows, it seems" if seems["redundant"] else "redundant rows"
        lines.append(f"{how}: {', '.join(facts['redundant'])}")
        lines.append(f"reactions that the equations leave open: {', '.join(facts['open_reactions'])}")
    if facts["unseen"]:
        rows = ", ".join(facts["unseen"])
        lines.append(f"rows that double precision cannot distinguish from others: {rows}")
    return _section("count", lines)


def _energies_text(facts: Facts) -> list[str]:
    kinetic = facts["kinetic"]
    lines = []
    if kinetic is None:
        lines.append("kinetic energy: not a polynomial of degree 2 in the speeds")
    else:
        lines += [
            f"{name} = {kinetic[name]}" for name in ("K2", "K1", "K0") if name == "K2" or kinetic[name] != "0"
        ]
    if facts["potential"] != "0":
        lines.append(f"V = {facts['potential']}")
    lines += [f"  {line}" for line in facts.get("energy_parts", [])]
    return _section("energy", lines)


def _relation_line(fact: Facts) -> str:
    return f"{fact['condition']}: {'at times that are known' if fact['known'] else 'found along the motion'}"


def _when(when: WhenEquations, written: Expressions) -> Facts:
    clause = when.clause
    return {
        "condition": clause.words,
        "line": clause.span.line,
        "effect": clause.effect,
        "reinit": [{"state": x.record.name, "value": written.text(value)} for x, value in when.changes],
        "terminate": clause.reason,
        "marks": list(clause.marks),
    }


def _when_line(fact: Facts) -> str:
    done = [f"{x['state']} becomes {x['value']}" for x in fact["reinit"]]
    done += [f"the run ends: {fact['terminate']}"] if fact["terminate"] is not None else []
    done += [f"marked {mark}" for mark in fact["marks"]]
    return f"{fact['condition']} (line {fact['line']}): {', '.join(done) or 'an event'}"


def _operations_text(facts: Facts, verbose: bool) -> list[str]:
    operations = facts["operations"]
    how = {"straight": "with its linear solve", "looped": "before its linear solve"}[operations["solve"]]
    touch = ", where all contacts touch" if facts["contacts"] else ""
    lines = [f"one right-hand side: {operations['right_hand_side']}, {how}{touch}"]
    if operations["watching"]:
        lines.append(f"{operations['watching']} more where a pivot is small, for the residual of the solve")
    if operations["lifted"]:
        unknowns = f"{operations['lifted']} intermediate velocities are unknowns of the solve"
        lines.append(f"{unknowns}: fewer operations than with the mass matrix")
    if operations["preparation"]:
        lines.append(f"once, of the parameters alone: {operations['preparation']}")
    if verbose:
        lines += [f"{name}: {cost}" for name, cost in operations["functions"].items()]
    return _section("operations", lines)


def _short_names_text(facts: Facts) -> list[str]:
    names = facts["short_names"]
    return ["where " + ", ".join(f"{short} = {full}" for short, full in names.items())] if names else []
