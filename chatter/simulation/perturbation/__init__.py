"""Runs beside a simulated cut: whether a small perturbation of its motion grows.

================ ====================================================================
module           responsibility
================ ====================================================================
followed_run     run followed revolution by revolution, through a force ramp
perturbed_runs   a cut with a perturbed run and one from rest beside it
lyapunov_record  largest Lyapunov exponent of them (Benettin et al. 1980)
lyapunov_verdict verdict by it, without a period
multiplier       multiplier over a period (dynamic mode decomposition, Schmid 2010)
================ ====================================================================
"""
