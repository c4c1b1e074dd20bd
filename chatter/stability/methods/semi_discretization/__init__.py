"""Semi discretization."""
