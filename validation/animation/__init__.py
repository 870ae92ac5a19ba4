"""Animations of any motion."""
