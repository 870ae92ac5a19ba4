"""Linear stability: checks, tables and figures of the report."""
