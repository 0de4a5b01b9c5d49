"""`lagc sim --prune`: leave out the effects that the accuracy asked lets go, as `lagc effects` finds them.

The set is remembered for the model, its values, the initial values, the end time and the accuracy.
"""

from __future__ import annotations

import marshal
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from lagc.base.records import replace
from lagc.cli.output import Usage
from lagc.host import cache
from lagc.host.cache import tool_fingerprint

if TYPE_CHECKING:
    from lagc.api import CompiledModel
    from lagc.simulation.request import Request

SHARE = 0.5  # of the accuracy, for the error of the run; the rest is for what is left out


def prune(
    model: CompiledModel, request: Request, starts: Mapping[str, Any], guesses: Mapping[str, Any], quiet: bool
) -> tuple[CompiledModel, Request, str, dict[str, object]]:
    """Return the model without these effects, the request for it, a note, and the object `pruned` of the
    JSON. Raises Usage if a method or tolerances were chosen by hand, Refused as `CompiledModel.effects`."""
    if request.by_hand:
        raise Usage("`--prune` needs an accuracy, and no method, tolerance or step of your own")
    complete = request.completed(model.interface.simulate)
    accuracy, stop = complete.accuracy or 1e-6, complete.stop or 0.0
    said: dict[str, object] = {"left_out": [], "error": 0.0, "bar": 0.0, "asked": accuracy}
    if not model.interface.effects:
        return model, request, "nothing is left out: the scene uses no effect", said
    left_out, change, bar, took = _set(model, accuracy, stop, starts, guesses, quiet)
    if not left_out:
        words = f"nothing is left out at {accuracy:.0e}: each effect counts, or saves nothing"
        return model, request, words, said
    compared = model.operations
    model = model.without(left_out)
    words = f"left out {', '.join(left_out)}: the compared quantities change by {change:.1e} of their ranges "
    words += f"(asked {accuracy:.0e}; measured, for this initial state and end time{took}); "
    words += f"{model.operations} of {compared} operations"
    said.update(left_out=list(left_out), error=change, bar=bar)
    return model, replace(request, accuracy=SHARE * accuracy), words, said


def _set(
    model: CompiledModel,
    accuracy: float,
    stop: float,
    starts: Mapping[str, Any],
    guesses: Mapping[str, Any],
    quiet: bool,
) -> tuple[tuple[str, ...], float, float, str]:
    """The effects to leave out, the change, its error bar, and how long it took to find them; "" if they were
    known."""
    from lagc.cli.output import Bar

    begin = [sorted(starts.items()), sorted(guesses.items())]
    values = [repr(v) for v in (accuracy, stop, begin, list(model.system.parameters))]
    name = cache.key(
        "effects 2", tool_fingerprint(), model.interface.model_hash, model.interface.scene, *values
    )
    known = cache.load("effects", name, marshal.loads)
    if known is not None:
        return tuple(known[0]), known[1], known[2], ""
    with Bar(1.0, quiet=quiet) as bar:
        found = model.effects(stop, accuracies=(accuracy,), starts=starts, guesses=guesses,
                              progress=lambda part, doing: bar.part(part, doing))  # fmt: skip
    if not found.complete:
        raise KeyboardInterrupt
    (choice,) = found.sets
    cache.store("effects", name, marshal.dumps((list(choice.left_out), choice.change, choice.bar)))
    return choice.left_out, choice.change, choice.bar, f"; found in {found.spent:.0f} s"
