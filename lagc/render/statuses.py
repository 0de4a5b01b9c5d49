"""The statuses of generated code, the same in every language: name, text, what the culprit is."""

from __future__ import annotations

STATUSES = (
    ("OK", "done", ""),
    ("SINGULAR_MASS", "the mass matrix is singular, or not positive definite", "index of v"),
    ("REDUNDANT", "rows of constraints depend on each other",
     "a row; a success: lambda is the smallest that fits"),
    ("INCONSISTENT", "rows of constraints contradict each other", "a row"),
    ("NOT_FINITE", "a value is not finite", "index of x: of what is not finite there, else of its rate"),
    ("STEP_UNDERFLOW", "the step became too small for the tolerance", ""),
    ("MAX_STEPS", "the steps that one call may take are used up", "none; call again to go on"),
    ("INTERRUPTED", "interrupted", "none; call again to go on"),
    ("INVALID", "an option, a time or a parameter makes no sense", "see LAGC_BAD_METHOD and on"),
)  # fmt: skip
