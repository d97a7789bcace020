"""What a VTU file says, read without VTK."""

import base64
import xml.etree.ElementTree as ElementTree
import zlib
from pathlib import Path

import numpy as np


def arrays(path: Path) -> tuple[dict[str, np.ndarray], ElementTree.Element]:
    """Data arrays of a file by name, decoded, and its root."""
    root = ElementTree.parse(path).getroot()
    types = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}
    found = {}
    for element in root.iter("DataArray"):
        blocks, size, rest, packed = np.frombuffer(base64.b64decode(element.text[:44]), "<u8").tolist()
        data = zlib.decompress(base64.b64decode(element.text[44:]))
        assert (blocks, rest) == (1, 0) and len(data) == size
        assert packed == len(base64.b64decode(element.text[44:]))
        values = np.frombuffer(data, types[element.get("type")])
        found[element.get("Name")] = values.reshape(-1, int(element.get("NumberOfComponents")))
    return found, root
