"""What every study uses: tables, figures, processes."""
