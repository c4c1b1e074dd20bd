"""Commands draw the same pictures with a matplotlib that has no documentation of its own."""

import json
import subprocess
import sys

DRAW = """
import hashlib, json
import numpy as np
from chatter.plots.style import new_figure, png_of, finish
from matplotlib.lines import Line2D
figure = new_figure(3.0, 2.0)
axes = figure.subplots()
(line,) = axes.plot([0.0, 1.0], [1.0, 3.0], label="force")
line.set(lw=2.0, color="red")
axes.set(xlabel="x", ylabel="y")
axes.legend()
finish(axes)
class Own(Line2D):
    def set_force(self, force):
        self.force = force
own = Own([0.0], [0.0])
own.set(force=3.0)
documented = "linewidth" in (Line2D.set.__doc__ or "")
print(json.dumps([hashlib.sha256(png_of(figure)).hexdigest(), own.force, documented]))
"""


def drawn(first):
    done = subprocess.run(
        [sys.executable, "-c", first + DRAW], capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


def test_pictures_are_the_same_without_documentation():
    quick = "from chatter.cli.quick_pictures import leave_documentation_out as o; o(); o()\n"
    with_it, without = drawn(""), drawn(quick)
    assert with_it[:2] == without[:2] == [with_it[0], 3.0]
    assert with_it[2]
    assert not without[2]


def test_what_is_misspelt_is_still_refused():
    code = """
from chatter.cli.quick_pictures import leave_documentation_out
leave_documentation_out()
from matplotlib.lines import Line2D
Line2D([0.0], [0.0]).set(colr="red")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 1
    assert "colr" in done.stderr.splitlines()[-1]
