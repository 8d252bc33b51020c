"""The training loop of every detector: draw a batch, step, average, write down, save; resume where it stopped."""

import logging
import math
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import closing, nullcontext
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import torch
from lightning_fabric import Fabric
from safetensors.torch import load_file
from torch import Tensor, nn

from proxnav.detection.samples import SampleSource
from proxnav.detection.training.average import averaged_copy, update_average
from proxnav.detection.training.config import SEED, LoopConfig
from proxnav.detection.training.curve import append_row, cut_after
from proxnav.detection.training.feed import ahead, batches
from proxnav.detection.training.files import load_checkpoint, save_checkpoint, save_weights
from proxnav.detection.training.learner import Learner, TrainingResult, Validate
from proxnav.detection.training.progress import Meter, Show, progress_bar
from proxnav.detection.training.random_state import random_state, restore_random_state
from proxnav.detection.training.ranks import any_rank, is_first_rank, launched, mean_over_ranks, reseed
from proxnav.detection.training.step import take_step
from proxnav.errors import InputError
from proxnav.storage.interrupt import stop_requested
from proxnav.storage.lock import only_run_in

_log = logging.getLogger(__name__)

CHECKPOINT, BEST, WEIGHTS, CURVE = "checkpoint.pt", "best.safetensors", "weights.safetensors", "curve.csv"
VERSION = 1
CLIP_NORM = 10.0
"""Largest norm of the gradient; longer ones are scaled down."""
MOST_SKIPPED = 20
"""Steps in a row with a loss that is not finite before the run gives up."""


@dataclass
class _Progress:
    """Where a run stands: all of a checkpoint that is not weights or generators."""

    step: int = 0
    skipped: int = 0
    skipped_in_a_row: int = 0
    best_score: float = math.inf
    stale: int = 0
    """Validations since the best one."""
    seconds: float = 0.0
    """Time of all parts of the run together."""


@dataclass(frozen=True)
class _Run:
    learner: Learner
    average: nn.Module
    config: LoopConfig
    out: Path
    validate: Validate | None
    fabric: Fabric
    model: nn.Module
    optimizer: Any
    at: _Progress
    meter: Meter
    deadline: float


def train(
    learner: Learner, source: SampleSource, config: LoopConfig, out: Path, validate: Validate | None = None
) -> TrainingResult:
    """Trains into the folder `out`, from its checkpoint where it has one; Ctrl-C saves, then raises KeyboardInterrupt.

    Interrupted anywhere and resumed, a deterministic run on one CPU gives the weights of a run that was not.
    """
    with only_run_in(out) if is_first_rank() else nullcontext():
        return _train(learner, source, config, out, validate)


def _train(
    learner: Learner, source: SampleSource, config: LoopConfig, out: Path, validate: Validate | None
) -> TrainingResult:
    run = _start(learner, config, out, validate)
    feed = batches(
        source, learner.collate, config.batch_size, config.accumulate, SEED,
        step=run.at.step, rank=run.fabric.global_rank, world=run.fabric.world_size,
    )  # fmt: skip
    with stop_requested() as stop, closing(_ahead(run, feed, stop)) as ready, progress_bar(_share(run)) as show:
        while (reason := _ended(run)) is None:
            began = time.monotonic()
            with run.meter.waiting():
                parts: Any = run.fabric.to_device(next(ready, None))
            if parts is not None:
                _advance(run, parts, show)
            # All ranks must agree on how much of the time is gone.
            run.at.seconds += mean_over_ranks(run.fabric, {"seconds": time.monotonic() - began})["seconds"]
            if any_rank(run.fabric, parts is None or stop()):
                _save(run)
                raise KeyboardInterrupt
            if run.at.step % config.save_every == 0:
                _save(run)
    _save(run)
    return _result(run, reason)


def _ahead(run: _Run, feed: Iterator[Any], stop: Callable[[], bool]) -> Generator[Any, None, None]:
    """Batches that end where a stop is asked for; several ranks stop together, after a step that all of them took."""
    return ahead(feed, stop if run.fabric.world_size == 1 else lambda: False)


def _start(learner: Learner, config: LoopConfig, out: Path, validate: Validate | None) -> _Run:
    """Everything on its device and at the step of the checkpoint, if there is one."""
    torch.use_deterministic_algorithms(config.deterministic)
    fabric = launched(config)
    torch.manual_seed(SEED + fabric.global_rank)
    model, optimizer = fabric.setup(learner.model.train(), learner.optimizer)
    out.mkdir(parents=True, exist_ok=True)
    deadline = time.monotonic() + 60.0 * config.minutes if config.minutes else math.inf
    meter = Meter(config.batch_size * config.accumulate * fabric.world_size)
    average = averaged_copy(learner.model)
    run = _Run(learner, average, config, out, validate, fabric, model, optimizer, _Progress(), meter, deadline)
    if (out / CHECKPOINT).exists():
        _resume(run, load_checkpoint(out / CHECKPOINT))
    if fabric.is_global_zero:
        cut_after(out / CURVE, run.at.step)
    return run


def _ended(run: _Run) -> Literal["finished", "early_stop", "time"] | None:
    if _share(run) >= 1.0:
        return "finished"
    if run.config.patience and run.at.stale >= run.config.patience:
        return "early_stop"
    late = math.isfinite(run.deadline) and any_rank(run.fabric, time.monotonic() > run.deadline)
    return "time" if late else None


def _share(run: _Run) -> float:
    """How much of the training is done, by steps or by time."""
    by_time = run.at.seconds / (3600.0 * run.config.hours) if run.config.hours else 0.0
    return max(run.at.step / run.config.steps, by_time)


