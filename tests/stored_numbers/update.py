"""Store what cases give now, with the reason why it changed.

    python tests/stored_numbers/update.py ball/check "machine-*" --reason "corner arcs refined"

Only what lies outside its tolerance is written. Tolerances that are stored stay as they are; an
entry that is deleted from numbers.toml is stored anew, with that of results.py. Names may hold *
and ?.
"""

from __future__ import annotations

import argparse
import os
import sys
from fnmatch import fnmatchcase
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))
# as in the tests: fits are those of one thread of the linear algebra
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from tests.stored_numbers import store
from tests.stored_numbers.cases import stored_cases
from tests.stored_numbers.results import Readings, readings


def updated(old: store.Entries, now: Readings, reason: str) -> store.Entries:
    """Entries of a case after a change: a value that moved is new and says why."""
    entries: store.Entries = {}
    for name, reading in now.items():
        known = old.get(name)
        if known is not None and not store.differences({name: known}, {name: reading}):
            entries[name] = known
            continue
        entries[name] = entry = store.entry_of(reading)
        if known is not None:
            entry |= {key: known[key] for key in ("rtol", "atol") if key in known and key in entry}
            entry["reason"] = reason
    return entries


def main() -> int:
    """Compute the named cases and rewrite what moved; print every change."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="+", metavar="CASE", help="names or patterns of cases")
    parser.add_argument("--reason", required=True, help="why the numbers changed, for the reader")
    given = parser.parse_args()
    known = stored_cases()
    chosen = [name for name in known if any(fnmatchcase(name, pattern) for pattern in given.names)]
    if not chosen or not given.reason.strip():
        parser.error("no case has such a name, or the reason is empty")
    for name in chosen:
        now = readings(known[name])
        # read and written for each case: what is finished is kept when a later case fails
        stored = {case: entries for case, entries in store.read().items() if case in known}
        old = stored.get(name, {})
        changed = store.differences(old, now)
        print(name, *(changed or ["as stored"]), sep="\n  ", flush=True)
        if changed:
            store.write(stored | {name: updated(old, now, given.reason.strip())})
    return 0


if __name__ == "__main__":
    sys.exit(main())
