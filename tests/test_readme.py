"""The README's code runs as it stands."""

import re
from pathlib import Path

import pytest

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
# Prose, language and code of each fenced block in turn.
FENCED = re.findall(r"(.*?)```(\w*)\n(.*?)```", README, flags=re.DOTALL)
BLOCKS = {
    re.findall(r"\*\*([^*`]+)\*\*", prose)[-1]: code
    for prose, language, code in FENCED
    if language == "python"
}


def test_the_recipes_are_there() -> None:
    titles = ["disk", "friction law", "constraint set", "table", "Until the disk lies still"]
    assert list(BLOCKS) == titles
    assert README.count("```python") == len(titles)


@pytest.mark.parametrize("block", BLOCKS.values(), ids=BLOCKS.keys())
def test_recipe_runs_as_it_stands(block: str, capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(block, "README.md", "exec"), {"__name__": "recipe"})  # noqa: S102
    printed = capsys.readouterr().out
    assert ("print(" in block) == bool(printed)
    assert "nan" not in printed
