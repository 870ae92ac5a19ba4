"""Many runs: what varies, what is kept, where it is stored and who computes."""
