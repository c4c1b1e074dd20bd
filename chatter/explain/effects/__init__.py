"""Effects that a model may lack, each a patch of the case.

================ ====================================================================
module           effects
================ ====================================================================
effect           `Effect`: name, label, help, patch, parameters, where it applies
tool             runout, pitch, wear
cutting_force    edge force, chip exponent, process damping
dynamometer      resonances of the force sensor
missing_mode     missing mode
resembling_modes where the residual of motions or FRFs proposes a mode
structure        mode shift, contact, slide friction
machine          joints, gains and frictions of a machine that are not as declared
machine_friction friction of an axis of a machine
axis             friction of a feed axis in its forms; offset, cogging
backlash         backlash of a feed axis, and of a drive of a machine
effect_list      the list: where a new effect joins
================ ====================================================================
"""
