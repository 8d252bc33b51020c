"""The model card: `model.json` as a value, with its one reader and its one writer."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.detection.heatmap.config import HeatmapNetConfig, HeatmapSettings
from proxnav.detection.keypoint_rcnn.decode import Calibration
from proxnav.detection.keypoint_rcnn.detect import DetectConfig
from proxnav.errors import InputError
from proxnav.geometry.types import Points
from proxnav.models.trust_json import calibration_from, calibration_json
from proxnav.pose.align.config import AlignConfig
from proxnav.pose.trust import TrustCalibration
from proxnav.storage.files import read_json, write_json

CARD = "model.json"
DETECTORS = ("heatmap", "keypoint-rcnn")


@dataclass(frozen=True, slots=True, eq=False)
class ModelCard:
    """What a model knows and how it is to be used."""

    target: str
    """Name of the target, or of the generator that makes it."""
    keypoint_names: tuple[str, ...]
    keypoints_m: Points
    """Keypoints in the target frame [m], in the detector's order."""
    settings: HeatmapSettings | DetectConfig
    """Settings of the heat-map detector or of Keypoint R-CNN, which is what tells the two apart."""
    least_median_score: float = 0.0
    """Median score of the keypoints found below which the image shows no target."""
    network: HeatmapNetConfig | None = None
    """Dimensions of the crop network, for whoever trains it on."""
    alignment: AlignConfig | None = None
    """How poses are laid onto the image; None leaves them as the keypoints say."""
    trust: TrustCalibration | None = None
    """What evidence about poses is worth; None lets only the predicted view count."""

    @property
    def detector(self) -> str:
        """Kind of the detector, as the file names it."""
        return "heatmap" if isinstance(self.settings, HeatmapSettings) else "keypoint-rcnn"


def write_card(folder: Path, card: ModelCard) -> None:
    """Writes the folder's model.json."""
    content: dict[str, Any] = {
        "detector": card.detector,
        "target": card.target,
        "keypoint_names": list(card.keypoint_names),
        "keypoints_m": card.keypoints_m.tolist(),
        "settings": _settings_json(card.settings),
        "least_median_score": card.least_median_score,
    }
    if isinstance(card.settings, HeatmapSettings) and card.settings.passes != HeatmapSettings.passes:
        content["looks"] = card.settings.passes
    if isinstance(card.settings, HeatmapSettings) and card.settings.turns != HeatmapSettings.turns:
        content["turns"] = card.settings.turns
    if card.network is not None:
        content["network"] = {"n_keypoints": len(card.keypoint_names)} | asdict(card.network)
    if card.alignment is not None:
        content["alignment"] = {name: round(value, 3) for name, value in asdict(card.alignment).items()}
    if card.trust is not None:
        content["trust"] = calibration_json(card.trust)
    write_json(folder / CARD, content, indent=1)


def card_content(folder: Path) -> dict[str, Any]:
    """The folder's model.json as it stands; InputError where it is no JSON object."""
    content = read_json(folder / CARD, "the description of a model")
    if not isinstance(content, dict):
        raise _not_a_card(folder)
    return content


def card_from(content: dict[str, Any], folder: Path) -> ModelCard:
    """The card that a model.json in `folder` describes; InputError, ValueError, TypeError or KeyError otherwise."""
    if content.get("detector") not in list(DETECTORS):
        raise _not_a_card(folder)
    points = np.array(content["keypoints_m"], dtype=np.float64).reshape(-1, 3)
    names = tuple(str(name) for name in content["keypoint_names"])
    if len(names) != len(points):
        raise InputError(f"{folder / CARD}: {len(names)} keypoint names for {len(points)} keypoints")
    alignment, network = content.get("alignment"), content.get("network")
    return ModelCard(
        target=str(content["target"]),
        keypoint_names=names,
        keypoints_m=points,
        settings=_heatmap(content) if content["detector"] == "heatmap" else _rcnn(content["settings"]),
        least_median_score=float(content.get("least_median_score", 0.0)),
        network=None if network is None else HeatmapNetConfig(network["trunk"], network["width"]),
        alignment=None if alignment is None else AlignConfig(**alignment),
        trust=None if content.get("trust") is None else calibration_from(content["trust"]),
    )


def _not_a_card(folder: Path) -> InputError:
    return InputError(f"{folder / CARD}: expected a detector among {', '.join(DETECTORS)}")


def _heatmap(content: dict[str, Any]) -> HeatmapSettings:
    """The heat-map detector's settings; its passes and turns stand beside them in the file, as `looks` and `turns`."""
    passes, turns = (int(content.get(key, usual)) for key, usual in (("looks", HeatmapSettings.passes), ("turns", 1)))
    return HeatmapSettings(**content["settings"], passes=passes, turns=turns)


def _rcnn(settings: dict[str, Any]) -> DetectConfig:
    return DetectConfig(settings["min_score"], settings["looks"], Calibration(**settings["calibration"]))


def _settings_json(settings: HeatmapSettings | DetectConfig) -> dict[str, Any]:
    content = asdict(settings)
    passes = content.pop("passes")
    content.pop("turns", None)
    if isinstance(settings, HeatmapSettings):
        return content
    return {"min_score": content["min_score"], "looks": passes, "calibration": content["calibration"]}
