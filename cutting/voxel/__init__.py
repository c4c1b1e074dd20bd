"""Voxel."""
