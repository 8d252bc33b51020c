"""Completion scripts for bash, zsh and fish, from the words that each command takes."""

from collections.abc import Iterator
from contextlib import suppress

from proxnav.cli.commands import COMMANDS, Group, every_command
from proxnav.cli.help_pages import FULL
from proxnav.cli.parser import config_of, every_option, function_of

Words = dict[str, list[str]]
"""What may follow: by 'render' or 'train heatmap' the options, by 'render --renderer' the values."""

_GROUPS = [name for name, entry in COMMANDS.items() if isinstance(entry, Group)]


def every_word() -> Words:
    """The words of every command that can run here: training cannot without torch."""
    words: Words = {"": [*COMMANDS, "--help", "--version"]}
    words |= {name: [*entry.commands] for name, entry in COMMANDS.items() if isinstance(entry, Group)}
    for name, command in every_command().items():
        words[name] = [FULL, "--help"]
        with suppress(ModuleNotFoundError):
            for option in every_option(config_of(function_of(command))):
                words[name] += option.flags
                if option.values:
                    words[f"{name} {option.flags[0]}"] = [*option.values]
    return words


def bash(words: Words) -> str:
    """Values after an option with choices, else options and words below the command, else files."""
    cases = "\n".join(f'    "{name}") words="{" ".join(follow)}" ;;' for name, follow in words.items())
    return f"""# proxnav completion for bash
_proxnav() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" previous="${{COMP_WORDS[COMP_CWORD-1]}}" name="" words=""
  (( COMP_CWORD > 1 )) && name="${{COMP_WORDS[1]}}"
  case "$name" in {"|".join(_GROUPS)}) (( COMP_CWORD > 2 )) && name="$name ${{COMP_WORDS[2]}}" ;; esac
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
