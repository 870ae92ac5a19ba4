"""Periodic motions of the reduced system and where they begin and end."""
