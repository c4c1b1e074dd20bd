"""What a new user needs first: a case from a few answers, and the state of the installation.

=============== ==========================================================================
module          responsibility
=============== ==========================================================================
first_case      text of a case file from five answers
installation    versions, cores, threads, compiled code, formats that can be read
self_check      three answers against what is known otherwise
compile_kernels every kind of computation once, so that its compiled code is on the disk
=============== ==========================================================================
"""
