"""Tool, workpiece and cutting force; knows nothing of machines.

=============== ==================================================================
module          responsibility
=============== ==================================================================
tool            geometry of the tool, edges cut into slices
engagement      entry and exit angles of the teeth, cutting speed
force           force laws, directional coefficients, force spectrum
material        published cutting coefficients with their sources
edges           edge slices as the kernels see them; force of an edge on the tool
tool_point      where the cut meets the machine
delayed_chip    chip against the motion of the last turn
regeneration    sets the delayed chip up
discrete_chip   chip of a carved workpiece
dexel, voxel    carving and chip thickness; `_stock`: layout, shaping, measurement
process_damping viscous form of the ploughing force
ploughing       force of the flank pressed into the wave behind the edge
flank           the forms of it behind one call
contact         spring and damper of tool and work in the cut
surface         wall and floor that passes of the edges leave
texture         roughness, waviness and location error of profiles
=============== ==================================================================
"""
