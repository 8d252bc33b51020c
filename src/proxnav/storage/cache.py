"""Where things are kept that can be made or fetched again."""

import os
from pathlib import Path


def cache_folder() -> Path:
    """`PROXNAV_CACHE`, or `proxnav` in the user's cache folder."""
    named = os.environ.get("PROXNAV_CACHE")
    if named:
        return Path(named)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "proxnav"
