"""The machine: structure, modes, frequency responses; knows nothing of cutting.

============== =====================================================================
module         responsibility
============== =====================================================================
frf            container of frequency response functions, conversion of quantities
formats        UFF-58, CSV and CutPro files into the container
hammer         hammer time records: reading, examination, H1/H2 with coherence
modal          real modes at the tool point and their receptance
modal_steps    exact discrete step of a modal model, energy
identification modal parameters from measured FRFs
structure      mass, damping and stiffness with named points: where all mechanics ends
bodies         rigid bodies, connectors and points into a structure
beam           shafts of Timoshenko elements (`beam_element`), discs, bearings
imported       M, C, K from files (`matrix_file`), points tied to surfaces (`constraint`)
reduction      modal truncation with residual compliance, state space
craig_bampton  super-elements, joined at points
receptance     coupling and decoupling of tool, holder and spindle receptances
mode_tracking  modes followed and interpolated between axis positions
free_motion    parts that nothing holds
friction       LuGre, tanh hysteresis, Coulomb-Stribeck; implicit steps
control        sampled cascade: position, velocity, current; filters, dead times
trajectory     jerk-limited moves, paths with fillets, set points, contour error
============== =====================================================================
"""