def _advance(run: _Run, parts: list[Any], show: Show) -> None:
    """One step and what is due after it."""
    at, config = run.at, run.config
    reseed(run.fabric, SEED, at.step)
    rate = run.learner.rate(at.step, _share(run))
    for group in run.learner.optimizer.param_groups:
        group["lr"] = rate * group.get("scale", 1.0)
    terms = take_step(run.fabric, run.model, run.optimizer, run.learner.loss, parts, CLIP_NORM)
    at.step += 1
    _account(run, terms)
    if at.step % config.log_every == 0:
        row = mean_over_ranks(run.fabric, run.meter.row(rate))
        score = f", best validation {at.best_score:.4g}" if math.isfinite(at.best_score) else ""
        loss = f"loss {row.get('loss', math.nan):.4g}"
        show(_share(run), f"step {at.step}, {loss}{score}, {row['images_per_s']:.1f} images/s")
        _write_row(run, {"skipped": at.skipped} | row)
    if run.validate is not None and config.validate_every and at.step % config.validate_every == 0:
        _validate(run, run.validate)


def _account(run: _Run, terms: dict[str, Tensor] | None) -> None:
    at = run.at
    if terms is not None:
        at.skipped_in_a_row = 0
        update_average(run.average, run.learner.model, at.step, run.config.average_decay)
        run.meter.add(terms)
        return
    at.skipped += 1
    at.skipped_in_a_row += 1
    _log.warning("step %d left out, its loss is not finite; %d so far", at.step, at.skipped)
    if at.skipped_in_a_row >= MOST_SKIPPED:
        raise InputError(
            f"the loss was not finite {at.skipped_in_a_row} steps in a row up to step {at.step}: "
            f"lower the learning rate or check the labels; {run.out / CHECKPOINT} still holds the last good state"
        )


def _validate(run: _Run, validate: Validate) -> None:
    """Scores the averaged weights and keeps the best; the run's generators do not notice.

    The first rank scores, the others wait for its word: all must stop at the same step.
    """
    state = random_state()
    score = float(validate(run.average)) if run.fabric.is_global_zero else math.nan
    score = float(run.fabric.broadcast(torch.tensor(score, dtype=torch.float64)))
    restore_random_state(state)
    better = score < run.at.best_score
    run.at.stale = 0 if better else run.at.stale + 1
    if better:
        run.at.best_score = score
        if run.fabric.is_global_zero:
            save_weights(run.out / BEST, run.average.state_dict(), run.learner.notes)
    _log.info("step %d: validation %.5g, best %.5g", run.at.step, score, run.at.best_score)
    _write_row(run, {"validation": score})


def _write_row(run: _Run, row: Mapping[str, float | int]) -> None:
    if run.fabric.is_global_zero:
        append_row(run.out / CURVE, {"step": run.at.step, **row})


def _identity(run: _Run) -> dict[str, Any]:
    """What must not change between the parts of one run."""
    kept = ("batch_size", "accumulate", "average_decay")
    return {"world": run.fabric.world_size} | {key: getattr(run.config, key) for key in kept} | run.learner.notes


def _save(run: _Run) -> None:
    """Writes the checkpoint, except over a good one when a weight is not finite."""
    finite = all(torch.isfinite(weights).all() for weights in run.learner.model.parameters())
    if not finite:
        raise InputError(f"weights are not finite at step {run.at.step}; {run.out / CHECKPOINT} is the last good state")
    if not run.fabric.is_global_zero:
        return
    content = {
        "version": VERSION,
        "identity": _identity(run),
        "progress": asdict(run.at),
        "model": run.learner.model.state_dict(),
        "average": run.average.state_dict(),
        "optimizer": run.learner.optimizer.state_dict(),
        "random": random_state(),
    }
    save_checkpoint(run.out / CHECKPOINT, content)


def _resume(run: _Run, content: dict[str, Any]) -> None:
    """Puts a checkpoint's state into the run; InputError where it belongs to another one."""
    path, identity = run.out / CHECKPOINT, _identity(run)
    if content.get("version") != VERSION:
        raise InputError(f"{path} has version {content.get('version')!r}, expected {VERSION}: choose another folder")
    differing = [key for key, value in identity.items() if content["identity"].get(key) != value]
    if differing:
        key = differing[0]
        raise InputError(
            f"{path} was made with {key} = {content['identity'].get(key)!r}, this run has {identity[key]!r}: "
            "use the same settings or choose another folder"
        )
    run.learner.model.load_state_dict(content["model"])
    run.average.load_state_dict(content["average"])
    run.learner.optimizer.load_state_dict(content["optimizer"])
    for name, value in content["progress"].items():
        setattr(run.at, name, value)
    restore_random_state(content["random"])
    _log.info("resumed %s at step %d", path, run.at.step)


def _result(run: _Run, reason: Literal["finished", "early_stop", "time"]) -> TrainingResult:
    """The averaged weights, of the best validation where there is one, also as a file."""
    at = run.at
    run.fabric.barrier()  # the first rank may still be writing the best weights
    model = run.average.cpu()
    if (run.out / BEST).exists() and math.isfinite(at.best_score):
        model.load_state_dict(load_file(run.out / BEST))
    if run.fabric.is_global_zero:
        save_weights(run.out / WEIGHTS, model.state_dict(), run.learner.notes)
    best = at.best_score if math.isfinite(at.best_score) else math.nan
    samples = at.step * run.config.batch_size * run.config.accumulate * run.fabric.world_size
    return TrainingResult(reason, model, at.step, samples, at.skipped, best, run.out / WEIGHTS)
