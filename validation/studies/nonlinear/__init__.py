"""Nonlinear dynamics of spinning upright."""
