"""Run a campaign; what it has done before stays."""

import argparse
import tempfile
import warnings
from pathlib import Path

from benchmarks.fuzzing.answers import KINDS, sources
from benchmarks.fuzzing.campaign import campaign, table, warmed

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path, help="folder of the journal and the findings")
    parser.add_argument("--count", type=int, default=100_000, help="inputs")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--only", default="", help="sources whose name holds this")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        found = [s for s in sources(Path(folder), tuple(asked.kinds)) if asked.only in s.name]
        warmed(found)
        print(table(campaign(asked.out, found, asked.count, asked.seed)))
