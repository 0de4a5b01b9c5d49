"""Model files: how a name given by a person becomes a text."""

from __future__ import annotations

import os
import sys

from lagc.diagnostics.faults import Fault, Refused, Source

SUFFIX = ".lag"
LARGEST = 4_000_000  # bytes of one model file


def models_folder() -> str:
    """The folder of the models that come with lagc: beside the package in a checkout, inside it
    where lagc was installed from a wheel."""
    package = os.path.dirname(os.path.abspath(__file__))
    inside = os.path.join(package, "models")
    return inside if os.path.isdir(inside) else os.path.join(os.path.dirname(package), "models")


def library_models() -> list[str]:
    """`course/simple_pendulum` and so on, sorted."""
    root = models_folder()
    found = []
    for folder, _, files in os.walk(root):
        for file in files:
            if file.endswith(SUFFIX):
                path = os.path.relpath(os.path.join(folder, file), root)
                found.append(path.removesuffix(SUFFIX).replace(os.sep, "/"))
    return sorted(found)


def locate(name: str) -> str:
    """The path of the model called `name`: a path, or a model of the library (`simple_pendulum`,
    `course/simple_pendulum`).  Raises Refused where there is none."""
    if os.path.exists(name):
        return name
    wanted = name.removesuffix(SUFFIX)
    root = models_folder()
    direct = os.path.join(root, *wanted.split("/")) + SUFFIX
    if ".." not in wanted.split("/") and os.path.isfile(direct):
        return direct
    models = library_models()
    matches = [m for m in models if m.rpartition("/")[2] == wanted]
    if len(matches) == 1:
        return os.path.join(root, *matches[0].split("/")) + SUFFIX
    raise Refused([_not_found(name, wanted, matches, models)])


def _not_found(name: str, wanted: str, matches: list[str], models: list[str]) -> Fault:
    if matches:
        message = f"`{name}` is the name of several models"
        return Fault("LAG0701", message, remedy="say " + " or ".join(matches))
    from lagc.diagnostics.suggest import closest

    short = [m.rpartition("/")[2] for m in models]
    close = closest(wanted, short + models)
    message = f"there is no file `{name}`, and no model of that name in the library"
    return Fault("LAG0701", message, remedy=f"did you mean the library model `{close}`?" if close else None)


def read(name: str) -> Source:
    """The text of the file or library model `name`; `-` reads standard input.  Raises Refused
    where it cannot be read as UTF-8 text."""
    if name == "-":
        return Source("<stdin>", _decode("standard input", sys.stdin.buffer.read(LARGEST + 1)))
    path = locate(name)
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST + 1)
    except OSError as error:
        reason = error.strerror or str(error)
        raise Refused([Fault("LAG0702", f"`{name}` cannot be read: {reason}")]) from None
    return Source(path, _decode(name, data))


def _decode(name: str, data: bytes) -> str:
    if len(data) > LARGEST:
        message = f"`{name}` is larger than {LARGEST // 1_000_000} MB, the largest model file that is read"
        raise Refused([Fault("LAG0704", message)])
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        message = f"`{name}` is not UTF-8 text: byte {error.start} is 0x{data[error.start]:02x}"
        raise Refused([Fault("LAG0703", message, remedy="save the file as UTF-8")]) from None
    return text
