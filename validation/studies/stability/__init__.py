"""Linear stability of spinning upright."""
