"""Periodic motions, their end, the slow manifold and slow passage, on both sides."""
