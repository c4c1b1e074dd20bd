"""Force."""
