"""Models in notebooks: `%load_ext lagc` brings cells with the text of a model, and marks lines with faults.

    %%lag pendulum --scene room -p l=0.7 --stop 20
    model Pendulum ... end Pendulum;

The name is bound to the compiled model, and its equations are shown; with `--stop`, `pendulum_run` to a run.
"""

from argparse import ArgumentTypeError
from collections.abc import Iterable
from html import escape
from keyword import iskeyword
from typing import Any

from IPython.core.error import UsageError
from IPython.core.magic import needs_local_scope
from IPython.core.magic_arguments import argument, magic_arguments, parse_argstring
from IPython.display import display

from lagc.api import loads
from lagc.api.columns import name_and_unit
from lagc.api.values import real
from lagc.base.text import Quantity
from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Fault, Refused, Span

_COLORS = {"error": "#d33", "warning": "#d90"}


class Faults:
    """Faults that a notebook shows with their lines."""

    def __init__(self, faults: Iterable[Fault]):
        self.faults = tuple(faults)

    def __repr__(self) -> str:
        return str(Refused(self.faults))

    def _repr_html_(self) -> str:
        return "".join(map(_fault_html, self.faults))


def _fault_html(fault: Fault) -> str:
    color = _COLORS[fault.severity]
    places = [(fault.span, "")] if fault.span is not None else []
    lines = [_line_html(span, label, color) for span, label in (*places, *fault.related)]
    help = f"<div>help: {escape(fault.remedy)}</div>" if fault.remedy else ""
    title = f"<b>{fault.severity} {fault.code}</b>: {escape(fault.message)}"
    style = f"border-left: 3px solid {color}; padding-left: 8px; margin: 4px 0"
    return f'<div style="{style}">{title}{"".join(lines)}{help}</div>'


def _line_html(span: Span, label: str, color: str) -> str:
    """Return a line of the text with a place underlined, and a label."""
    line, start = span.source.line(span.line), span.column - 1
    end = max(start + 1, min(len(line), start + span.end - span.start))
    before, marked, after = (escape(part) for part in (line[:start], line[start:end] or " ", line[end:]))
    mark = f'<span style="text-decoration: underline wavy {color}">{marked}</span>'
    note = f'  <span style="color: {color}">{escape(label)}</span>' if label else ""
    return f'<pre style="margin: 2px 0">{span.line:4} | {before}{mark}{after}{note}</pre>'


def _assignment(word: str) -> tuple[str, Quantity]:
    """Return the name and the value of `l=0.7` or `l=70[cm]`."""
    name, _, value = word.partition("=")
    number, unit = name_and_unit(value)
    try:
        return name.strip(), Quantity(real(name, number), unit)
    except ValueError:
        raise ArgumentTypeError(f"`{word}` is not of the form name=value or name=value[unit]") from None


@needs_local_scope
@magic_arguments()
@argument("name", nargs="?", default="model", help="the name for the compiled model")
@argument("--scene", help="the scene; default: the first of the text")
@argument("--model", help="the model, if the text has several")
@argument("-p", "--parameter", type=_assignment, action="append", default=[], metavar="NAME=VALUE[UNIT]",
          help="a parameter of the compiled model; may be repeated")  # fmt: skip
@argument("--stop", type=float, help="simulate up to this time in s; the run is NAME_run")
@argument("--accuracy", type=float, help="the global relative error of the run; default: 1e-6")
def lag(line: str, cell: str, local_ns: dict[str, Any]) -> None:
    """Compile a model, and show its equations and its motion."""
    options = parse_argstring(lag, line)
    if not options.name.isidentifier() or iskeyword(options.name):
        raise UsageError(f"`{options.name}` is no name of Python for the model")
    found = loads(cell, f"<{options.name}>")
    given = dict(options.parameter)
    faults = check(found.source, Choice(options.model, options.scene, parameters=given))
    if faults:
        display(Faults(faults))
    if any(fault.severity == "error" for fault in faults):
        return
    model = local_ns[options.name] = found.compile(options.scene, model=options.model, parameters=given)
    display(model)
    if options.stop is not None:
        run = local_ns[f"{options.name}_run"] = model.simulate(options.stop, accuracy=options.accuracy)
        display(run)


def _show_refused(
    shell: Any, kind: type, error: Refused, traceback: Any, tb_offset: int | None = None
) -> None:
    display(Faults(error.faults))


def load(shell: Any) -> None:
    """Give a notebook `%%lag`; it shows `Refused` by its faults."""
    shell.register_magic_function(lag, "cell")
    shell.set_custom_exc((Refused,), _show_refused)
