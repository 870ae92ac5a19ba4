"""The way to rest: checks, tables and figures of the report."""
