"""Ships the parser's tables and the kernels of common models, so that no run has to make them."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CustomBuildHook(BuildHookInterface[Any]):
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        sys.path.insert(0, self.root)
        from lagc.compiler.shipped import files

        for path, text in files(Path(self.root)).items():
            path.write_text(text, encoding="utf-8")
            build_data["artifacts"].append(os.path.relpath(path, self.root))
