"""What `tippedisk completion` does."""

import argparse

from validation.parser.completion import script


def completion(options: argparse.Namespace) -> int:
    """Print the script for a shell."""
    print(script(options.shell), end="")
    return 0
