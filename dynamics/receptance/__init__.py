"""Receptances of components: coupled and taken apart (`coupling`: RCSA, Schmitz and Duncan 2005)."""
