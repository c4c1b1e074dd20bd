"""The highest removal rate within power, torque, deflection, surface error and what is uncertain.

The speed with the deepest stable cut is not the best one: there a harmonic of the teeth meets the
mode, and the wall is off by more than is allowed. The best cut lies beside it.
"""

from pathlib import Path

import chatter

HERE = Path(__file__).parent


def main(out: Path) -> list[Path]:
    """Search, print what limits the best cut, return what was written."""
    found = chatter.optimum(chatter.load(HERE / "case.toml"), samples=100)
    for line in found.sentences():
        print(line)
    return found.save(out)


if __name__ == "__main__":
    main(Path("out"))
