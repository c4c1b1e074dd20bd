"""A carved workpiece: entry, a step in the stock and a corner come out of the geometry.

The force starts where the tool meets the block, rises on the step, and again in the corner, where
the arc of engagement opens.
"""

from pathlib import Path

import numpy as np

import chatter

HERE = Path(__file__).parent


def main(out: Path) -> list[Path]:
    """Simulate the path, print the force along it, return what was written."""
    case = chatter.load(HERE / "case.toml")
    result = chatter.simulate(case)
    place = result.setup.path.position_at(result.time)
    resultant = np.linalg.norm(result.force, axis=1)
    way = np.cumsum(np.hypot(*np.diff(place, axis=1, prepend=place[:, :1])))
    for low, high in ((0.0, 2.0), (8.0, 12.0), (22.0, 28.0), (31.0, 34.0)):
        inside = (way >= low * 1e-3) & (way < high * 1e-3)
        print(f"{low:4.0f} to {high:4.0f} mm along the path: {resultant[inside].max():6.0f} N")
    return result.save(Path(out))


if __name__ == "__main__":
    main(Path("out"))
