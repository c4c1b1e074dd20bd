"""The workbench in the browser, on Panel with Bokeh (extra `app`).

============== =====================================================================
module         responsibility
============== =====================================================================
server         Panel's server on the loopback interface, behind a random token
page           the page of a session: case files of the folder, its views
stability_view diagram that follows sliders, simulated points
computations   one computation a session at a time, in a thread of its own
============== =====================================================================
"""
