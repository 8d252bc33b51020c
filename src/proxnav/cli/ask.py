"""Questions to whoever sits at the terminal; where nobody does, the option that answers them is named."""

import sys

from proxnav.errors import InputError


def ask(question: str, option: str) -> str:
    """The answer as text; InputError where nobody can be asked, or nothing is answered."""
    if not sys.stdin.isatty():
        raise InputError(f"{option} is missing: the {question}")
    answer = input(f"{question}: ").strip()
    if not answer:
        raise InputError(f"{option}: no answer; give the {question}")
    return answer


def ask_range(question: str, option: str) -> tuple[float, float]:
    """Two numbers."""
    words = ask(question, option).replace(",", " ").split()
    try:
        low, high = map(float, words)
    except ValueError:
        raise InputError(f"{option}: expected two numbers, found {' '.join(words)!r}") from None
    return low, high
