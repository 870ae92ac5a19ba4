"""The studies: each compares, measures and draws one part of the report."""
