"""Figures that were asked for, each measured beside its bound and a peer in one run."""
