"""Friction of guides, screws and bearings along a port of the structure.

================ =================================================================
module           responsibility
================ =================================================================
law              what a law is; laws: the list of them, one line each
implicit         force held over a step, solved together with the structure's response
lugre            LuGre: bristle with Stribeck curve
tanh_hysteresis  presliding hysteresis with return-point memory, speed-dependent sliding
reversals        branches of a hysteresis and the reversals it remembers
coulomb_stribeck dry friction with true rest, Stribeck curve and viscous part
smooth_coulomb   Coulomb friction that passes smoothly through zero
harmonic         equivalent stiffness and damping under harmonic motion
axis_force       force that moves an axis along a motion, its friction by these laws
identification   laws fitted to records of drives
================ =================================================================

Each law has a specification (frozen dataclass, SI), keys of files, a table for the kernels, and
leaves `..._step` (held force and motion, changes nothing), `..._advance` (moves the state). A force
is counted positive when it opposes positive motion. A law is added by its module, which ends in a
`FrictionLawEntry`, and by its line in `laws`.
"""
