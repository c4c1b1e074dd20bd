"""Every two ways to the same number, put against each other over cases drawn at random.

``python -m benchmarks.contradictions OUT`` draws cases over what users have and writes what
disagrees beyond what both ways state, each with its case file. It runs at length before a release;
a small share of it is a test.

================== =======================================================================
module             responsibility
================== =======================================================================
confrontation      what a confrontation is; comparisons of two numbers
confrontation_list all of them, one line each
confrontations     one module for each pair of ways
drawing            random sections of case files
edge_quadrature    forces of a rigid tool from the definitions, without the packages
trochoid_cut       the same along the true paths of the edges
numbers            numbers of a case by the product
one_case           a drawn case, judged
workers            processes with a time limit for each case
hunt               running, keeping and writing: results, findings, the table
================== =======================================================================
"""
