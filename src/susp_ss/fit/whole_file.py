"""A file that is there whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def write_whole(target: Path, content: str | bytes) -> None:
    """Write a file, or replace it at once.

    Raises
    ------
    OSError
        It cannot be written; nothing half written is left.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from susp_ss.fit.whole_file import write_whole
    >>> path = pathlib.Path(tempfile.mkdtemp(), "runs.json")
    >>> write_whole(path, "{}")
    >>> path.read_text()
    '{}'
    """
    raw = content.encode("utf-8") if isinstance(content, str) else content
    with tempfile.TemporaryDirectory(prefix=".susp_ss-", dir=target.parent) as scratch:
        written = Path(scratch, target.name)
        written.write_bytes(raw)
        os.replace(written, target)
