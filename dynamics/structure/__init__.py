"""Parts of a machine assembled to mass, damping and stiffness, with named points.

================== ==================================================================
module             responsibility
================== ==================================================================
linear_structure   the assembled matrices and what points feel of them
assembly           bodies, beams, rotors and imported parts joined into one structure
bodies             rigid bodies, connectors, points
rotor              turning of a motor, a screw or a pinion
spring_coupling    springs along a combination of motions: nuts, belts, gears
rigid_body_motion  motions of parts that nothing holds
imported           structures given by matrices; the check of a mass matrix
solid_elements     boxes of 20-node hexahedra to matrices, by scikit-fem
surface_constraint points tied to the surfaces of a finite element model
================== ==================================================================
"""
