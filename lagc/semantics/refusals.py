"""Exceptions that end the evaluation of a declaration."""

from __future__ import annotations

from lagc.diagnostics.faults import Fault, Span


class Wrong(Exception):
    """A fault ends the evaluation."""

    def __init__(
        self, code: str, message: str, span: Span | None, remedy: str | None = None,
        related: tuple[tuple[Span, str], ...] = (),
    ):  # fmt: skip
        self.fault = Fault(code, message, span, related, remedy)
        super().__init__(message)


class Poisoned(Exception):
    """The evaluation ends because of a fault that is already reported."""
