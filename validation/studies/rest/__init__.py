"""The way to rest."""
