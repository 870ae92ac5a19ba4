"""What a person is shown: tables, figures, and how far long work is."""
