"""lagc: from a mechanical system to its motion.

    import lagc
    model = lagc.load("pendulum.lag")
    system = model.compile(scene="room")
    run = system.simulate(stop=10, accuracy=1e-8)

The names below are loaded when they are first used, so that `import lagc` costs nothing.
"""

from __future__ import annotations

from lagc.version import __version__

TYPE_CHECKING = False  # as `typing` has it, which takes as long to load as all else here

__all__ = ["CompiledModel", "Limits", "ModelFile", "Refused", "__version__", "load", "loads"]

if TYPE_CHECKING:
    from lagc.api import CompiledModel, ModelFile, load, loads
    from lagc.diagnostics.faults import Refused
    from lagc.host.budgets import Limits


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name == "Refused":
        from lagc.diagnostics.faults import Refused as found

        return found
    if name == "Limits":
        from lagc.host.budgets import Limits as limits

        return limits
    from lagc import api

    return getattr(api, name)


def load_ipython_extension(shell: object) -> None:
    """`%load_ext lagc` in a notebook."""
    from lagc.api.notebook import load as load_notebook

    load_notebook(shell)


def __dir__() -> list[str]:
    return list(__all__)
