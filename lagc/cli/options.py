"""Options with the same meaning in every command."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Container, Iterable
from math import inf
from typing import TYPE_CHECKING, Any

from lagc.base.text import number, seconds, size, whole
from lagc.cli.output import Usage

if TYPE_CHECKING:
    from lagc.base.text import Quantity
    from lagc.compiler.stages import Choice
    from lagc.host.budgets import Limits

_SPACES = " \t\n\r\f\v"


def add_list_option(
    parser: argparse.ArgumentParser, name: str, dest: str, form: str, about: str, *short: str
) -> None:
    """An option that may be given several times; `dest` is the list of its words."""
    parser.add_argument(*short, name, metavar=form, dest=dest, action="append", default=[], help=about)


def add_general_options(parser: argparse.ArgumentParser, json: bool = True) -> None:
    """`--json -q -v --no-color`."""
    if json:
        parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("-q", "--quiet", action="store_true", help="print only the result")
    parser.add_argument("-v", "--verbose", action="store_true", help="print more")
    parser.add_argument("--no-color", action="store_true", help="print without colours (also: set NO_COLOR)")


def add_limit_options(parser: argparse.ArgumentParser) -> None:
    """`--max-time --max-memory`."""
    parser.add_argument("--max-time", metavar="T", help="stop after this time: 90, 10min, 2h; none: no limit")
    parser.add_argument(
        "--max-memory", metavar="SIZE", help="the memory that may be used: 500M, 8G; none: no limit"
    )


def limits_of(options: argparse.Namespace) -> Limits:
    """Return the limits of a command; by default those of each stage and of this machine."""
    from lagc.host.budgets import Limits, of_this_machine

    time = _limit(getattr(options, "max_time", None), "--max-time", seconds, "90, 10min or 2h")
    memory = _limit(getattr(options, "max_memory", None), "--max-memory", size, "500M or 8G")
    return Limits(time, of_this_machine() if memory is None else memory, careful=time is None)


def _limit(word: str | None, option: str, read: Callable[[str], float | None], like: str) -> float | None:
    if word is None:
        return None
    found = inf if word == "none" else read(word)
    if not found:
        raise Usage(f"`{option} {word}` is not of the form {like}, and not `none`")
    return found


def add_model_options(parser: argparse.ArgumentParser, many_scenes: bool = False) -> None:
    """FILE and the options that choose a scene and values: `--scene --with --without --model -p --input`;
    limits."""
    add_limit_options(parser)
    parser.add_argument(
        "file", metavar="FILE", help="a model file, the name of a library model, or - for standard input"
    )
    if many_scenes:
        parser.add_argument(
            "--scene", metavar="S", action="append", help="a scene, once for each; default: all of the file"
        )
    else:
        parser.add_argument("--scene", metavar="S", help="the scene; default: the first of the file")
    add_list_option(parser, "--with", "with_effects", "E", "add the effect E")
    add_list_option(parser, "--without", "without_effects", "E", "leave out the effect E")
    parser.add_argument("--model", metavar="M", help="the model, if a file has several")
    add_parameter_option(parser)
    about = "an input: a number, an expression ('u=sin(time)') or a column of a file (u=drive.csv:u)"
    add_list_option(parser, "--input", "inputs", "NAME=VALUE", about)


def add_outputs_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--outputs",
        metavar="NAMES",
        help="outputs and coordinates to compute; what none of them depends on is left out; default: all",
    )


def add_parameter_option(parser: argparse.ArgumentParser) -> None:
    about = "the value of a parameter, e.g. -p l=0.7 or -p 'l=70[cm]'"
    add_list_option(parser, "--parameter", "parameters", "NAME=VALUE[UNIT]", about, "-p")


def add_start_option(parser: argparse.ArgumentParser) -> None:
    about = "the initial value of a coordinate or speed, e.g. --start 'theta=30[deg]'"
    add_list_option(parser, "--start", "starts", "NAME=VALUE[UNIT]", about)


def choice_of(options: argparse.Namespace) -> Choice:
    """Return the choice that the options of `add_model_options` make."""
    from lagc.compiler.stages import Choice
    from lagc.simulation.request import expression

    parameters = quantities(options.parameters, "-p")
    inputs = {}
    for word in options.inputs:
        name, equals, said = word.partition("=")
        name = name.strip(_SPACES)
        if not (name and equals and said.strip(_SPACES)):
            raise Usage(f"`--input {word}` is not of the form name=value")
        if name in parameters or name in inputs:
            raise Usage(f"`{name}` is given twice")
        if _value_of(said) is None:
            inputs[name] = expression(said)
        else:
            parameters.update(quantities([word], "--input"))
    return Choice(
        model=options.model,
        scene=options.scene,
        with_effects=tuple(options.with_effects),
        without_effects=tuple(options.without_effects),
        parameters=parameters,
        inputs=inputs,
        outputs=_names(getattr(options, "outputs", None)),
    )


def _names(word: str | None) -> tuple[str, ...] | None:
    """Return the names of `--outputs`.  Raises Usage if there is none."""
    if word is None:
        return None
    names = tuple([name.strip(_SPACES) for name in split(word) if name.strip(_SPACES)])
    if not names:
        raise Usage("`--outputs` needs names, such as --outputs theta,E")
    return names


def add_plot_option(parser: argparse.ArgumentParser, about: str) -> None:
    """`--plot [FILE]`: None without it, "" without a file."""
    parser.add_argument("--plot", metavar="FILE", nargs="?", const="", help=about)


def add_run_options(parser: argparse.ArgumentParser, *names: str) -> None:
    from lagc.base.run_options import RUN_OPTIONS  # for commands that run

    for option in map(RUN_OPTIONS.__getitem__, names):
        parser.add_argument(option.of_command, metavar=option.form, help=option.about)


def run_numbers(options: argparse.Namespace) -> dict[str, Any]:
    """Return the numbers that control a run, by name; None if not given.  Raises Usage if a word is none."""
    from lagc.base.run_options import RUN_OPTIONS

    found: dict[str, Any] = {}
    for name, option in RUN_OPTIONS.items():
        word = getattr(options, name, None)
        if option.whole and word is not None:
            found[name] = whole(word)
            if found[name] is None:
                raise Usage(f"`{option.of_command} {word}` is not a whole number")
        else:
            found[name] = quantity(word, option.unit, option.of_command)
    return found


def add_backend_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--backend",
        choices=("auto", "c", "numpy"),
        default="auto",
        help="auto: C for long runs if a compiler is found, NumPy otherwise",
    )


def assignments(words: list[str], option: str) -> dict[str, tuple[float, str | None]]:
    """Parse words `name=value[unit]` into {name: (value, unit)}; the unit is None if it is not given.

    Raises Usage if a word has another form, or a name occurs twice.
    """
    by_name: dict[str, tuple[float, str | None]] = {}
    for word in words:
        name, _, quantity = word.partition("=")
        name = name.strip(_SPACES)
        value = _value_of(quantity)
        if not name or value is None or any(space in name for space in _SPACES):
            like = f"{name if name and not quantity else 'x'}=0.1[m]"
            raise Usage(
                f"`{option} {word}` is not of the form name=value or name=value[unit], as `{option} '{like}'`"
            )
        if name in by_name:
            raise Usage(f"`{option} {name}` is given twice")
        by_name[name] = value
    return by_name


def _value_of(word: str) -> tuple[float, str | None] | None:
    """Parse `value` or `value[unit]`; None if the word has another form."""
    digits, bracket, rest = word.strip(_SPACES).partition("[")
    value = number(digits.rstrip(_SPACES))
    unit = rest[:-1] if bracket else None
    if value is None or (unit is not None and (rest[-1:] != "]" or "[" in unit or "]" in unit)):
        return None
    return value, None if unit is None else unit.strip(_SPACES)


def quantities(words: list[str], option: str) -> dict[str, float | Quantity]:
    """Parse words `name=value[unit]` into quantities."""
    from lagc.base.text import Quantity

    return {name: Quantity(value, unit) for name, (value, unit) in assignments(words, option).items()}


def quantity(word: str | None, unit: str, option: str) -> float | None:
    """Parse a number with an optional unit, such as `20`, `20[s]` or `20 [ms]`, and return it in SI units;
    None for None."""
    if word is None:
        return None
    found = _value_of(word)
    if found is None:
        raise Usage(f"`{option} {word}` is not a number" + (", or a number with a [unit]" if unit else ""))
    value, given = found
    if given is None:
        return value
    from lagc.semantics.units import UnknownUnit, to_si

    try:
        return to_si(value, given, unit)
    except UnknownUnit as error:
        raise Usage(f"`{option} {word}`: {error.reason}") from None


def pairs(words: Iterable[str], form: str, others: Container[str] = ()) -> dict[str, str]:
    """Return the texts of `name=text` by their names, which are not among `others`.  Raises Usage, which
    tells the `form`."""
    found: dict[str, str] = {}
    for word in words:
        name, _, text = (part.strip() for part in word.partition("="))
        if not (name and text):
            raise Usage(f"`{word}` is not of the form {form}")
        if name in found or name in others:
            raise Usage(f"`{name}` is given twice")
        found[name] = text
    return found


def split(names: str) -> list[str]:
    """Split at commas outside of an index: `l, a[1,2]`."""
    found, depth = [""], 0
    for letter in names:
        depth += (letter == "[") - (letter == "]")
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    return found
