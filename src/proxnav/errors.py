"""The one error type that means "the input is wrong", as opposed to "proxnav is wrong"."""


class InputError(ValueError):
    """Something the user gave cannot be used; the message says what was asked, what was found and what to do.

    The command line prints it as one line and exits with 1. Everything else keeps its traceback.
    """
