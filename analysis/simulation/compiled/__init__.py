"""Compiled runs of the in-house equations with Taylor's method, by heyoka (extra `fast`)."""
