"""Pictures of results; matplotlib is imported here and nowhere else."""
