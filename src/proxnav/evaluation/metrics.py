"""A summary as the JSON object that `evaluate --json`, `benchmark table1 --json` and `metrics.json` share."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from proxnav.evaluation.consistency import Consistency, Efficiency
from proxnav.evaluation.summary import Summary
from proxnav.storage.files import finite


def metrics(
    summary: Summary,
    found: Consistency | None = None,
    efficiency: Mapping[tuple[float, float], Efficiency] | None = None,
) -> dict[str, Any]:
    """Plain numbers; what is not defined (no pose at all) is null, since JSON has no NaN."""
    content = asdict(summary) | {"consistency": None if found is None else asdict(found)}
    if efficiency:
        content["efficiency"] = {f"{near:g}-{far:g} m": _ratios(one) for (near, far), one in efficiency.items()}
    return finite(content)


def _ratios(one: Efficiency) -> dict[str, Any]:
    return asdict(one) | {"translation": one.translation, "rotation": one.rotation}
