"""Comfort in a shell: help on one screen, completion, no colour in a pipe, exit codes."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from proxnav.cli.commands import every_command
from proxnav.cli.main import main
from proxnav.cli.parser import config_of, every_option, function_of

SCREEN = 50  # lines of a terminal of 100 columns at its usual height, full screen


@pytest.mark.slow
@pytest.mark.parametrize("command", [*every_command()])
def test_help_fits_a_screen_and_shows_defaults(command: str, capsys, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    assert main([*command.split(), "--help"]) == 0
    text = capsys.readouterr().out
    assert len(text.splitlines()) <= SCREEN
    assert "(default: " in text or command in ("setup", "completion")


def test_nested_groups_are_named_and_shown_on_request(capsys, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    main(["render", "--help"])
    short = capsys.readouterr().out
    assert re.search(r"--reader\.\* \(\d+\)", short)
    assert "--reader.epoch-utc" not in short
    main(["render", "--help-all"])
    assert "--reader.epoch-utc" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("name", [*every_command()])
def test_completion_offers_what_the_full_help_explains(name: str, capsys, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    assert main([*name.split(), "--help-all"]) == 0
    lines = capsys.readouterr().out.splitlines()
    explained = {
        flag for line in lines for flag in re.findall(r"--[a-z][\w.-]*", line) if re.match(r"[│ ] (-h, )?--", line)
    }
    options = every_option(config_of(function_of(every_command()[name])))
    offered = {flag for option in options for flag in option.flags}
    assert offered | {"--help"} == explained


@pytest.mark.parametrize("variable", [None, "NO_COLOR"])
def test_nothing_is_coloured_in_a_pipe(variable: str | None, monkeypatch) -> None:
    if variable:
        monkeypatch.setenv(variable, "1")
    code = "from proxnav.cli.main import main; raise SystemExit(main({}))"
    for words in (["--help"], ["report", "--help"], ["report", "--nonsense"], ["report", "/no/such/run"]):
        done = subprocess.run([sys.executable, "-c", code.format(words)], capture_output=True, text=True, check=False)
        assert "\x1b" not in done.stdout + done.stderr
        expected = {"--help": 0, "--nonsense": 2, "/no/such/run": 1}[words[-1]]
        assert done.returncode == expected


@pytest.fixture(scope="module")
def script(tmp_path_factory: pytest.TempPathFactory) -> str:
    """File with the completion for bash."""
    path = tmp_path_factory.mktemp("completion") / "proxnav.bash"
    done = subprocess.run(
        [sys.executable, "-c", "from proxnav.cli.main import main; main(['completion', 'bash'])"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    path.write_text(done.stdout)
    return str(path)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash on the PATH")
@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("proxnav rend", {"render"}),
        ("proxnav target ", {"show", "new"}),
        ("proxnav render --renderer ", {"cycles", "raycast"}),
        ("proxnav view --sa", {"--save"}),
        ("proxnav benchmark table1 --see", {"--seed"}),
    ],
)
def test_bash_completes(script: str, line: str, offered: set[str]) -> None:
    words = line.split(" ")
    quoted = " ".join(f"'{word}'" for word in words)
    code = f"source {script}; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _proxnav; echo ${{COMPREPLY[@]}}"
    done = subprocess.run(["bash", "-c", code], capture_output=True, text=True, check=True)
    assert set(done.stdout.split()) == offered


@pytest.mark.slow
def test_fish_lines_name_every_command_and_choice() -> None:
    from proxnav.cli.completion import fish

    words = {
        "": ["view"],
        "view": ["--save"],
        "train": ["heatmap"],
        "train heatmap": ["--p"],
        "train heatmap --p": ["a"],
    }
    text = fish(words)
    assert "-a 'view'" in text
    assert "-l save" in text
    assert re.search(r"from train && __fish_seen_subcommand_from heatmap' -l p -x -a 'a'", text)


def test_two_words_for_the_mission_are_one_too_many(capsys) -> None:
    assert main(["render", "--mission", "study", "--preset", "spiral-10-100m", "--out", "nowhere"]) == 1
    assert "give one of them" in capsys.readouterr().err
    assert not Path("nowhere").exists()
