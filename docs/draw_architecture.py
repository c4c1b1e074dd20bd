"""Draw docs/pictures/architecture.png: the way of the data through the layers."""

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

OUT = Path(__file__).resolve().parent / "pictures" / "architecture.png"
#: text, centre and size in the plane of the drawing, colour
BOXES = {
    "files": ("files\ncase, machine,\nFRFs, records", (1.0, 6.6), (1.7, 0.9), "#eeeeee"),
    "io": ("io\nfile formats", (1.0, 5.2), (1.7, 0.8), "#d7e7f5"),
    "description": ("description\nCase: keys, units, patches", (3.7, 6.6), (2.1, 0.9), "#d7e7f5"),
    "compile": ("compile\nflat arrays, SI", (6.6, 6.6), (1.9, 0.9), "#d7e7f5"),
    "dynamics": (
        "dynamics\nstructure, friction,\ndrives, control",
        (5.2, 3.5),
        (2.1, 1.0),
        "#f5e6cf",
    ),
    "cutting": ("cutting\ntool, force, chip,\nworkpiece", (8.0, 3.5), (2.1, 1.0), "#f5e6cf"),
    "engine": ("engine\nlaw groups on ports,\none time loop", (6.6, 5.1), (2.1, 0.9), "#d7e7f5"),
    "simulation": ("simulation\na cut, a machine", (9.5, 5.1), (1.9, 0.8), "#d7e7f5"),
    "stability": ("stability\nmethods, diagrams", (9.5, 6.6), (2.1, 0.9), "#d7e7f5"),
    "detection": ("detection\nchatter or not", (11.9, 5.1), (2.0, 0.8), "#d7e7f5"),
    "studies": ("studies\nwhat-if, optimisation,\nuncertainty", (11.9, 6.6), (2.0, 0.9), "#d7e7f5"),
    "explain": ("explain\nsearch over patches", (7.9, 8.3), (2.3, 0.8), "#d7e7f5"),
    "output": ("plots, report\npictures and pages", (11.9, 8.3), (2.0, 0.8), "#d7e7f5"),
    "cli": ("cli, app\ncommands, workbench", (3.7, 8.3), (2.1, 0.8), "#d7e7f5"),
}
#: from, to, words beside the arrow
ARROWS = (
    ("files", "description", "units"),
    ("files", "io", ""),
    ("io", "description", "FRFs"),
    ("description", "compile", "Case"),
    ("compile", "engine", ""),
    ("compile", "stability", "model"),
    ("dynamics", "engine", "laws"),
    ("cutting", "engine", "laws"),
    ("engine", "simulation", ""),
    ("simulation", "detection", ""),
    ("simulation", "studies", ""),
    ("stability", "studies", ""),
    ("studies", "output", "results"),
    ("cli", "description", ""),
    ("explain", "compile", "patched Case"),
    ("explain", "output", ""),
)


def _edge(start: str, end: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """Points where the line between two boxes leaves the one and meets the other."""
    ends = []
    for one, other in ((start, end), (end, start)):
        (x, y), (width, height) = BOXES[one][1:3]
        dx, dy = (b - a for a, b in zip((x, y), BOXES[other][1], strict=True))
        share = min(0.5 * width / abs(dx) if dx else 9.0, 0.5 * height / abs(dy) if dy else 9.0)
        ends.append((x + share * dx, y + share * dy))
    return ends[0], ends[1]


def main() -> None:
    """Draw the picture."""
    figure, axes = plt.subplots(figsize=(11.0, 5.4))
    for text, (x, y), (width, height), colour in BOXES.values():
        corner = (x - 0.5 * width, y - 0.5 * height)
        axes.add_patch(
            FancyBboxPatch(
                corner, width, height, boxstyle="round,pad=0,rounding_size=0.08",
                facecolor=colour, edgecolor="#444444", linewidth=0.9,
            )
        )  # fmt: skip
        name, _, rest = text.partition("\n")
        lines = 1 + rest.count("\n")
        axes.text(x, y + 0.13 * lines, name, ha="center", va="center", weight="bold", size=9)
        axes.text(x, y - 0.14, rest, ha="center", va="center", size=7.2)
    for start, end, words in ARROWS:
        one, other = _edge(start, end)
        axes.add_patch(
            FancyArrowPatch(one, other, arrowstyle="-|>", mutation_scale=11, color="#444444")
        )
        if not words:
            continue
        axes.text(
            0.5 * (one[0] + other[0]), 0.5 * (one[1] + other[1]), words,
            size=6.8, ha="center", va="center", color="#333333",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
        )  # fmt: skip
    axes.set(xlim=(0.0, 13.1), ylim=(2.8, 8.9), aspect="equal")
    axes.axis("off")
    figure.savefig(OUT, dpi=130, bbox_inches="tight")


if __name__ == "__main__":
    main()
