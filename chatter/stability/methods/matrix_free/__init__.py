"""Matrix-free method: initial functions propagated over a period.

=================  =============================================================================
module             responsibility
=================  =============================================================================
stepped_cut        a cut with the contact of tool and work
steps              steps of a period, graded towards singular borders (Brunner 2004)
modal_response     exact response of the modes over a step
couplings          couplings of the edge at one time
step_assembly      all steps of a period
solution_operator  an initial function run through one period
drivers            compiled code that Python calls
multipliers        multipliers, limits and their error
=================  =============================================================================
"""
