"""The mechanics of the disk, written once for numbers of any kind."""
