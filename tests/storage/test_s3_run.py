"""The chain on object storage: render, shards, train, estimate, evaluate, with nothing on this machine but a cache."""

import json
import shutil
from pathlib import Path

import pytest

from proxnav.cli.main import main

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]


def test_render_train_estimate_evaluate_on_s3(bucket, tmp_path: Path, capsys) -> None:
    run = "s3://flights/run"
    render = ["render", "--renderer", "raycast", "--frames", "4", "--size", "128", "--out", f"{run}/set"]
    assert main(render) == 0
    bucket.invalidate_cache()
    kept = {path: bucket.cat(path) for path in bucket.find("flights/run/set")}
    assert sum(path.endswith(".png") for path in kept) == 8
    shutil.rmtree(tmp_path / "cache" / "mirror")  # another machine
    assert main(["convert", f"{run}/set", "--to", "shards", "--frames-per-shard", "2", "--out", f"{run}/shards"]) == 0
    train = ["train", "keypoint-rcnn", "--data", f"{run}/shards", "--side", "64", "--steps", "2", "--calibration", "6"]
    assert main([*train, "--out", f"{run}/training"]) == 0
    shutil.rmtree(tmp_path / "cache" / "mirror")
    estimate = ["estimate", f"{run}/set", "--model", f"{run}/training/model", "--out", f"{run}/poses.json"]
    assert main(estimate) == 0
    shutil.rmtree(tmp_path / "cache" / "mirror")
    capsys.readouterr()
    assert main(["evaluate", f"{run}/poses.json", f"{run}/set", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["frames"] == 4
    bucket.invalidate_cache()
    names = {path.removeprefix("flights/run/") for path in bucket.find("flights/run")}
    assert {"poses.json", "shards/index.json", "training/weights.safetensors", "training/model/model.json"} <= names
    assert {path: bucket.cat(path) for path in bucket.find("flights/run/set")} == kept


def test_a_render_that_was_cut_off_resumes_from_storage(bucket, tmp_path: Path, monkeypatch) -> None:
    from proxnav.datasets.set.writer import DatasetWriter

    words = ["render", "--renderer", "raycast", "--frames", "4", "--size", "64", "--out"]
    assert main([*words, str(tmp_path / "whole")]) == 0
    put, count = DatasetWriter.put, 0

    def dies(self, files) -> None:
        nonlocal count
        count += 1
        if count == 3:
            raise KeyboardInterrupt
        put(self, files)

    with monkeypatch.context() as patched:
        patched.setattr(DatasetWriter, "put", dies)
        assert main([*words, "s3://flights/cut"]) == 130
    shutil.rmtree(tmp_path / "cache" / "mirror")
    assert main([*words, "s3://flights/cut"]) == 0
    bucket.invalidate_cache()
    names = {path.removeprefix("flights/cut/"): path for path in bucket.find("flights/cut")}
    here = {str(p.relative_to(tmp_path / "whole")): p for p in (tmp_path / "whole").rglob("*") if p.is_file()}
    assert names.keys() == here.keys()
    assert all(bucket.cat(names[name]) == here[name].read_bytes() for name in names if name != "config.json")
