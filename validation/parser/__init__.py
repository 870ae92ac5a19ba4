"""Parser of the command line; it loads neither NumPy nor the engine."""
