"""What the paper says of the motion, and whether it holds."""
