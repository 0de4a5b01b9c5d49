"""The summary of a run in about a dozen lines: the end, the accuracy and the cost."""

from math import floor, isfinite, log10, pi

from lagc.base.text import WIDTH, broken, entry
from lagc.simulation.solution import Solution

MOST = 12  # final values that are shown without --verbose
MOST_EVENTS = 4  # events that are shown without --verbose
REPORTED = 0.1  # of the run time, and in s: a longer initialization is reported


def summary(run: Solution, scene_chosen: bool, quiet: bool = False, verbose: bool = False) -> str:
    """Return the lines for a run; `quiet` gives only the final values, `scene_chosen` tells that the scene is
    the default."""
    if quiet:
        return "\n".join(_final(run, verbose))
    interface = run.system.interface
    effects = f" with {', '.join(interface.effects)}" if interface.effects else ""
    chosen = " (the first of the file)" if scene_chosen and interface.scene != "default" else ""
    reason = f" ({run.backend_reason})" if run.backend_reason else ""
    entries = [("warning", warning) for warning in run.warnings]
    if interface.dropped:
        them = "them" if len(interface.dropped) > 1 else "it"
        entries.append(("dropped", f"{', '.join(interface.dropped)}: nothing asked for depends on {them}"))
    entries += [("note", note) for note in (*(interface.notes if verbose else ()), *run.notes)]
    entries.append(("failed" if run.status == "failed" else "ended", run.message))
    final = _final(run, verbose)
    if run.status == "failed" and run.times and run.times[-1] < run.end:
        final.insert(0, f"last recorded state, at t = {run.times[-1]:.9g} s")
    entries += [("final" if k == 0 else "", line) for k, line in enumerate(final)]
    entries += [("events" if k == 0 else "", line) for k, line in enumerate(_events(run, verbose))]
    entries.append(("accuracy", _accuracy(run)))
    if run.asked is not None and run.cost.alone:
        entries.append(("price", _price(run)))
    if run.sensitivities is not None:
        entries.append(("sensitive", str(run.sensitivities)))
    if interface.nc or interface.quaternions:
        drift = f"position {run.position_drift:.1e}, velocity {run.velocity_drift:.1e} (scaled)"
        entries.append(("drift", drift))
    entries.append(("energy", _energy(run)))
    entries.append(("method", f"{_method(run)}, backend {run.system.backend}{reason}"))
    entries.append(("cost", _cost(run)))
    title = broken(f"{interface.model}, scene {interface.scene}{chosen}{effects}", WIDTH)
    return "\n".join([*title, *[line for key, text in entries for line in entry(key, text)]])


def _final(run: Solution, verbose: bool) -> list[str]:
    final = run.final
    units = run.units
    names = list(final) if verbose else _shown(run, list(final))
    width = max((len(n) for n in names), default=0)
    errors = run.errors
    lines = [f"{n:{width}} = {value_text(final[n], units[n], errors.get(n))}" for n in names]
    if len(names) < len(final):
        lines.append(f"and {len(final) - len(names)} more: --json or -v shows them")
    return lines


def _shown(run: Solution, names: list[str]) -> list[str]:
    """Return the first of `names`, outputs before states."""
    asked = {output.name for output in run.system.interface.outputs}
    chosen = set(sorted(names, key=lambda name: name not in asked)[:MOST])
    return [name for name in names if name in chosen]


def _events(run: Solution, verbose: bool) -> list[str]:
    shown = run.events if verbose else run.events[:MOST_EVENTS]
    lines = [f"t = {event.t:.9g} s: {event.name}" for event in shown]
    if len(shown) < len(run.events):
        lines.append(f"and {len(run.events) - len(shown)} more: --json or -v shows them")
    return lines


def value_text(value: float, unit: str, error: float | None = None) -> str:
    """Return a value with its unit and error, also in degrees for an angle: nine digits, or all up to the
    first one of the error."""
    value += 0.0  # avoids negative zero
    digits = 9
    if error and value and isfinite(error) and isfinite(value):
        digits = min(17, max(9, floor(log10(abs(value))) - floor(log10(error)) + 1))
    text = f"{value:.{digits}g}" + (f" +- {error:.0e}" if error else "") + (f" {unit}" if unit else "")
    if unit in ("rad", "rad/s"):
        text += f"  ({value * 180.0 / pi:.6g} {unit.replace('rad', 'deg')})"
    return text


def _accuracy(run: Solution) -> str:
    if run.asked is None:
        return "not verified: method or tolerances were given"
    if run.estimated is None or run.estimated == float("inf"):
        return f"asked {run.asked:.0e}, not verified"
    return f"asked {run.asked:.1e}, estimated {run.estimated:.1e} (global, relative)"


def _price(run: Solution) -> str:
    """Return the price of the verification, and of a digit by the order p of the method: 10^(1/p) in
    steps."""
    from lagc.kernels.integrators.tableaus import order

    factor = 10.0 ** (1.0 / order(run.method))
    if run.cost.integrations == 1:
        return f"{run.cost.rhs} right-hand sides: nothing moves"
    times = run.cost.rhs / run.cost.alone
    more, less = 100.0 * (factor - 1.0), 100.0 * (1.0 / factor - 1.0)
    return f"{times:.2g} times the run alone; one digit more {more:+.0f} %, one less {less:+.0f} %"


def _energy(run: Solution) -> str:
    e = run.energy
    work = f", work {e.work:.5g} J" if run.system.nz else ""
    balance = run.system.interface.balance
    return f"{balance}: {e.start:.5g} to {e.end:.5g} J{work}, imbalance {e.imbalance:.1e} J"


def _method(run: Solution) -> str:
    if run.step:
        return f"{run.method}, fixed step {run.step:g} s"
    return f"{run.method}, tolerance {run.rtol:.2g}" + (
        "" if run.atol == 0.0 else f", absolute {run.atol:.2g}"
    )


def _cost(run: Solution) -> str:
    c = run.cost
    several = f" in {c.integrations} integrations" if c.integrations > 1 else ""
    search = c.start_s >= max(REPORTED * c.run_s, REPORTED)
    start = f", {seconds(c.start_s)} of it for the initialization" if search else ""
    return (f"{c.steps} steps, {c.rejected} rejected; {c.rhs} right-hand sides of {c.operations} operations"
            f"{several}; compile {seconds(c.compile_s)}, run {seconds(c.run_s)}{start}")  # fmt: skip


def seconds(s: float) -> str:
    return f"{s:.3g} s" if s >= 1.0 else f"{1e3 * s:.3g} ms"
