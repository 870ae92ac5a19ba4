"""How much may be asked for: beyond these limits a call is refused before it computes anything."""

LARGEST_STORAGE = 2_000_000_000
"""Bytes that the samples of a motion may take, in memory or in a file."""

MOST_SPINS = 100_000
"""Spins for which eigenvalues may be asked for at once."""

WIDEST_PICTURE = 2000
"""Width and height of an animated picture in pixels."""

MOST_KEYFRAMES = 1_000_000
"""Poses of an animation."""

LARGEST_VALUE = 1e100
"""Size of any sampled number; the squares of larger ones overflow."""
