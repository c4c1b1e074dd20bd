"""Receptances of components, coupled and taken apart: RCSA (Schmitz and Duncan 2005)."""
