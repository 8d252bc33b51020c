"""Slips of the keyboard are met with the word that was meant."""

import pytest

from proxnav.cli.main import main


def said(argv: list[str], status: int, capsys: pytest.CaptureFixture) -> str:
    """What a command line that fails prints on stderr."""
    try:
        found = main(argv)
    except SystemExit as stop:
        found = stop.code
    assert found == status
    return capsys.readouterr().err


@pytest.mark.parametrize(
    ("argv", "status", "meant"),
    [
        (["evalute", "a", "b"], 2, "did you mean 'evaluate'?"),
        (["rendr"], 2, "did you mean 'render'?"),
        (["train", "heatmpa"], 1, "did you mean 'heatmap'?"),
        (
            ["solve", "k.json", "--camra", "c.json", "--target", "tango"],
            2,
            "no option --camra; did you mean '--camera'?",
        ),
        (["evaluate", "a", "b", "--jsn"], 2, "no option --jsn; did you mean '--json'?"),
        (
            ["convert", "a", "--to", "csv", "--out", "o", "--reader.position-units", "km"],
            2,
            "'--reader.position-unit'?",
        ),
        (["convert", "a", "--to", "yolo-pos", "--out", "o"], 1, "did you mean 'yolo-pose'?"),
        (["mission", "show", "observation-10-100"], 1, "did you mean 'observation-10-100m'?"),
        (["target", "show", "tngo"], 1, "did you mean 'tango'?"),
        (["render", "--sensor", "speed-clas", "--out", "o", "--renderer", "raycast"], 1, "did you mean 'speed-class'?"),
    ],
)
def test_the_word_that_was_meant_is_named(
    argv: list[str], status: int, meant: str, capsys: pytest.CaptureFixture
) -> None:
    error = said(argv, status, capsys)
    assert meant in error
    assert len([line for line in error.splitlines() if not line.startswith("first use")]) == 1


def test_what_resembles_nothing_keeps_the_usual_answer(capsys: pytest.CaptureFixture) -> None:
    assert "one of demo" in said(["xyzzy"], 2, capsys)
    assert "--frobnicate" in said(["evaluate", "a", "b", "--frobnicate"], 2, capsys)


def test_a_table_without_header_names_the_option_as_it_is_typed(tmp_path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "t.csv").write_text("0,1,2,3\n1,2,3,4\n")
    assert main(["convert", str(tmp_path / "t.csv"), "--to", "stk", "--out", str(tmp_path / "o")]) == 1
    assert "--reader.columns t x y z" in capsys.readouterr().err
