"""How far motions are from each other, and what they are compared with."""
