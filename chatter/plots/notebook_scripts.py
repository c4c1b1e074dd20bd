"""Scripts that pictures and widgets need in a notebook, loaded from disk once."""

from __future__ import annotations


def load_notebook_scripts() -> None:
    """Load the scripts of Panel and Bokeh into the notebook, where that is not done yet.

    A workshop may have no network, so that they come with a cell. Loaded again, they would take
    the pictures that are being drawn away.
    """
    import panel

    if not panel.extension._loaded:
        panel.extension(inline=True)
