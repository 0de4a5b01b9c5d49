"""The changes and costs of the effects of a scene, as a table, as plain data and as one page."""

from collections.abc import Sequence
from typing import Any

from lagc.base.text import WIDTH, broken, entry, printable, table
from lagc.reports.stand_alone import stand_alone
from lagc.study.effects import AS_LONG, Change, Choice, Effects, Elsewhere, joined


def text(found: Effects, heading: str) -> str:
    """Return the report for a terminal."""
    # The head says what is compared, the tables what each effect does, the advice what to leave out.
    count = len(found.effects)
    compared = ", ".join(f"{name} ({_scale(found, name)})" for name in found.scales)
    counted = f"{count} {'effect' if count == 1 else 'effects'}, {found.operations} operations"
    lines = broken(f"{heading}, 0 to {found.stop:g} s: {counted}", WIDTH)
    lines += entry("compared", compared, 16)
    if found.energy is not None:
        energy = found.energy
        values = energy.start, energy.end, energy.end - energy.start, energy.rest
        start, end, change, rest = (_energy(x, energy.bar) for x in values)
        others = f", of it contacts and given motions of bodies {rest}" if energy.rest else ""
        lines += entry("energy", f"{start} to {end}: {change} by what stores no energy{others}", 16)
    if found.horizon is not None:
        lines += entry("until", f"{found.horizon:.4g} s: a run is not predictable beyond", 16)
    if found.not_compared:
        lines += entry("not compared", f"{', '.join(found.not_compared)}: not every scene has it", 16)
    if found.left_out:
        lines += ["", "Each effect left out alone", *_singles(found.left_out, found, "without")]
    if found.added:
        lines += ["", "Effects that the scene leaves out, added alone", *_singles(found.added, found, "with")]
    lines += [*([""] if found.sets else []), *_advice(found)]
    lines += [line for note in found.notes for line in entry("note", note, 8)]
    if found.not_tried:
        lines += entry("note", f"sets with {', '.join(found.not_tried)} were not tried", 8)
    return "\n".join(map(printable, lines)) + "\n"


def _advice(found: Effects) -> list[str]:
    """Return the cheapest scenes, and one to paste."""
    if not found.sets:
        return []
    lines = ["The cheapest scene for an accuracy, each run and compared with the full scene"]
    lines += _sets(found)
    lines += [f"  (for this initial state and {found.horizon or found.stop:.4g} s only)", *_also(found.also)]
    paste = next((one for one in found.sets if one.left_out), None)
    return lines if paste is None else [*lines, "", f"In the file: {scene_of(found, paste)}"]


def scene_of(found: Effects, one: Choice) -> str:
    """Return the scene to paste."""
    kept = [name for name in found.effects if name not in one.left_out]
    name = f"for_{one.accuracy:.0e}".replace("-", "m").replace("+", "")
    uses = f" uses {', '.join(kept)};" if kept else ";"
    return f"scene {name}{uses}"


def _scale(found: Effects, name: str) -> str:
    size, of = found.scales[name]
    unit = found.units.get(name, "")
    words = {"range": "range", "size": "constant, size", "unit": "constant, size of its unit"}[of]
    return f"{words} {size:.3g}{' ' + unit if unit else ''}"


def _time(ratio: float) -> str:
    return "same" if abs(ratio - 1.0) <= AS_LONG else f"{ratio:.2f}"


def _energy(joules: float, bar: float) -> str:
    return "0 J" if abs(joules) <= bar else f"{joules:.3g} J"


def _name(one: Change) -> str:
    return one.effect + (f" (and {', '.join(one.along)})" if one.along else "")


def _change(one: Change) -> tuple[str, str]:
    """The size of the change, and what changes most."""
    if one.change is None:
        return "ends", one.ends
    if not one.acted:
        near = "".join(f"; `{name}`: nearest {value:.3g}" for name, value in one.nearest)
        return f"< {one.bar:.0e}", f"did not act at the recorded times{near}"
    worst = max(one.per, key=one.per.__getitem__, default="")
    mark = "*" if " times " in one.how else ""
    size = f"< {one.bar:.0e}" if one.how.startswith("below") else f"{one.change:.1e}{mark}"
    return size, f"of {worst}" if worst else ""


def _singles(changes: Sequence[Change], found: Effects, word: str) -> list[str]:
    rows, bar = [], 0.0 if found.energy is None else found.energy.bar
    for one in sorted(changes, key=lambda one: -(one.change if one.change is not None else 1e300)):
        size, of = _change(one)
        time = "" if one.time == float("inf") else _time(one.time)
        first = min(one.until.items(), key=lambda item: -item[0], default=None)
        notes = [] if first is None else [f"{first[0]:.0e} from {first[1]:.3g} s"]
        if word == "without" and 1.0 + AS_LONG < one.time < float("inf"):
            notes.insert(0, "dearer without it")
        if one.events:
            notes.append(f"its events vanish: {', '.join(one.events)}")
        note = "; ".join(notes)
        work = "" if one.work is None else _energy(one.work, bar)
        rows.append([_name(one), size, of, time, str(one.operations), work, note])
    lines = table([word, "changes", "", "time", "ops", "works", "above"], rows)
    stronger = [f"{one.effect} with {one.how}" for one in changes if " times " in one.how]
    if stronger:
        lines += entry("", f"* below the error bar of two runs; measured stronger: {', '.join(stronger)}", 2)
    return lines


