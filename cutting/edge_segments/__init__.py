"""Edge segments."""
