"""How a test turns out under given conventions: nothing to say, a cause, or a contradiction that nothing explains."""

from dataclasses import dataclass

UNEXPLAINED = 3.0
"""Cost of a contradiction that no convention explains: as much as three that one does."""


@dataclass(frozen=True, slots=True)
class Account:
    """What one test says."""

    cost: float = 0.0
    """0 where the sensors agree or were not compared; a wrong convention costs 1 or a little more."""
    kind: str = ""
    """Which sensors contradict each other: one cause a kind is kept."""
    cause: str = ""
    """For people, a clause."""
    is_compared: bool = True
    chi2: float = 0.0


AGREES = Account()
NOT_COMPARED = Account(is_compared=False)


def unexplained(kind: str, cause: str) -> Account:
    """A contradiction without a name."""
    return Account(UNEXPLAINED, kind, cause)
