"""The runtime of generated code, written once: integrators, constraints, events, initialization.

A kernel is Python in a small typed subset (`language/words`); a file treats one subject and names its
sources.  The printers of `lagc.codegen.kernel_compiler` translate kernels to C and Python and refuse, with
file and line, what is outside of the subset.  A kernel calls only kernels that stand before it: files in the
order of FILES, functions in the order of their file.
"""

from typing import NamedTuple, NewType

Status = NewType("Status", int)  # the result of a call, see `statuses`
FILES = (
    "language/statuses",
    "language/tolerances",
    "arithmetic/trigonometry",
    "language/contact_law",
    "language/records",
    "language/trial",
    "language/verification",
    "language/parameters",
    "language/state_vectors",
    "linear_algebra/cholesky",
    "linear_algebra/rank_revealing",
    "linear_algebra/sparse_rank_revealing",
    "linear_algebra/dense_lu",
    "contact/law",
    "contact/shares",
    "contact/modes",
    "contact/impact",
    "dynamics/rhs",
    "arithmetic/quaternions",
    "constraints/projection",
    "dynamics/loaded_reactions",
    "contact/responses",
    "contact/normal_forces",
    "events/sampled_indicators",
    "contact/kept_blocks",
    "contact/touching",
    "contact/flight",
    "integrators/explicit_runge_kutta",
    "integrators/stage_equations",
    "integrators/radau",
    "integrators/taylor",
    "integrators/dispatch",
    "arguments",
    "integrators/step_size",
    "integrators/stiffness",
    "integrators/error_weights",
    "integrators/roundoff",
    "events/late_indicators",
    "events/modes",
    "contact/indicators",
    "events/suspects",
    "events/location",
    "contact/slips",
    "contact/settle",
    "events/sliding",
    "events/mode_change",
    "events/when_clauses",
    "events/contact_events",
    "events/departures",
    "events/step_guards",
    "call_boundary",
    "events/other_integrators",
    "integrators/step_grid",
    "driver",
    "trajectory",
    "verification/quantity_errors",
    "verification/pair",
    "verification/tolerance_search",
    "sensitivity/tangents",
    "sensitivity/tangent_stages",
    "sensitivity/tangent_dispatch",
    "sensitivity/tangent_step",
    "initialization/workspace",
    "initialization/residuals",
    "initialization/gauss_newton",
    "initialization/consistent",
)


class Family(NamedTuple):
    """The common part of the methods of a family, as kernels read it."""

    files: tuple[str, ...]  # kernels that are printed for each of its methods
    PROJECTS: int = 1  # 1: the end of a step is projected onto the constraints
    CONTROLS: int = 0  # 1: it has `set_next_step` and `shrink_step` of its own
    SENSITIVE: int = 1  # 1: sensitivities follow its steps
    SERIES: int = 0  # 1: it expands the motion in a power series before each step


FAMILIES = {
    "explicit_runge_kutta": Family(("integrators/explicit_runge_kutta", "sensitivity/tangent_stages")),
    "radau": Family(("integrators/radau",), CONTROLS=1, SENSITIVE=0),
    "taylor": Family(("integrators/taylor",), CONTROLS=1, SENSITIVE=0, SERIES=1),
}
WORDS = (
    "language/words",
    "language/sizes",
    "language/model_tables",
    "language/model_functions",
    "language/tableau",
)  # the declarations that kernels use
METHODS = (
    "dop853",
    "dopri5",
    "rk4",
    "bs32",
    "radau5",
    "taylor",
)  # one file each in `integrators/tableaus`; the position is the number in generated code
IMPLICIT = ("radau5",)  # need derivatives: only models that are compiled for them carry these
SERIES = ("taylor",)  # need recurrences: likewise
EXPLICIT = tuple([name for name in METHODS if name not in (*IMPLICIT, *SERIES)])
DEFAULT_METHOD = "dop853"
MOST_ACTS = 20  # actions of a `when` clause at one event, on average; more are taken for endless
