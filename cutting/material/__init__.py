"""Material data: published cutting coefficients.

========================== =====================================================================
module                     responsibility
========================== =====================================================================
grades                     designations of one grade in several standards
row                        what a row of the table holds
coefficients_of_tests      rows of the linear law, identified in cutting tests
specific_cutting_force     rows of the exponential law (Kienzle), by material group of VDI 3323
table                      all rows by name; search
========================== =====================================================================
"""
