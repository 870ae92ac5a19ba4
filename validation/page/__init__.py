"""The report's pages: from studies' rows, templates and figures to HTML that needs no network."""
