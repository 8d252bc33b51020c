from contextlib import closing
from itertools import count

from proxnav.detection.training.feed import ahead


def test_leaving_a_stream_early_closes_its_source():
    ended = []

    def source():
        try:
            yield from count()
        finally:
            ended.append(True)

    with closing(ahead(source())) as items:
        assert [next(items) for _ in range(3)] == [0, 1, 2]
    assert ended == [True]
