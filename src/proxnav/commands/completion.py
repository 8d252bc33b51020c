"""`proxnav completion`: a script that completes commands, options and choices in bash, zsh or fish."""

from dataclasses import dataclass
from typing import Annotated, Literal

import tyro


@dataclass(frozen=True)
class CompletionConfig:
    """Prints a completion script; keep it in a file that the shell reads at its start.

    bash: proxnav completion bash > ~/.local/share/bash-completion/completions/proxnav
    """

    shell: Annotated[Literal["bash", "zsh", "fish"], tyro.conf.Positional]
    """Whose script."""


def run(config: CompletionConfig) -> None:
    """Prints the script."""
    from proxnav.cli.completion import bash, every_word, fish, zsh

    print({"bash": bash, "zsh": zsh, "fish": fish}[config.shell](every_word()))
