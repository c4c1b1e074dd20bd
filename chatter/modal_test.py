"""Modal test: measured FRFs or hammer records to modal parameters at the tool point."""
