"""A cut as a shop states it; what most first questions are asked of."""

from chatter.description.case import Case, loads

CUT = """\
title = "Shop"
[tool]
kind = "end mill"
teeth = 4
diameter = "16 mm"
helix = "40 deg"
[material]
Ktc = "1900 MPa"
Krc = "700 MPa"
Kte = "25 N/mm"
Kre = "40 N/mm"
[cut]
mode = "down"
cutting_speed = "60 m/min"
feed_rate = "380 mm/min"
axial_depth = "0.5 mm"
radial_depth = "8 mm"
[structure]
mode = [
    { frequency = "900 Hz", damping = 0.03, stiffness = "12 N/um", direction = "x" },
    { frequency = "950 Hz", damping = 0.03, stiffness = "12 N/um", direction = "y" },
]
[lobes]
method = "zero-order"
speeds = { from = "1000 rpm", to = "2000 rpm", count = 30 }
"""


def cut(**values) -> Case:
    """The cut with values set; dots of their paths as double underscores."""
    return loads(CUT).patch({path.replace("__", "."): value for path, value in values.items()})


def written(folder):
    """Path of the cut as a file."""
    path = folder / "shop.toml"
    path.write_text(CUT, encoding="utf-8")
    return path
