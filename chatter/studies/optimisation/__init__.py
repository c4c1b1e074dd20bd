"""The best cut: removal rate within limits of spindle, deflection, surface and stability.

================== ===================================================================
module             responsibility
================== ===================================================================
steady_cut         power, torque, deflection and location error of the stable cut
stable_depths      all stable stretches of depth, and what margins leave of them
width_and_feed     a case and a model at another radial depth and feed
resolution         how coarse the elements of collocation may be
limits             what a cut may use, and how much of it a cut uses
sheet              all speeds and depths at one width and feed
search             coarse net and refinement
sampled_cuts       a cut at every sample of what is uncertain
robustness         the best cut around a place that holds with a wanted probability
confirmation       candidates simulated in the time domain
kept_search        what all pieces of a search share: pieces on disk, progress
candidates         candidates in round numbers, robust where something is uncertain
held_in_time       candidates confirmed side by side, less deep where a limit is missed
study              `optimum`: all of it, one after the other
records            pieces of a search on disk
result             what is found: tables, files
================== ===================================================================
"""
