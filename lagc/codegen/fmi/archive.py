"""The file of an FMU: a zip archive, with the same bytes for the same content at any time and place."""

from __future__ import annotations

import io
from collections.abc import Mapping
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

DATE = (1980, 1, 1, 0, 0, 0)  # the first that a zip archive can have


def zipped(files: Mapping[str, str | bytes]) -> bytes:
    """Return the archive of `files`, by name in their order."""
    data = io.BytesIO()
    with ZipFile(data, "w", ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in files.items():
            entry = ZipInfo(name, DATE)
            entry.create_system, entry.compress_type, entry.external_attr = 3, ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, content)
    return data.getvalue()
