"""The loop that trains every detector."""

import signal
from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import load_file
from torch import nn

from proxnav.detection.samples import TrainingSample
from proxnav.detection.training.config import LoopConfig
from proxnav.detection.training.curve import read_rows
from proxnav.detection.training.files import load_checkpoint, load_weights, save_weights
from proxnav.detection.training.learner import Learner
from proxnav.detection.training.loop import train
from proxnav.detection.training.rates import warm_up_then_cosine
from proxnav.errors import InputError

CONFIG = LoopConfig(
    steps=12, batch_size=3, accumulate=2, precision="32-true", accelerator="cpu", deterministic=True, log_every=2,
    save_every=1000,
)  # fmt: skip


def sample(index: int) -> TrainingSample:
    rng = np.random.default_rng([7, index])
    image = rng.integers(0, 255, (8, 8), dtype=np.uint8)
    point = np.array([[image[:4].mean() / 32.0, image[4:].mean() / 32.0]])
    return TrainingSample(image, point, np.array([2]), np.array([0.0, 0.0, 8.0, 8.0]))


def source(start: int, stride: int) -> Iterator[TrainingSample]:
    return (sample(index) for index in count(start, stride))


def collate(samples: list[TrainingSample], step: int, rng: np.random.Generator) -> dict[str, torch.Tensor]:
    images = np.stack([s.image for s in samples]).astype(np.float32)[:, None] / 255.0
    images += rng.normal(0.0, 0.01, images.shape).astype(np.float32)
    points = np.stack([s.keypoints_px[0] for s in samples]).astype(np.float32)
    return {"images": torch.from_numpy(images), "points": torch.from_numpy(points)}


