"""Ships the parser's tables and the printed kernels, so that no run has to make them."""

from __future__ import annotations

import os
import sys
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CustomBuildHook(BuildHookInterface[Any]):
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        sys.path.insert(0, self.root)
        from lagc.codegen.kernel_compiler import shipped
        from lagc.syntax import lalr_tables

        for made in (lalr_tables, shipped):
            with open(made.shipped_path(), "w", encoding="utf-8") as file:
                file.write(made.packed())
            build_data["artifacts"].append(os.path.relpath(made.shipped_path(), self.root))
