"""Changing the text of a scenario's file."""

import re


def with_key(text: str, table: str, key: str, literal: str | None) -> str:
    """The text with another value of a key, or with a further key."""
    lines = text.split("\n")
    begin = lines.index(f"[{table}]") if table else 0
    own = range(begin + 1, len(lines))
    end = next((n for n in own if re.match(r"(# )?\[\w+\]$", lines[n])), len(lines))
    at = next((n for n in range(begin, end) if re.match(rf"{key} =", lines[n])), None)
    if at is not None:
        del lines[at]
    if literal is not None:
        lines.insert(begin + 1 if at is None else at, f"{key} = {literal}")
    return "\n".join(lines)
