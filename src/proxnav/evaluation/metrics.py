"""A summary as the JSON object that `evaluate --json`, `benchmark table1 --json` and `metrics.json` share."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from proxnav.evaluation.consistency import Consistency, Efficiency
from proxnav.evaluation.summary import Summary


def metrics(
    summary: Summary,
    found: Consistency | None = None,
    efficiency: Mapping[tuple[float, float], Efficiency] | None = None,
) -> dict[str, Any]:
    """Plain numbers; what is not defined (no pose at all) is null, since JSON has no NaN."""
    content = asdict(summary) | {"consistency": None if found is None else asdict(found)}
    if efficiency:
        content["efficiency"] = {f"{near:g}-{far:g} m": _ratios(one) for (near, far), one in efficiency.items()}
    return {key: _plain(value) for key, value in content.items()}


def _ratios(one: Efficiency) -> dict[str, Any]:
    return asdict(one) | {"translation": one.translation, "rotation": one.rotation}


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    return value
