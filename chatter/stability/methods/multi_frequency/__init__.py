"""Multi-frequency solution: Fourier coefficients (harmonics), determinant, limits."""
