"""Workbooks of spreadsheets as text: the first sheet that holds a table of numbers."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

#: First bytes of a workbook of today (a zip archive), and of one before 2007.
ZIPPED, OLD = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
#: In a workbook with a password, which has the first bytes of an old one: [MS-OFFCRYPTO] 2.3.4.4.
LOCKED = "EncryptedPackage".encode("utf-16-le")
#: Numbers in a sheet from which it counts as a table.
SOME_NUMBERS = 4


def text_of_workbook(path: Path) -> str:
    """The cells of a sheet, separated by tabs, a row a line.

    Raises
    ------
    ModuleNotFoundError : without openpyxl.
    ValueError : no workbook, or none with a table of numbers.
    """
    import openpyxl

    try:
        book = openpyxl.load_workbook(io.BytesIO(path.read_bytes()), read_only=True, data_only=True)
    except Exception as error:  # whatever an archive holds
        what = "is cut off or broken" if isinstance(error, zipfile.BadZipFile) else "is an archive, and no .xlsx"
        raise ValueError(f"{what}; save its table as .xlsx or as CSV") from None
    for sheet in book.worksheets:
        rows = [list(row) for row in sheet.iter_rows(values_only=True)]
        if sum(isinstance(cell, int | float) for row in rows for cell in row) >= SOME_NUMBERS:
            return "\n".join("\t".join(_text(cell) for cell in row) for row in rows)
    raise ValueError(f"has no sheet with a table of numbers, got {', '.join(book.sheetnames) or 'none'}")


def _text(cell: object) -> str:
    """A cell without tabs and line breaks; numbers with all their digits."""
    return "" if cell is None else repr(float(cell)) if isinstance(cell, int | float) else " ".join(str(cell).split())
