"""The case that most tests start from: the tool of Insperger and Stepan (2004)."""

import tomlkit

from chatter.description.case import Case

#: two teeth, one mode of 922 Hz along the feed, half-immersion down-milling
TOOL_OF_922_HERTZ = """\
title = "922 Hz"

[tool]
teeth = 2
diameter = "16 mm"

[material]
Ktc = "600 MPa"
Krc = "200 MPa"

[cut]
mode = "down"
spindle_speed = "10000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "8 mm"

[[structure.mode]]
frequency = "922 Hz"
damping = 0.011
mass = "0.03993 kg"
direction = [1, 0, 0]
"""


def tool_of_922_hertz(directions=((1, 0, 0),), **sections) -> Case:
    """Case with the mode along each direction; keys of sections replace or join those above."""
    document = tomlkit.parse(TOOL_OF_922_HERTZ).unwrap()
    (mode,) = document["structure"]["mode"]
    document["structure"]["mode"] = [{**mode, "direction": list(each)} for each in directions]
    for name, keys in sections.items():
        document[name] = {**document.get(name, {}), **keys}
    return Case.from_dict(document)
