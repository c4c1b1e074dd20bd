"""Questions asked of many cases: what-if, uncertainty, optimisation, pitch design, bifurcation."""
