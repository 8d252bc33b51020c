"""`proxnav train`: what cannot be trained is said before anything is drawn."""

import pytest

from proxnav.cli.main import main


@pytest.mark.parametrize("network", ["heatmap", "finder"])
def test_a_side_that_the_network_cannot_halve_five_times_is_refused(network, tmp_path, capsys):
    assert main(["train", network, "--out", str(tmp_path / "run"), "--side", "100"]) == 1
    assert "multiple of 32" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()
