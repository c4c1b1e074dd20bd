"""Matrix free."""
