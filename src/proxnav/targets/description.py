"""A target in words: what it is, and what of it deserves a second look."""

from collections.abc import Iterator

import numpy as np

from proxnav.targets.cad.from_mesh import isolated_parts
from proxnav.targets.keypoints.choice import near_symmetries
from proxnav.targets.keypoints.quality import complaints, mistaken
from proxnav.targets.target import Target


def description(target: Target) -> str:
    """Size, source and keypoints as text."""
    size = " x ".join(f"{v:.3f}" for v in np.ptp(target.vertices_m, axis=0))
    lines = [
        f"{target.name}: {size} m (forward, right, down)",
        f"source: {target.source}; licence: {target.licence}",
        f"{len(target.vertices_m)} vertices, {len(target.faces)} triangles, {len(target.part_names)} parts",
    ]
    six = target.subsets.get("six", ())
    for k, (name, point) in enumerate(zip(target.keypoint_names, target.keypoints_m, strict=True)):
        mark = "  six" if k in six else ""
        lines.append(f"  {name:<24} {point[0]:8.3f} {point[1]:8.3f} {point[2]:8.3f} m{mark}")
    return "\n".join(lines)


def second_looks(target: Target) -> Iterator[str]:
    """What deserves a second look: stray parts, turns that a network may confuse, weak keypoints."""
    for part in isolated_parts(target):
        yield f"part '{part}' lies far from the rest; leave it out with --without {part}"
    for turn in near_symmetries(target, np.random.default_rng(0)):
        pairs = mistaken(target, turn)
        yield (
            f"nearly unchanged by a turn of {turn.angle_deg:.0f} deg about its {turn.axis} (within {turn.gap:.1%} of "
            "the radius): a network may confuse the two poses unless materials tell them apart"
            + (f"; it would take {', '.join(pairs)}" if pairs else "")
        )
    yield from complaints(target)
