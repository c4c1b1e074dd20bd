"""Tool, workpiece and cutting force; knows nothing of machines.

=============== ==================================================================
package         responsibility
=============== ==================================================================
tool            geometry of the cutter, edges cut into slices, as the kernels see them
engagement      entry and exit angles of the teeth
material        published cutting coefficients with their sources
force           force laws, directional coefficients, force spectrum
process_damping viscous form, ploughing into the surface behind the edge, contact
chip            regenerative delay: chip against earlier passes, or against a stock
dexel, voxel    stock and its carving
edge_segments   segments of edges in one coupling of the linear analysis
surface         wall and floor that the edges leave; roughness and waviness
=============== ==================================================================

`cubic_spline` goes through points. `keys` are the keys of laws in files, `leaves` and `compiled`
the presets of kernels.
"""
