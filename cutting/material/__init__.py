"""Material data: published cutting coefficients (`table`)."""
