"""Linear systems, spectra and stability limits of the stationary motions."""
