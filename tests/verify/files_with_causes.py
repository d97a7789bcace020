"""Files for the table of causes: a test of a DCB as machines may write it, decks of two arms, each with one fault."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

SCENE = """units = "N, mm, MPa"
specimen = { kind = "dcb", length = 150.0, arm_thickness = 1.5, precrack = 50.0, width = 25.0 }
material = { young = 128e3, poisson = 0.3 }
interface = { strength = 20.0, toughness = 0.3 }
load = { opening = [5.0] }
"""
ARMS = """specimen = {{ kind = "dcb", length = 40.0, arm_thickness = 1.0, precrack = 10.0, mesh = "{}.inp" }}
material = {{ young = 120e3, poisson = 0.3 }}
interface = {{ strength = 20.0, toughness = 0.28, stiffness = 1e4 }}
load = {{ opening = 0.05 }}
discretization = {{ steps = 3 }}
"""
#: First bytes of a workbook before 2007, and of one with a password.
OLE = bytes.fromhex("d0cf11e0a1b11ae1") + bytes(512)


def table(head: str, *columns: np.ndarray, form: str = "{:.6g}", separator: str = ",") -> str:
    rows = [separator.join(form.format(x) for x in row) for row in zip(*columns, strict=True)]
    return "\n".join([head, *rows, ""])


def curves() -> dict[str, str | bytes]:
    """Opening, load and crack length of a beam with a sharp crack at 0.3 N/mm: P = b (G E h^3 / 12)^(1/2) / a."""
    a = np.linspace(50.0, 80.0, 400)
    P_a = 25.0 * (0.3 * 128e3 * 1.5**3 / 12.0) ** 0.5 / a
    d_a = np.append(0.0, 8.0 * a**3 / (128e3 * 25.0 * 1.5**3) * P_a)
    d = np.linspace(0.0, d_a[-1], 160)
    P, a = np.interp(d, d_a, np.append(0.0, P_a)), np.interp(d, d_a, np.append(50.0, a))
    head, cracks = "opening,load", "opening,load,crack"
    turn = np.degrees(0.1 * d / d[-1])
    commas = table(head, d, P, form="{:.3f}").replace(",", ";").replace(".", ",").replace("opening;", "opening,")
    words = table(head, d[:80], P[:80]) + "Test paused\n" + table("", d[80:], P[80:]).lstrip()
    return {
        "right.csv": table(head, d, P),
        "zero.csv": table(head, d, 0.0 * P),
        "turned.csv": table(head, d, -P),
        "closing.csv": table(head, -d, -P),
        "crosshead.csv": table(head, d - 100.0, P),
        "crosshead-down.csv": table(head, -100.0 - d, P),
        "back.csv": table(head, d[::-1], P[::-1]),
        "still.csv": table(head, 0.0 * d - 1.0, P),
        "swapped.csv": table("load,opening", d, P),
        "kn.csv": table(head, d, P / 1e3),
        "lbf.csv": table(head, d, P / 4.4482),
        "inch.csv": table(head, d / 25.4, P),
        "commas.csv": commas.replace(";", ","),
        "commas-apart.csv": commas.replace("opening,", "opening;"),
        "two-tests.csv": f"{head}\n0.1,2.0,0.1,3.0\n0.2,4.0,0.2,6.0\n",
        "three.csv": f"{head}\n0,1,2\n1,2,3\n",
        "words.csv": words,
        "na.csv": f"{head}\n0,0\n1,#N/A\n2,3\n",
        "clock.csv": f"{head}\n0,0\n1,12:30:05\n2,3\n",
        "hole.csv": f"{head}\n0,0\n1,\n2,3\n",
        "one.csv": "opening\n0\n1\n2\n",
        "twice.csv": "opening,load,load\n0,0,0\n1,2,3\n",
        "bare.csv": "0,0\n1,2\n3,1\n",
        "late.csv": table(head, d[40:], P[40:]),
        "sparse.csv": table(head, d[[0, 60, 100, 159]], P[[0, 60, 100, 159]]),
        "elastic.csv": table(head, d[:15], P[:15]),
        "metres.csv": table(cracks, d, P, a / 1e3),
        "growth.csv": table(cracks, d, P, a - 50.0),
        "shorter.csv": table(cracks, d, P, a - 8.0),
        "left.csv": table(cracks, d, P, 150.0 - a),
        "slip.csv": table(cracks, d, P, np.where(np.arange(d.size) == 120, a - 9.0, a)),
        "degrees.csv": table("opening,load,t1,t2", d, P, turn, -turn),
        "alike.csv": table("opening,load,t1,t2", d, P, turn / 57.3, turn / 57.3),
        "locked.xlsx": OLE + "EncryptedPackage".encode("utf-16-le"),
        "old.xls": OLE + "Workbook".encode("utf-16-le"),
        "cut.xlsx": b"PK\x03\x04" + bytes(40),
        "a.pdf": b"%PDF-1.4\n1 0 obj <<>> endobj\n",
        "a.png": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
        "a.html": "<html><table><tr><td>opening</td><td>load</td></tr></table></html>\n",
    }


Place = Callable[[float, float, bool], tuple[float, float]]


def deck(place: Place = lambda x, y, upper: (x, y), kind: str = "CPS4") -> str:
    """Two arms of 8 elements each, with nodes moved to where ``place`` says."""
    nodes, elements = ["*NODE"], [f"*ELEMENT, TYPE={kind}"]
    for first, upper in ((1, True), (101, False)):
        for i in range(18):
            x, y = place(5.0 * (i // 2), float(i % 2 - (not upper)), upper)
            nodes.append(f"{first + i}, {x:.9g}, {y:.9g}")
        elements += [f"{n}, {n}, {n + 2}, {n + 3}, {n + 1}" for n in range(first, first + 16, 2)]
    return "\n".join([*nodes, *elements, ""])


def decks() -> dict[str, str]:
    """The arms of `ARMS` with one fault."""
    whole, apart = deck(), deck(lambda x, y, upper: (x, y + 0.1 * upper))
    adhesive = [f"{900 + n}, {101 + n}, {103 + n}, {n + 2}, {n}" for n in range(5, 17, 2)]
    corners = [f"{2 * i + j + 1}, {5 * i}, {2 * j - 1}" for i in range(9) for j in range(2)]
    through = [f"{n}, {n}, {n + 2}, {n + 3}, {n + 1}" for n in range(1, 17, 2)]
    return {
        "whole": whole,
        "metres": deck(lambda x, y, upper: (x / 1e3, y / 1e3)),
        "long": deck(lambda x, y, upper: (1.25 * x, y)),
        "thin": deck(lambda x, y, upper: (x, y / 10.0)),
        "apart": apart,
        "layer": "\n".join([apart, *adhesive, ""]).replace("\n\n", "\n"),
        "half": whole[: whole.index("101, 101")],
        "one": "\n".join(["*NODE", *corners, "*ELEMENT, TYPE=CPS4", *through, ""]),
        "upright": deck(lambda x, y, upper: (-y, x)),
        "of-8": deck(kind="CPS8"),
        "of-3": deck(kind="CPS3"),
        "cut": whole[: whole.rindex(",")],
        "gap": whole.replace("\n9, 20, 0\n", "\n"),
        "again": whole + "1, 1, 3, 4, 2\n",
    }


def write(folder: Path) -> None:
    """All files."""
    for name, content in curves().items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    with zipfile.ZipFile(folder / "a.ods", "w") as archive:
        archive.writestr("content.xml", "<a/>")
    (folder / "c.toml").write_text(SCENE)
    for name, text in decks().items():
        (folder / f"{name}.inp").write_text(text)
        (folder / f"{name}.toml").write_text(ARMS.format(name))
