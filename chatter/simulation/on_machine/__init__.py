"""Machine and cut together: the tool moves as the machine lets it, the machine feels the cut.

============ =======================================================================
module       responsibility
============ =======================================================================
machine_cut  a case on a machine: who moves, where the cut acts
setup        both compiled for one loop
engine       the compiled loop
simulate     `simulate` of a case whose structure is a machine; its result
============ =======================================================================
"""
