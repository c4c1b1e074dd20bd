"""One module for each pair of ways to a number."""
