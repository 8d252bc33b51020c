"""A target by name or by file."""

from proxnav.errors import InputError
from proxnav.targets.space_rider import space_rider
from proxnav.targets.target import Target


def load_target(name_or_path: str) -> Target:
    """The target of that name."""
    if name_or_path == "space-rider":
        return space_rider()
    raise InputError(f"no target '{name_or_path}'; expected space-rider")
