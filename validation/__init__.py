"""Cross-checks, studies, figures, report and command line."""
