"""Material data: published cutting coefficients (`table`), orthogonal cutting data (`oblique`)."""
