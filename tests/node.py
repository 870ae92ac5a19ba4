"""The code of a page, run in Node."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

HARNESSES = Path(__file__).parent / "validation/kit"

needs_node = pytest.mark.skipif(shutil.which("node") is None, reason="needs Node")


def in_node(harness: str, page: str, *words: str) -> Any:
    """What the code of a page makes of some words."""
    call = ["node", str(HARNESSES / harness), "/dev/stdin", *words]
    done = subprocess.run(call, input=page, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)
