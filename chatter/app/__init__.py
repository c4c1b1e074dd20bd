"""The workbench in the browser, and the diagram that follows sliders.

============== =====================================================================
module         responsibility
============== =====================================================================
sliders        paths of the case with units and ranges; check of the values given
live_case      diagrams and simulated points for values of the sliders
workbench      the page, on Panel with Bokeh (extra `app`): a module a view
============== =====================================================================
"""
