"""Feed drives: what turns a motor's torque into force on an axis, and what gives way in between.

=============== ====================================================================
module          responsibility
=============== ====================================================================
parts           where an axis is driven, and a drive as rotors, springs and motors
gear_train      rotors in a row tied by springs, all scaled to travel of the axis
belt            toothed belt with its pulleys
screw_shaft     axial and torsional stiffness of a screw where the nut is
ball_screw      ball screw as a rotor, with bearings, shaft and nut in a row
screw_on_beam   ball screw as a beam, with the stiffness between screw and nut
rack_and_pinion rack and pinion with gearboxes, several motors, preload
backlash        spring and damper of a nut or pinion that act beyond a gap only
linear_motor    linear motors, single or sharing a force
rotary          spindles and rotary tables
=============== ====================================================================

Each drive is a specification whose `parts(axis)` are joined with the machine by
`dynamics.structure.assembly.assembly`; the motors' angles become rows that torques act along.
Each axis keeps one free motion, which its controller or brake holds. `dynamics.control` has the
controllers and how torque follows current.
"""
