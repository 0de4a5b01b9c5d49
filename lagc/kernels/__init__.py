"""The runtime, written once: all that runs and is not the equations of a model.

Kernels are Python in a small typed subset (`words`), one file a subject, with the formula and its source
as comment.  The printers of `lagc.codegen.kernel_compiler` make C and Python of them; what is outside the subset
is refused there with file and line.  No kernel calls one that stands after it: files in the order of
FILES, functions in that of their file.
"""

from typing import NewType

Status = NewType("Status", int)  # what a call ends with: see `statuses`
FILES = (
    "language/statuses",
    "language/tolerances",
    "arithmetic/trigonometry",
    "language/records",
    "language/parameters",
    "language/scaling_groups",
    "language/branch_evaluation",
    "linear_algebra/cholesky",
    "linear_algebra/rank_revealing",
    "linear_algebra/sparse_rank_revealing",
    "dynamics/rhs",
    "arithmetic/quaternions",
    "constraints/projection",
    "integrators/explicit_runge_kutta",
    "integrators/dispatch",
    "arguments",
    "integrators/step_size",
    "integrators/error_norm",
    "integrators/roundoff",
    "events/enclosing",
    "events/modes",
    "events/location",
    "events/sliding",
    "events/mode_change",
    "events/when_clauses",
    "events/step_guards",
    "call_boundary",
    "driver",
    "trajectory",
    "initialization/workspace",
    "initialization/leastrows",
    "initialization/least_norm",
    "initialization/startparts",
    "initialization/residuals",
    "initialization/startpairs",
    "initialization/scaling",
    "initialization/linear_model",
    "initialization/startalone",
    "initialization/gauss_newton",
    "initialization/multistart",
    "initialization/relaxation",
    "initialization/startsearch",
    "initialization/consistent",
)
WORDS = (
    "language/words",
    "language/sizes",
    "language/tables",
    "language/model",
    "language/tableau",
)  # what kernels may name
METHODS = (
    "dop853",
    "dopri5",
    "rk4",
    "bs32",
)  # folder `integrators/tableaus`: one file each; a number of the interface by its place
MOST_ACTS = 20  # of a clause `when` at one moment, on average: more are without end
