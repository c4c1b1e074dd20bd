"""The operator's sheet: cuts worth making, with limits and margins, on paper and as a workbook.

========== ================================================================================
module     responsibility
========== ================================================================================
cuts       rows of a sheet: the cut as stated, pockets, the depth that any speed allows
variation  spindle-speed variation, where it raises the limit of the stated cut
sheet      `sheet`: rows of several cases, and what is written of them
workbook   XLSX of a sheet
========== ================================================================================
"""
