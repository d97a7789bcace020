"""The tractions of fedoo on the paths of `debond law --write FOLDER`, as the file that `debond law --with` judges:

set='--set interface.criterion="power" --set interface.exponent=2 --set interface.onset="quadratic"'
./debond law enf-as4peek $set --write law
./debond exec python examples/peers/fedoo/law_points.py law tractions.csv
./debond law enf-as4peek $set --with tractions.csv
"""

import json
import re
import sys
from pathlib import Path

from verify.methods import peers
from verify.support.refusal import Refusal

PAIR = r"{}: (\S+) in opening, (\S+) in sliding"
#: fedoo's names of the numbers of the bond, in opening and in sliding.
NAMES = {"strength": ("SImax", "SIImax"), "toughness": ("GIc", "GIIc"), "stiffness": ("KI", "KII")}


def tractions(folder: Path, to: Path) -> None:
    """Run `debond_fedoo_run` on the paths, with the numbers of the bond that the folder's guide has."""
    guide, numbers = (folder / "README.txt").read_text(), {}
    for name, names in NAMES.items():
        found = re.search(PAIR.format(name), guide)
        assert found is not None
        numbers |= dict(zip(names, map(float, found.groups()), strict=True))
    (folder / "fedoo.json").write_text(json.dumps(numbers))
    program = Path(__file__).with_name("debond_fedoo_run.py").resolve()
    peers.run("fedoo", [peers.known()["fedoo"].interpreter, program, folder.resolve(), to.resolve()], folder)


if __name__ == "__main__":
    if reason := peers.named("fedoo").missing():
        raise Refusal(reason)
    tractions(Path(sys.argv[1]), Path(sys.argv[2]))
