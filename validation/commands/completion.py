"""What `tippedisk completion` does: what the parsers know, as a script for a shell."""

from argparse import Action
from collections.abc import Iterator
from shlex import quote
from typing import Annotated, Literal

from analysis.problem.quantities import QUANTITIES
from validation.parser.commands import commands

_BASH = """\
_tippedisk() {{
    local words=""
    case "$COMP_CWORD:${{COMP_WORDS[1]}}:${{COMP_WORDS[COMP_CWORD-1]}}" in
        1:*) words="{commands}" ;;
{cases}
    esac
    COMPREPLY=($(compgen -W "$words" -- "${{COMP_WORDS[COMP_CWORD]}}"))
}}
complete -o default -F _tippedisk tippedisk
"""
"""Where there are no words to offer, the shell offers files."""

_ZSH = "autoload -U +X compinit bashcompinit && compinit && bashcompinit\n"


def completion(shell: Annotated[Literal["bash", "zsh", "fish"], {"metavar": "SHELL"}]) -> None:
    """Completion of commands, options and their values in a shell.

    Print a script that teaches it the command line:
      bash, zsh   source <(tippedisk completion bash), or zsh
      fish        tippedisk completion fish | source
    It stays if the line stands in ~/.bashrc, ~/.zshrc or ~/.config/fish/config.fish.
    """
    if shell == "fish":
        for line in _fish():
            print(f"complete -c tippedisk {line}")
        return
    names, cases = " ".join(each.name for each in commands()), "\n".join(_bash())
    script = _BASH.format(commands=names, cases=cases)
    print(_ZSH + script if shell == "zsh" else script, end="")


def _values(action: Action) -> str:
    """Words to offer; some options take others than these, too."""
    quantity = QUANTITIES.get(action.dest)
    return " ".join(map(str, action.choices or (quantity.choices if quantity else ())))


def _bash() -> Iterator[str]:
    """Words behind an option that takes a value, and anywhere else, by command."""
    for command in commands():
        words: list[str] = []
        for action in command.parser().actions:
            words += action.option_strings or [_values(action)]
            if action.option_strings and action.nargs != 0:
                places = "|".join(f"*:{command.name}:{each}" for each in action.option_strings)
                yield f'        {places}) words="{_values(action)}" ;;'
        yield f'        *:{command.name}:*) words="{" ".join(words)}" ;;'


def _fish() -> Iterator[str]:
    for command in commands():
        yield f"-n __fish_use_subcommand -fa {command.name} -d {quote(command.title)}"
        for action in command.parser().actions:
            names = "".join(f" -l {each[2:]}" for each in action.option_strings if each[1] == "-")
            offered = _values(action)
            values = f" -xa {quote(offered)}" if offered else " -r"
            what = values if action.nargs != 0 and (names or offered) else ""
            meaning = quote((action.help or "").replace("%%", "%"))
            where = f"__fish_seen_subcommand_from {command.name}"
            if names or what:
                yield f"-n '{where}'{names}{what} -d {meaning}"
