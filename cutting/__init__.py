"""Tool, workpiece and cutting force; knows nothing of machines.

=============== ==================================================================
module          responsibility
=============== ==================================================================
engagement      entry and exit angles of the teeth, cutting speed
force_law       force per edge length as a function of chip thickness, its slope
material_table  published cutting coefficients with their sources
directional     change of the force with the motion of the tool, averaged in angle
process_damping viscous form of the ploughing force
=============== ==================================================================
"""
