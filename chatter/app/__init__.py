"""The stability lobe diagram as a page in the browser that follows sliders.

============== =====================================================================
module         responsibility
============== =====================================================================
sliders        paths of the case with units and ranges; check of the values that a page sends
live_case      diagrams, simulated points and case files for values of the sliders
newest_request the newest request wins: older computations are given up
server         HTTP on the loopback interface alone
page           HTML, style and script of the page
workbench      `chatter app`: the cases of a folder, on Panel with Bokeh (extra `app`)
============== =====================================================================
"""
