"""Names of the parts of the filter's benchmark."""

from typing import Literal

Part = Literal["consistency", "accuracy", "faults", "speed", "outside", "monitor"]
