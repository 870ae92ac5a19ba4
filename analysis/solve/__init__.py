"""Initial value problems solved step by step: no mechanics, so that both sides share it."""
