"""What the units library says of the units that files are mostly written in.

The library reads all the units there are before it answers, for which a short command would wait
longer than for its result. A test holds each figure here to its answer, to the last digit.
"""

#: dimension -> unit -> SI value of one
SI_VALUE: dict[str, dict[str, float]] = {
    "moment_of_inertia": {"kg*cm^2": 0.0001, "kg*mm^2": 1e-06},
    "rotational_stiffness": {"kN*m/rad": 1000.0},
    "rotational_damping": {"kN*m*s/rad": 1000.0},
    "inverse_length": {"1/mm": 1000.0},
    "inductance": {"mH": 0.001},
    "length": {"mm": 0.001, "um": 1e-06, "µm": 1e-06, "cm": 0.01},
    "angle": {"deg": 0.017453292519943295},
    "angular_speed": {
        "rpm": 0.10471975511965977,
        "1/min": 0.10471975511965977,
        "Hz": 6.283185307179586,
    },
    "frequency": {"kHz": 1000.0},
    "mass": {"g": 0.001},
    "line_force": {"N/mm": 1000.0, "kN/m": 1000.0, "N/um": 1000000.0},
    "stiffness": {
        "N/mm": 1000.0,
        "N/um": 1000000.0,
        "kN/m": 1000.0,
        "kN/mm": 1000000.0,
        "MN/m": 1000000.0,
    },
    "damping": {"kN*s/m": 1000.0, "N*s/mm": 1000.0},
    "pressure": {"kPa": 1000.0, "MPa": 1000000.0, "GPa": 1000000000.0, "N/mm^2": 1000000.0},
    "force": {"kN": 1000.0},
    "torque": {"kN*m": 1000.0},
    "power": {"kW": 1000.0},
    "time": {"ms": 0.001, "us": 1e-06, "min": 60.0},
    "acceleration": {"mm/s^2": 0.001},
    "jerk": {"mm/s^3": 0.001},
    "velocity": {"m/min": 0.016666666666666666, "mm/min": 1.6666666666666667e-05, "mm/s": 0.001},
}

#: unit of a measured file -> exponents of the base dimensions, SI value of one, whether an angle
MEASURED: dict[str, tuple[dict[str, int], float, bool]] = {
    "s": ({"[time]": 1}, 1.0, False),
    "ms": ({"[time]": 1}, 0.001, False),
    "m": ({"[length]": 1}, 1.0, False),
    "mm": ({"[length]": 1}, 0.001, False),
    "um": ({"[length]": 1}, 1e-06, False),
    "N": ({"[mass]": 1, "[length]": 1, "[time]": -2}, 1.0, False),
    "kN": ({"[mass]": 1, "[length]": 1, "[time]": -2}, 1000.0, False),
    "N*m": ({"[mass]": 1, "[length]": 2, "[time]": -2}, 1.0, False),
    "deg": ({}, 0.017453292519943295, True),
    "rad": ({}, 1.0, True),
    "rpm": ({"[time]": -1}, 0.10471975511965977, True),
    "Hz": ({"[time]": -1}, 1.0, False),
    "m/s": ({"[length]": 1, "[time]": -1}, 1.0, False),
    "mm/s": ({"[length]": 1, "[time]": -1}, 0.001, False),
    "m/s^2": ({"[length]": 1, "[time]": -2}, 1.0, False),
    "g": ({"[length]": 1, "[time]": -2}, 9.80665, False),
    "V": ({"[mass]": 1, "[length]": 2, "[time]": -3, "[current]": -1}, 1.0, False),
    "W": ({"[mass]": 1, "[length]": 2, "[time]": -3}, 1.0, False),
    "kW": ({"[mass]": 1, "[length]": 2, "[time]": -3}, 1000.0, False),
    "Pa": ({"[mass]": 1, "[length]": -1, "[time]": -2}, 1.0, False),
    "m/N": ({"[mass]": -1, "[time]": 2}, 1.0, False),
    "um/N": ({"[mass]": -1, "[time]": 2}, 1e-06, False),
    "m/s/N": ({"[time]": 1, "[mass]": -1}, 1.0, False),
    "m/s^2/N": ({"[mass]": -1}, 1.0, False),
}
