"""A target in words: what it is, and what of it deserves a second look."""

from collections.abc import Iterator

import numpy as np

from proxnav.geometry import quaternion
from proxnav.targets.cad.file_frames import FILE_FRAME
from proxnav.targets.cad.from_mesh import isolated_parts
from proxnav.targets.cad.soundness import soundness
from proxnav.targets.keypoints.choice import near_symmetries
from proxnav.targets.keypoints.quality import complaints, mistaken
from proxnav.targets.target import Target


def description(target: Target) -> str:
    """Size, source, frames and keypoints as text."""
    size = " x ".join(f"{v:.3f}" for v in np.ptp(target.vertices_m, axis=0))
    lines = [
        f"{target.name}: {size} m (x, y, z)",
        f"source: {target.source}; licence: {target.licence}",
        f"{len(target.vertices_m)} vertices, {len(target.faces)} triangles, {len(target.part_names)} parts",
    ]
    lines += list(_frames(target))
    six = target.subsets.get("six", ())
    for k, (name, point) in enumerate(zip(target.keypoint_names, target.keypoints_m, strict=True)):
        mark = "  six" if k in six else ""
        lines.append(f"  {name:<24} {point[0]:8.3f} {point[1]:8.3f} {point[2]:8.3f} m{mark}")
    return "\n".join(lines)


def _frames(target: Target) -> Iterator[str]:
    """Where the target frame lies in the CAD file, and each named frame in the target frame."""
    for name, T_target_b in target.frames.items():
        same = np.allclose(T_target_b.matrix(), np.eye(4), atol=1e-12)
        if name == FILE_FRAME and same:
            yield "frame: origin and axes of the file"
            continue
        turn = np.degrees(quaternion.angle_between(T_target_b.q_wxyz, quaternion.IDENTITY))
        turned = "" if turn < 1e-6 else "  q_wxyz " + " ".join(f"{v:.6f}" for v in T_target_b.q_wxyz)
        x, y, z = T_target_b.t_m
        yield f"  frame {name:<18} {x:8.3f} {y:8.3f} {z:8.3f} m{turned}"


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
    yield from soundness(target)
    yield from _far_origin(target)
    yield from complaints(target)


def _far_origin(target: Target) -> Iterator[str]:
    low, high = target.vertices_m.min(axis=0), target.vertices_m.max(axis=0)
    outside = float(np.linalg.norm(np.maximum(0.0, np.maximum(low, -high))))
    if outside > 0.5 * target.size_m:
        yield (
            f"the frame's origin lies {outside:.2f} m outside the mesh: ranges and poses count from there, and a "
            "camera that points at it may miss the craft; --origin box or --origin X,Y,Z moves it"
        )
