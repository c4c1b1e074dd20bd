"""Collocation on elements.

==================  ============================================================================
module              responsibility
==================  ============================================================================
element_cut         a cut laid out for elements of a resolution
element_borders     where the cut asks for borders of elements
element_layout      elements of a period, also at a varying speed
element_response    exact response of a mode over an element, as a Chebyshev series
coupling_assembly   couplings at the points of all elements, to now and to earlier motion
edge_couplings      the same at one point of a period; tool_period_couplings
coupling_structure  assemblies packed by structure and numbers
element_assembly    matrices of the monodromy operator of a SIMD batch
monodromy           the operator: state and earlier motion over one period
batch_multipliers   dominant multipliers of a batch by Arnoldi iteration
chatter_frequency   chatter frequencies of a batch
drivers             compiled loops that Python calls; first_use compiles them side by side
multipliers         multipliers and limits of a cut at one resolution
converged_limits    finer elements until limits are good to a tolerance; finer_limits
varying_limits      the same under a varying speed; varying_speed, secant_limits
==================  ============================================================================
"""
