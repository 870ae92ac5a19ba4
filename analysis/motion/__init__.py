"""What comes out: motions of either side, their quantities, endings, outcomes and files."""
