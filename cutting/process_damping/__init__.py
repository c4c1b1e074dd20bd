"""Process damping."""
