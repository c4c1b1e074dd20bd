"""Zeroth-order approximation: uniform pitch (kernels), distinct delays, limits of a model."""
