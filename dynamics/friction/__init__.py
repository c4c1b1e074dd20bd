"""Friction of guides, screws and bearings along a port of the structure.

=============== ==================================================================
module          responsibility
=============== ==================================================================
implicit        force held over a step, solved together with the structure's response
lugre           LuGre: bristle with Stribeck curve
tanh_hysteresis presliding hysteresis with return-point memory, speed-dependent sliding
reversals       branches of a hysteresis and the reversals it remembers
coulomb_stribeck dry friction with true rest, Stribeck curve and viscous part
harmonic        equivalent stiffness and damping under harmonic motion
=============== ==================================================================

Each law has a specification (frozen dataclass, SI), a table for the kernels, and leaves
`..._step` (held force and motion, changes nothing), `..._advance` (moves the state). A force is
counted positive when it opposes positive motion.
"""
