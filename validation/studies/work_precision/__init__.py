"""Error against run time of formulations and integrators."""
