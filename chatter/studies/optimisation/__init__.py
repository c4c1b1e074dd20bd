"""Process optimisation: removal rate within limits of spindle, deflection, surface and stability.

======================== ===========================================================
module                   responsibility
======================== ===========================================================
operating_point          speed, depths and feed, written into a case or a compiled model
limits                   ranges of a search, and how much of its limits a cut uses
element_size             how long the elements of collocation may be
stable_depths            all stable intervals of depth, and what margins leave of them
steady_cut               power, torque, deflection and location error of the stable cut
speed_depth_slice        all speeds and depths at one radial depth and feed
grid_search              coarse grid and refinement
sampled_cuts             a cut at every sample of the uncertain values
candidate                a cut that was found, and what it uses of every limit
robustness               candidates, with a wanted probability where values are uncertain
time_domain_verification candidates simulated, less deep where a limit is exceeded
search_state             the compiled case, its result cache and progress
exclusion                what each limit excludes, where nothing is found
process_optimisation     `optimum`: all of it, one after the other
optimum                  the result: tables, files
======================== ===========================================================
"""
