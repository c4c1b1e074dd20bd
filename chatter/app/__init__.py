"""The stability lobe diagram as a page in the browser, following sliders.

========== =======================================================================
module     responsibility
========== =======================================================================
parameters sliders: paths of the case with units and ranges; what a page may set
followed   limits for a moving slider
answers    diagrams, simulated points and cases for values of the sliders
latest     the newest request wins: older computations are given up
server     HTTP on the loopback interface alone
page       HTML, style and script of the page
========== =======================================================================
"""
