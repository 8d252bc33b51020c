"""Which number format a machine trains fastest in."""

from typing import Literal

import torch

from proxnav.detection.training.config import Precision


def best_precision(wanted: Precision) -> Literal["32-true", "bf16-mixed"]:
    """`auto` becomes bf16-mixed where the accelerator or the processor multiplies bfloat16 in hardware."""
    if wanted != "auto":
        return wanted
    if torch.cuda.is_available():
        return "bf16-mixed" if torch.cuda.is_bf16_supported() else "32-true"
    return "bf16-mixed" if _cpu_has_bfloat16() else "32-true"


def _cpu_has_bfloat16() -> bool:
    # Older versions of torch do not say; float32 is always right there.
    capabilities = getattr(torch.cpu, "get_capabilities", dict)()
    return bool(capabilities.get("avx512_bf16") or capabilities.get("amx_bf16"))
