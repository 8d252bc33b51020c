"""Inner loops of the filter, compiled."""
