"""Time domain."""
