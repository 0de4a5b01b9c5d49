"""FMUs: a model as a file for tools of co-simulation, with its sources and libraries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from lagc.codegen.fmi.archive import zipped
from lagc.codegen.fmi.description import Unit, build, description
from lagc.codegen.fmi.wrapper import LICENCE, TEXTS, fixed, sources
from lagc.codegen.identifiers import prefix
from lagc.compiler.loaded import Loaded
from lagc.compiler.pipeline import Compilation, Contents, delivered, unused
from lagc.compiler.stages import render
from lagc.host import cache
from lagc.simulation.backends.compile import build_library
from lagc.simulation.backends.cross import Platform, cross_library, this_machine
from lagc.simulation.request import Request, bound_parameters

if TYPE_CHECKING:
    from lagc.lowering.program import Interface, Program

HIDDEN = ("-fvisibility=hidden", "-I.")  # the functions of FMI alone are seen


def fmu(
    compilation: Compilation, version: int, methods: Sequence[str], platforms: Sequence[Platform] | None
) -> tuple[Interface, dict[str, bytes]]:
    """Return the interface of a model, and its FMU by file name: with libraries for `platforms`, made by zig,
    or for this machine if that is None.  Raises Refused, also if the model has no initial state, and
    CannotCompile."""
    has_derivatives = not compilation.model.contacts
    program = delivered(compilation, Contents(methods, has_derivatives, directional=True, events=True))
    interface = program.interface
    name = prefix(interface.model)
    texts = render(program, "c")
    made = described(compilation, program, texts)
    code = {**texts, **sources(made, version)}
    files: dict[str, str | bytes] = {"modelDescription.xml": description(made, version)}
    files |= {f"sources/{file}": text for file, text in code.items()}
    if version == 3:
        files["sources/buildDescription.xml"] = build(interface)
    files["documentation/licenses/license.txt"] = fixed(LICENCE)
    if platforms is None:
        own = this_machine()
        if own is not None:
            files[_place(own, version, name)] = build_library(code, HIDDEN)
    for platform in platforms or ():
        files[_place(platform, version, name)] = cross_library(code, HIDDEN, platform)
    return interface, {f"{name}.fmu": zipped(files)}


def _place(platform: Platform, version: int, name: str) -> str:
    folder = platform.name if version == 3 else platform.old_name
    return f"binaries/{folder}/{name}{platform.suffix}"


def described(compilation: Compilation, program: Program, texts: dict[str, str]) -> Unit:
    """Return what the description of a model tells, with its initial state."""
    interface, functions = program.interface, program.functions
    loaded = Loaded(compilation, "numpy")
    own = loaded.system("numpy").interface
    absent = unused(compilation.model, own)
    values = bound_parameters(own, compilation.choice.parameters, absent)
    start = loaded.initialize(loaded.system("numpy").bind(values), Request()).x
    depends = any(o.op == "load" for o in functions["start"].operations)
    return Unit(
        interface,
        token=cache.key(interface.model_hash, *texts.values(), *map(fixed, TEXTS[3]))[:32],
        start=start[: interface.nq + interface.nv],
        exact=not interface.needs_consistency and not depends,
        directional=not interface.contacts and not interface.loading_rows
        and bool(interface.nc or "system" in functions),
        constants=tuple([f.name for f in absent if f.value is None]),
    )  # fmt: skip
