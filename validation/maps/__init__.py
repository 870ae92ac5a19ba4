"""Maps of what becomes of the disk over two parameters, refined where it changes."""
