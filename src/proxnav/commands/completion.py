"""`proxnav completion`: a script that completes commands, options and choices in bash, zsh or fish."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Literal

import tyro

from proxnav.cli.commands import COMMANDS
from proxnav.cli.help_pages import FULL, captured
from proxnav.errors import InputError

Words = dict[str, list[str]]
"""What may follow: by 'render' or 'train heatmap' the options, by 'render --renderer' the values."""

_NESTED = ("train", "benchmark", "target")


@dataclass(frozen=True)
class CompletionConfig:
    """Prints a completion script; it takes some seconds, so keep it in a file that the shell reads at its start.

    bash: proxnav completion bash > ~/.local/share/bash-completion/completions/proxnav
    """

    shell: Annotated[Literal["bash", "zsh", "fish"], tyro.conf.Positional]
    """Whose script."""


def main(argv: list[str]) -> None:
    """Entry of `proxnav completion`."""
    config = tyro.cli(CompletionConfig, args=argv, prog="proxnav completion")
    words = collected()
    print({"bash": bash, "zsh": zsh, "fish": fish}[config.shell](words))


def collected() -> Words:
    """Every command's words, read from its help."""
    words: Words = {"": [*COMMANDS, "--help", "--version"]}
    for command in COMMANDS:
        below = _below(command)
        if below:
            words[command] = below
        for name in [f"{command} {word}" for word in below] or [command]:
            words |= _options(name, _help(name))
    return words


def _below(command: str) -> list[str]:
    if command not in _NESTED:
        return []
    module = import_module(f"proxnav.commands.{command}")
    return {"train": lambda: [*module.NETWORKS], "benchmark": lambda: [*module.BENCHMARKS]}.get(
        command, lambda: ["show", "new"]
    )()


def _help(name: str) -> str:
    """The full help of 'render' or 'train heatmap'; empty where the command cannot run here (train without torch)."""
    command, *rest = name.split()
    try:
        return captured(import_module(f"proxnav.commands.{command}").main, rest)
    except InputError:
        return ""


def _options(name: str, page: str) -> Words:
    found: Words = {name: [FULL]}
    for line in page.splitlines():
        for option in re.findall(r"(?<![\w-])--[a-z][\w.-]*", line) if line.startswith(("│ -", "  -")) else ():
            found[name].append(option)
            choices = re.search(re.escape(option) + r" \{([^{}]*)\}", line)
            if choices:
                found[f"{name} {option}"] = [word for word in choices[1].split(",") if word != "None"]
    return found


def bash(words: Words) -> str:
    """Values after an option with choices, else options and words below the command, else files."""
    cases = "\n".join(f'    "{name}") words="{" ".join(follow)}" ;;' for name, follow in words.items())
    return f"""# proxnav completion for bash
_proxnav() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" previous="${{COMP_WORDS[COMP_CWORD-1]}}" name="" words=""
  (( COMP_CWORD > 1 )) && name="${{COMP_WORDS[1]}}"
  case "$name" in {"|".join(_NESTED)}) (( COMP_CWORD > 2 )) && name="$name ${{COMP_WORDS[2]}}" ;; esac
  local key
  for key in "$name $previous" "$name"; do
    case "$key" in
{cases}
    esac
    [[ -n "$words" ]] && break
  done
  COMPREPLY=( $(compgen -W "$words" -- "$current") )
}}
complete -o default -F _proxnav proxnav"""


def zsh(words: Words) -> str:
    """The bash script under zsh's own emulation."""
    return "autoload -U +X compinit && compinit -u\nautoload -U +X bashcompinit && bashcompinit\n" + bash(words)


def fish(words: Words) -> str:
    """One line for each word."""
    return "\n".join(["# proxnav completion for fish", *_fish_lines(words)])


def _fish_lines(words: Words) -> Iterator[str]:
    yield f"complete -c proxnav -n __fish_use_subcommand -f -a '{' '.join(words[''])}'"
    for name, follow in words.items():
        command, *rest = name.split() or [""]
        if not command or any(word.startswith("--") for word in rest):
            continue
        seen = " && ".join(f"__fish_seen_subcommand_from {word}" for word in (command, *rest))
        for word in follow:
            if not word.startswith("--"):
                yield f"complete -c proxnav -n '{seen}' -f -a {word}"
                continue
            values = words.get(f"{name} {word}")
            yield f"complete -c proxnav -n '{seen}' -l {word[2:]}" + (f" -x -a '{' '.join(values)}'" if values else "")
