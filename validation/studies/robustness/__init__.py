"""Numerical stability on stiff and extreme cases."""
