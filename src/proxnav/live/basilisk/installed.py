"""What these modules take from Basilisk, or one sentence where it is not installed."""

from typing import Any

from proxnav.errors import InputError

try:
    from Basilisk.architecture import messaging as _messaging  # pyright: ignore[reportMissingImports]
    from Basilisk.architecture import sim_model as _sim_model  # pyright: ignore[reportMissingImports]
    from Basilisk.architecture import sysModel as _sys_model  # pyright: ignore[reportMissingImports]
except ImportError as error:
    raise InputError("modules of Basilisk need Basilisk: pip install 'proxnav[basilisk]'") from error

messaging: Any = _messaging
sim_model: Any = _sim_model
sysModel: Any = _sys_model

NANO = 1e-9
"""Seconds in one unit of Basilisk's clock."""


def linked(module: Any, *names: str) -> None:
    """InputError unless the module's inputs of these names are subscribed to a message."""
    loose = [name for name in names if not getattr(module, name).isLinked()]
    if loose:
        raise InputError(f"{module.ModelTag}: {', '.join(loose)} reads no message: subscribe it to one before the run")


__all__ = ["NANO", "linked", "messaging", "sim_model", "sysModel"]
