"""The tractions of MOOSE on the paths of `debond law --write FOLDER`, as the file that `debond law --with` judges:

./debond law enf-as4peek --set 'interface.onset="quadratic"' --write law
./debond exec python examples/peers/moose/law_points.py law tractions.csv
./debond law enf-as4peek --set 'interface.onset="quadratic"' --with tractions.csv
"""

import csv
import re
import sys
from pathlib import Path

from debond_moose import BINARY

from verify.methods import peers
from verify.support.refusal import Refusal


def tractions(folder: Path, to: Path) -> None:
    """Run ``moose.i`` of the folder once a path, with its name and its number of steps, and write one table.

    A path that MOOSE leaves early, as with nan, has zeros from there on: they are called wrong.
    """
    ways: dict[str, list[tuple[float, float]]] = {}
    with (folder / "paths.csv").open() as file:
        for row in csv.DictReader(file):
            ways.setdefault(row["path"], []).append((float(row["g"]), float(row["s"])))
    deck = (folder / "moose.i").read_text()
    (given,) = re.search(r"file_base = (.+)-moose", deck).groups()
    with to.open("w") as out:
        print("path,step,g,s,p,t", file=out)
        for name, jumps in ways.items():
            text = deck.replace(f"{given}.csv", f"{name}.csv").replace(f"{given}-moose", f"{name}-moose")
            (folder / "one.i").write_text(re.sub(r"end_time = \d+", f"end_time = {len(jumps) - 1}", text))
            try:
                words = [peers.known()["moose"].site / BINARY, "-i", "one.i", "-pc_type", "lu", "--no-color"]
                peers.run("moose", words, folder)
            except RuntimeError as error:
                print(f"{name}: {error}", file=sys.stderr)
            with (folder / f"{name}-moose.csv").open() as file:
                found = {round(float(row["time"])): row for row in csv.DictReader(file)}
            for step, (g, s) in enumerate(jumps):
                row = found.get(step, {"p": 0.0, "t": 0.0})
                print(f"{name},{step},{g!r},{s!r},{float(row['p'])!r},{float(row['t'])!r}", file=out)


if __name__ == "__main__":
    if reason := peers.named("moose").missing():
        raise Refusal(reason)
    tractions(Path(sys.argv[1]), Path(sys.argv[2]))