def _cheapest(found: Effects) -> list[list[str]]:
    """Return the cheapest scenes as the rows of a table, the first its head."""
    rows = [["accuracy", "changes", "time", "ops", "leave out"]] if found.sets else []
    for group in joined(found.sets):
        one, last = group[0], group[-1]
        accuracy = f"{one.accuracy:.0e}" if one is last else f"{one.accuracy:.0e} to {last.accuracy:.0e}"
        if not one.left_out:
            rows.append([accuracy, "", "", "", "nothing" if one.found else "none found"])
            continue
        size = f"{last.change:.1e}" + (f" +- {last.bar:.0e}" if last.bar > 0.1 * last.change else "")
        out = ", ".join(one.left_out)
        rows.append([accuracy, size, _time(last.time), str(last.operations), out])
    return rows


def _sets(found: Effects) -> list[str]:
    head, *rows = _cheapest(found)
    lines = table(head, rows)
    lucky = next((one for one in found.sets if one.cancelling), None)
    if lucky is not None:
        names = ", ".join(lucky.cancelling)
        words = f"(at {lucky.accuracy:.0e}, without {names} would do too, as changes cancel: not used)"
        lines += entry("", words, 2)
    return lines


def _also(also: Sequence[Elsewhere]) -> list[str]:
    """The recommended scenes for other initial states."""
    if not also:
        return []
    rows = []
    for one in also:
        size = one.ends
        if one.change is not None:
            size = f"{one.change:.1e}" + (f" +- {one.bar:.0e}" if one.bar > 0.1 * one.change else "")
        holds = "holds" if one.holds else "does not hold"
        rows.append([one.start, f"{one.accuracy:.0e}", ", ".join(one.left_out), size, holds])
    head = ["for", "accuracy", "without", "changes", ""]
    return ["", "The same scenes for other initial states", *table(head, rows)]


def to_dict(found: Effects) -> dict[str, Any]:
    """Return the study as the object that `lagc effects --json` prints."""

    # JSON has no infinity: a time that was not measured is null.
    def change(one: Change) -> dict[str, Any]:
        return {
            "effect": one.effect, "with": list(one.along), "change": one.change, "bar": one.bar,
            "how": one.how, "per": dict(one.per), "ends": one.ends, "acted": one.acted,
            "events": list(one.events),
            "nearest": dict(one.nearest), "until": {f"{a:.0e}": t for a, t in one.until.items()},
            "operations": one.operations, "states": one.states, "rhs": one.rhs, "work": one.work,
            "time": None if one.time == float("inf") else one.time,
        }  # fmt: skip

    energy = found.energy
    return {
        "scene": found.scene, "stop": found.stop,
        "compared": {
            name: {"scale": size, "of": of, "unit": found.units.get(name, "")}
            for name, (size, of) in found.scales.items()
        },
        "not_compared": list(found.not_compared), "horizon": found.horizon,
        "full": {"operations": found.operations, "states": found.states, "rhs": found.rhs,
                 "time_s": found.seconds, "bar": found.bar},
        "energy": None if energy is None else {
            "start": energy.start, "end": energy.end, "rest": energy.rest, "bar": energy.bar
        },
        "effects": [change(one) for one in found.left_out],
        "offered": [change(one) for one in found.added],
        "sets": [
            {"accuracy": s.accuracy, "left_out": list(s.left_out), "scene": scene_of(found, s),
             "predicted": s.predicted, "change": s.change, "bar": s.bar, "time": s.time,
             "predicted_time": s.predicted_time, "operations": s.operations, "states": s.states,
             "tries": s.tries, "found": s.found, "cancelling": list(s.cancelling)}
            for s in found.sets
        ],
        "also": [
            {"start": s.start, "accuracy": s.accuracy, "left_out": list(s.left_out), "change": s.change,
             "bar": s.bar, "ends": s.ends, "holds": s.holds}
            for s in found.also
        ],
        "not_tried": list(found.not_tried), "notes": list(found.notes), "spent_s": found.spent,
        "complete": found.complete,
    }  # fmt: skip


def headline(found: Effects) -> str:
    """Return the largest saving in one sentence."""
    best = min((one for one in found.sets if one.left_out), key=lambda one: one.time, default=None)
    if best is None:
        return "every effect counts"
    size = f"{1.0 / best.time:.2g} times shorter a run" if best.time < 1.0 - AS_LONG else "as long a run"
    return f"to {best.accuracy:.0e} without {', '.join(best.left_out)}: {size}"


def page(found: Effects, heading: str, picture: str) -> str:
    """Return one stand-alone HTML page; `picture` is an element `<svg>`."""
    advice = [[accuracy, out, *sizes] for accuracy, *sizes, out in _cheapest(found)]
    return stand_alone(heading, headline(found), advice, picture, text(found, heading))
