"""The time loop: law groups on the ports of a structure, compiled.

============== ======================================================================
module         responsibility
============== ======================================================================
bus            what a step of time offers to every law: ports and clock
cut            the cut as a law on ports: tool point, path, spindle
record         what is kept of a run, as laws without force
dispatch       list of the laws, their two phases `forces` and `commit`
loop           the one loop: predict, correct, solve frictions, commit
loop_stability stability of the control loops of a machine, by the same loop
presets        decorator presets, folder of the compiled code
compiled_once  inner functions compiled as parts of their drivers alone
loaded_kernels compiled code taken from the disk without the compiler
interruption   Ctrl-C while compiled code, or what calls Python from C, runs
parallel       sweeps over points in threads, executor interface
============== ======================================================================
"""
