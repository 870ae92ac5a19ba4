"""Data types of the study: what both sides share, without any mechanics."""
