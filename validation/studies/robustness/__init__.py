"""Stiff and extreme cases."""
