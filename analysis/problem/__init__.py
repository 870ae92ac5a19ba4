"""What is studied: bodies, friction, constraints, contact, start, and the scenario of them all."""
