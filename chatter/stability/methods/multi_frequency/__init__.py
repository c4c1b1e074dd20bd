"""Multi frequency."""