def loss(model: nn.Module, batch: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    return {"point": (model(batch["images"]) - batch["points"]).square().mean()}


def learner(steps: int = 12, **replaced) -> Learner:
    torch.manual_seed(5)
    model = nn.Sequential(
        nn.Conv2d(1, 4, 3), nn.BatchNorm2d(4), nn.ReLU(), nn.Dropout(0.2), nn.Flatten(), nn.Linear(144, 2)
    )
    optimizer = torch.optim.AdamW(model.parameters())
    defaults = dict(
        model=model,
        optimizer=optimizer,
        rate=lambda step, share: warm_up_then_cosine(1e-2, 3)(step, step / steps),
        collate=collate,
        loss=loss,
    )
    return Learner(**(defaults | replaced))


def with_interrupt_at(step: int):
    """A loss that presses Ctrl-C during the first pass of a step."""
    calls = count()

    def interrupted(model: nn.Module, batch: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
        if next(calls) == step * CONFIG.accumulate:
            signal.raise_signal(signal.SIGINT)
        return loss(model, batch)

    return interrupted


def assert_same(a: dict[str, torch.Tensor], b: dict[str, torch.Tensor]) -> None:
    assert a.keys() == b.keys()
    for name in a:
        assert torch.equal(a[name], b[name]), name


@pytest.mark.parametrize("step", [0, 1, 5, 10])
def test_interrupting_and_resuming_gives_the_weights_of_an_uninterrupted_run(tmp_path: Path, step: int) -> None:
    whole = train(learner(), source, CONFIG, tmp_path / "whole")
    with pytest.raises(KeyboardInterrupt):
        train(learner(loss=with_interrupt_at(step)), source, CONFIG, tmp_path / "parts")
    torch.rand(17)  # other work draws from the global generator in between
    resumed = train(learner(), source, CONFIG, tmp_path / "parts")
    assert_same(whole.model.state_dict(), resumed.model.state_dict())
    a, b = (load_checkpoint(tmp_path / name / "checkpoint.pt") for name in ("whole", "parts"))
    assert_same(a["model"], b["model"])
    assert a["progress"] | {"seconds": 0.0} == b["progress"] | {"seconds": 0.0}


def test_the_hours_of_a_training_are_those_of_all_its_parts(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        train(learner(loss=with_interrupt_at(3)), source, replace(CONFIG, hours=1.0), tmp_path)
    spent = load_checkpoint(tmp_path / "checkpoint.pt")["progress"]["seconds"]
    result = train(learner(), source, replace(CONFIG, hours=0.5 * spent / 3600.0), tmp_path)
    assert (result.reason, result.steps) == ("finished", 4)


def test_killed_between_checkpoints_repeats_the_lost_steps(tmp_path: Path) -> None:
    def dies(model: nn.Module, batch: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
        if next(calls) == 15:
            raise RuntimeError("power cut")
        return loss(model, batch)

    calls = count()
    config = replace(CONFIG, save_every=3)
    whole = train(learner(), source, config, tmp_path / "whole")
    with pytest.raises(RuntimeError, match="power cut"):
        train(learner(loss=dies), source, config, tmp_path / "parts")
    resumed = train(learner(), source, config, tmp_path / "parts")
    assert_same(whole.model.state_dict(), resumed.model.state_dict())
    steps = [int(row["step"]) for row in read_rows(tmp_path / "parts" / "curve.csv")]
    assert steps == [2, 4, 6, 8, 10, 12]


def test_an_averaged_model_validates_without_disturbing_the_run(tmp_path: Path) -> None:
    def validate(model: nn.Module) -> float:
        assert not model.training
        torch.rand(3)
        return float(len(list(model.parameters())))

    plain = train(learner(), source, CONFIG, tmp_path / "plain")
    watched = train(learner(), source, replace(CONFIG, validate_every=4), tmp_path / "watched", validate)
    last = [load_checkpoint(tmp_path / name / "checkpoint.pt")["model"] for name in ("plain", "watched")]
    assert_same(*last)
    assert plain.best_score != plain.best_score
    assert watched.best_score == 4.0 + 2.0


def test_a_run_stops_early_and_returns_its_best_weights(tmp_path: Path) -> None:
    scores, seen = iter([3.0, 1.0, 2.0, 5.0, 0.0]), []

    def validate(model: nn.Module) -> float:
        seen.append({name: value.clone() for name, value in model.state_dict().items()})
        return next(scores)

    config = replace(CONFIG, validate_every=2, patience=2)
    result = train(learner(), source, config, tmp_path, validate)
    assert (result.reason, result.steps, result.best_score) == ("early_stop", 8, 1.0)
    assert_same(result.model.state_dict(), seen[1])
    assert_same(load_file(result.weights), seen[1])


def test_steps_that_are_not_finite_are_left_out_and_counted(tmp_path: Path) -> None:
    poisoned, calls = {6, 13}, count()

    def sometimes_nan(model: nn.Module, batch: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
        images = batch["images"] * (torch.nan if next(calls) in poisoned else 1.0)
        return loss(model, {**batch, "images": images})

    result = train(learner(loss=sometimes_nan), source, CONFIG, tmp_path)
    assert (result.skipped, result.steps) == (2, 12)
    state = load_checkpoint(tmp_path / "checkpoint.pt")["model"]
    assert all(torch.isfinite(value).all() for value in state.values())  # batch statistics too


def test_endless_nan_ends_the_run_and_keeps_the_last_good_checkpoint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("proxnav.detection.training.loop.MOST_SKIPPED", 5)
    calls = count()

    def soon_nan(model: nn.Module, batch: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
        factor = torch.nan if next(calls) >= 8 else 1.0
        return {"point": loss(model, batch)["point"] * factor}

    config = replace(CONFIG, save_every=2)
    with pytest.raises(InputError, match=r"not finite 5 steps in a row up to step 9: lower the learning rate"):
        train(learner(loss=soon_nan), source, config, tmp_path)
    content = load_checkpoint(tmp_path / "checkpoint.pt")
    assert all(torch.isfinite(value).all() for value in content["model"].values())


def test_a_failed_write_leaves_the_old_checkpoint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    train(learner(), source, CONFIG, tmp_path)
    before = (tmp_path / "checkpoint.pt").read_bytes()

    def half_written(content: dict, path: Path) -> None:
        path.write_bytes(b"half")
        raise OSError("disk full")

    monkeypatch.setattr(torch, "save", half_written)
    with pytest.raises(InputError, match="cannot be written"):
        train(learner(24), source, replace(CONFIG, steps=24), tmp_path)
    assert (tmp_path / "checkpoint.pt").read_bytes() == before
    assert not list(tmp_path.glob(".*"))


def test_a_checkpoint_of_another_run_is_refused(tmp_path: Path) -> None:
    train(learner(notes={"keypoints": 6}), source, CONFIG, tmp_path)
    with pytest.raises(InputError, match="made with keypoints = 6, this run has 8"):
        train(learner(notes={"keypoints": 8}), source, CONFIG, tmp_path)


def test_a_damaged_checkpoint_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "checkpoint.pt").write_bytes(b"PK\x03\x04 cut short")
    with pytest.raises(InputError, match=r"not a readable checkpoint .* delete it to start this run afresh"):
        train(learner(), source, CONFIG, tmp_path)


def test_a_finished_run_goes_on_when_it_is_given_more_steps(tmp_path: Path) -> None:
    whole = train(learner(24), source, replace(CONFIG, steps=24), tmp_path / "whole")
    train(learner(24), source, CONFIG, tmp_path / "parts")
    longer = train(learner(24), source, replace(CONFIG, steps=24), tmp_path / "parts")
    assert_same(whole.model.state_dict(), longer.model.state_dict())


def test_the_curve_tells_loss_rate_speed_and_waiting(tmp_path: Path) -> None:
    train(learner(), source, CONFIG, tmp_path)
    rows = read_rows(tmp_path / "curve.csv")
    assert list(rows[0]) == ["step", "skipped", "rate", "images_per_s", "waiting", "loss", "point"]
    assert float(rows[-1]["loss"]) < float(rows[0]["loss"])


def test_a_source_that_ends_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="source must go on for ever"):
        train(learner(), lambda start, stride: iter([sample(0)]), CONFIG, tmp_path)


def test_weights_start_another_run_under_either_name_and_foreign_ones_are_refused(tmp_path: Path) -> None:
    net, other = nn.Linear(2, 3), nn.Linear(2, 3)
    save_weights(tmp_path / "own.safetensors", net.state_dict(), {})
    exported = {f"net.{name}": value.half() for name, value in net.state_dict().items()}
    save_weights(tmp_path / "exported.safetensors", exported, {})
    for name in ("own", "exported"):
        load_weights(other, tmp_path / f"{name}.safetensors")
        torch.testing.assert_close(other.weight, net.weight, atol=1e-3, rtol=1e-3)
    (tmp_path / "torn.safetensors").write_bytes((tmp_path / "own.safetensors").read_bytes()[:20])
    for place in (tmp_path / "none", tmp_path, tmp_path / "torn.safetensors"):
        with pytest.raises(InputError, match="no readable safetensors"):
            load_weights(other, place)
    for foreign in (nn.Linear(2, 4), nn.Linear(2, 3, bias=False)):
        with pytest.raises(InputError, match="another network"):
            load_weights(foreign, tmp_path / "own.safetensors")
