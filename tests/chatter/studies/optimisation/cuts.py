"""Cuts that the tests of the optimum share."""

from chatter import Case

MODES = [
    {"frequency": "900 Hz", "damping": 0.03, "stiffness": "14 N/um", "direction": [1, 0, 0]},
    {"frequency": "1010 Hz", "damping": 0.04, "stiffness": "10 N/um", "direction": [0, 1, 0]},
]


def end_mill(changes=None):
    """A 16 mm end mill of three teeth in aluminium, with what is to be changed by its path."""
    case = Case.from_dict(
        {
            "title": "16 mm end mill",
            "tool": {"teeth": 3, "diameter": "16 mm", "helix": "30 deg"},
            "material": {"Ktc": "800 MPa", "Krc": "250 MPa", "Kte": "12 N/mm", "Kre": "14 N/mm"},
            "cut": {
                "mode": "down",
                "spindle_speed": "8000 rpm",
                "feed_per_tooth": "0.08 mm",
                "axial_depth": "1 mm",
                "radial_depth": "5 mm",
            },
            "structure": {"mode": MODES},
        }
    )
    return case.patch(changes or {})
