"""What is said about the input: the one error type that means "the input is wrong" (not: "proxnav is wrong"), notes."""

from collections.abc import Iterable


class InputError(ValueError):
    """Something the user gave cannot be used; the message says what was asked, what was found and what to do.

    The command line prints it as one line and exits with 1. Everything else keeps its traceback.
    """


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A question to add to a message, with the known word that is nearest; nothing where none is near.

    >>> did_you_mean("evalute", ["estimate", "evaluate"])
    "; did you mean 'evaluate'?"
    """
    from difflib import get_close_matches

    near = get_close_matches(word, list(known), n=1, cutoff=0.7)
    return f"; did you mean '{near[0]}'?" if near else ""


SUSPECT = 3
"""Exit status of a command that has done its work and says that its result is not to be trusted."""


class InputNote(UserWarning):
    """Something about the input that its giver should know and that stops nothing, in a sentence.

    The command line prints it as one line and goes on.
    """
