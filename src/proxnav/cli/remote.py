"""Words of a command line that are URLs, as folders of this machine while the command runs."""

import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from proxnav.datasets.shards import is_sharded
from proxnav.errors import InputError
from proxnav.storage.mirror import Mirror, as_url, sent_back

_OUTPUTS = ("--out",)


@contextmanager
def localised(argv: list[str]) -> Iterator[list[str]]:
    """The words with each URL as its mirror here; what was written goes back when the block ends, however it ends."""
    words: list[str] = []
    with ExitStack() as stack:
        for number, word in enumerate(argv):
            flag, equals, value = word.partition("=") if word.startswith("--") else ("", "", word)
            url = as_url(value)
            if url is None:
                words.append(word)
                continue
            is_output = (flag or (argv[number - 1] if number else "")) in _OUTPUTS
            words.append(flag + equals + _place(url, is_output, stack))
        yield words


def _place(url: str, is_output: bool, stack: ExitStack) -> str:
    mirror = Mirror.of(url)
    if is_output and os.environ.get("RANK", "0") == "0":
        stack.callback(_say, mirror)
        return str(stack.enter_context(sent_back(mirror)))
    if is_output:  # another rank of the same training: the first one fetches and sends
        return str(mirror.folder)
    if not mirror.is_local and is_sharded(url):  # streamed, not fetched
        return url
    place = mirror.fetch(needed=True)
    if not place.exists():
        raise InputError(f"{url}: no such file or folder; check the path")
    return str(place)


def _say(mirror: Mirror) -> None:
    if not mirror.is_local:
        print(f"{mirror.url} holds what {mirror.folder} held when the command ended", file=sys.stderr)
