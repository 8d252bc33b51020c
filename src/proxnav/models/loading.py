"""Models by name or folder, ready to run; needs no torch."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from proxnav.cluster.carried import Carried
from proxnav.cluster.jobs import is_elsewhere
from proxnav.detection.heatmap.config import HeatmapSettings
from proxnav.detection.heatmap.detector import HeatmapDetector
from proxnav.detection.keypoint_rcnn.onnx_runtime import load_onnx
from proxnav.detection.sessions import Backend, open_session
from proxnav.errors import InputError, did_you_mean
from proxnav.geometry.types import Box, Image
from proxnav.missions import Mission, mission_in
from proxnav.models.card import CARD, ModelCard, card_content, card_from
from proxnav.records import Keypoints
from proxnav.targets import Target
from proxnav.targets.loading import load_target

SHIPPED = Path(__file__).parents[1] / "weights"
"""Models that come with the package, a folder each."""

Detect = Callable[[Image], Keypoints]
DetectIn = Callable[[Image, Box], Keypoints]


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A loaded model."""

    card: ModelCard
    detect: Detect
    """Keypoints of an image, found by a search."""
    detect_in: DetectIn | None
    """Keypoints of an image in a crop round a box [px]; None where the detector only searches."""
    shape: Target | None
    """The target whose outline is laid onto images; None where poses are not aligned."""
    mission: Mission | None
    """What it was trained for; None for models of release 0.1, which do not say."""


def load_model(model: str | Carried, backend: Backend = "auto", threads: int = 0) -> Model:
    """A shipped model by name, a folder with a model.json, or the files of one; `threads` 0 takes all cores."""
    if isinstance(model, Carried):
        with model.unpacked() as folder:
            return _load(Path(folder), backend, threads)
    return _load(_folder(model), backend, threads)


def load_card(model: str) -> ModelCard:
    """The card of a shipped model or of a folder with a model.json; its networks stay closed."""
    return _card(_folder(model))[0]


def model_digest(model: str) -> str:
    """SHA-256 of all that a model's poses follow from before they are judged: its networks, its card without trust."""
    described = _folder(model)
    _, networks = _card(described)
    digest = hashlib.sha256()
    for folder in (described, networks):
        content = {key: value for key, value in card_content(folder).items() if key != "trust"}
        digest.update(json.dumps(content, sort_keys=True).encode())
    for path in sorted(path for path in networks.iterdir() if path.suffix in (".onnx", ".safetensors")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def shipped_models() -> list[str]:
    """Names of the models in the package."""
    return sorted(path.parent.name for path in SHIPPED.glob(f"*/{CARD}"))


def carried_model(model: str, on: str) -> str | Carried:
    """What a worker needs to load the model: the name of a shipped one, the files of another where it sees none."""
    return model if not is_elsewhere(on) or model in shipped_models() else Carried.of(Path(model))


def _folder(name_or_path: str) -> Path:
    for folder in (SHIPPED / name_or_path, Path(name_or_path)):
        if (folder / CARD).is_file():
            return folder
    raise InputError(
        f"no model '{name_or_path}': neither a shipped one ({', '.join(shipped_models()) or 'none'}) "
        f"nor a folder with a {CARD}{did_you_mean(str(name_or_path), shipped_models())}"
    )


def _load(described: Path, backend: Backend, threads: int) -> Model:
    card, folder = _card(described)
    detect, detect_in = _detector(folder, card, backend, threads)
    shape = None if card.alignment is None else _shape(folder, card)
    return Model(card, detect, detect_in, shape, mission_in(folder))


def _card(described: Path) -> tuple[ModelCard, Path]:
    """The card of a model's folder, and the folder of its networks."""
    content = card_content(described)
    folder = described
    while content.get("based_on") in shipped_models():  # the networks of a shipped model, used in another way
        folder = SHIPPED / content.pop("based_on")
        content = card_content(folder) | content
    try:
        return card_from(content, folder), folder
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{folder / CARD}: {type(error).__name__} {error}; export the model again") from None


def _detector(folder: Path, card: ModelCard, backend: Backend, threads: int) -> tuple[Detect, DetectIn | None]:
    settings = card.settings
    if isinstance(settings, HeatmapSettings):
        find = open_session(folder / "finder.onnx", backend, threads)
        read = open_session(folder / "crop.onnx", backend, threads)
        detector = HeatmapDetector(find, read, len(card.keypoint_names), settings)
        return detector, detector.detect_in if settings.passes > 1 else None
    network = load_onnx(folder / "keypoint-rcnn.onnx", threads)
    return (lambda image: network.predict(image, settings)), None


def _shape(folder: Path, card: ModelCard) -> Target:
    """The target that lies in the model's folder, or the generated one of that name."""
    beside = folder / "target"
    return load_target(str(beside) if beside.is_dir() else card.target)
