"""Tables and figures of nonlinear dynamics, for commands and studies alike."""
