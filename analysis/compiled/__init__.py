"""Compiled runs with Taylor's method, by heyoka (extra `fast`), of the equations in `models`."""
