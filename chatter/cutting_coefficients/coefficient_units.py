"""Units of coefficients as they are written."""

#: by the last letter of a key: unit in [material], and what makes it of SI
UNITS = {"c": ("MPa", 1e-6), "e": ("N/mm", 1e-3)}
