"""What the paper says, each statement with a criterion, a measured number and a verdict."""
