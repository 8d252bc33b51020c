"""What is said about the input: the one error type that means "the input is wrong" (not: "proxnav is wrong"), notes."""


class InputError(ValueError):
    """Something the user gave cannot be used; the message says what was asked, what was found and what to do.

    The command line prints it as one line and exits with 1. Everything else keeps its traceback.
    """


SUSPECT = 3
"""Exit status of a command that has done its work and says that its result is not to be trusted."""


class InputNote(UserWarning):
    """Something about the input that its giver should know and that stops nothing, in a sentence.

    The command line prints it as one line and goes on.
    """
