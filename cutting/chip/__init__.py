"""Chip thickness: delayed (regenerative) motion of the tool, or read from a carved workpiece."""
