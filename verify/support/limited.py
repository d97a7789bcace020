"""The content of files that may be of any kind, up to a size."""

from __future__ import annotations

import errno
from pathlib import Path

#: Bytes beyond which a file is refused, like a device that never ends.
LARGEST_FILE = 2**28


def read_at_most(path: Path, most: int = LARGEST_FILE) -> bytes:
    """The content of a file.

    Raises
    ------
    OSError : the file cannot be read, or has more than ``most`` bytes.
    """
    with path.open("rb") as stream:
        content = stream.read(most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"it has more than {most / 1e6:.0f} MB", str(path))
    return content
