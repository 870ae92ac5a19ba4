"""Equations of motion of all models, and their simulation."""
