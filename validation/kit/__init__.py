"""What every study uses: tables, figures, pages, animations, processes."""
