"""The machine: structure, drives, friction, control, frequency responses; knows nothing of cutting.

============== =====================================================================
package        responsibility
============== =====================================================================
structure      parts assembled to mass, damping and stiffness with named points
beam           shafts of Timoshenko elements, discs, bearings
reduction      modal truncation with residual compliance, Craig-Bampton
receptance     coupling and decoupling of tool, holder and spindle receptances
modal          modal model at named points, exact discrete step, mode tracking
frf            container of frequency response functions; excitation; hammer tests
identification modal parameters from measured FRFs
friction       friction laws, their implicit solution, their identification
drive          ball screws, belts, racks, linear motors, rotary drives
control        sampled cascade of position, velocity and current; filters, dead times
trajectory     jerk-limited moves, paths with fillets, set points, contour error
machine        all of it together, stepped in time or linearised
============== =====================================================================

`least_squares` is the nonlinear least squares of modal fits, `compiled` the presets of kernels.
"""
