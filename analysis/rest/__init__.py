"""The way to rest: the free disk on a compliant table, and what is known of its end."""
