"""Every state from all measurements: forward filter, then Rauch, Tung and Striebel backwards on tangent errors.

H. Rauch, F. Tung, C. Striebel, "Maximum likelihood estimates of linear dynamic systems", AIAA Journal 3(8), 1965.
For reports and for labels where nobody knows the truth; it keeps a covariance per reading instant (40 kB each).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from proxnav.navigation.belief import Belief, Scene, nav_state
from proxnav.navigation.events import Event, apply, events
from proxnav.navigation.kernels.prediction import corrected, relative_error
from proxnav.navigation.layout import CORE
from proxnav.navigation.observe import in_target_axes, lasting_of_keypoints, lasting_of_pose
from proxnav.navigation.propagate import Step, propagate
from proxnav.records import NavState, SensorRecords


@dataclass(frozen=True, slots=True, eq=False)
class _Node:
    """Filtered belief at one instant and the way to the next: its prediction and the transition to it."""

    belief: Belief
    predicted: Belief
    F: np.ndarray
    d: np.ndarray


def smooth(records: SensorRecords, scene: Scene) -> list[NavState]:
    """Smoothed states at the instants of fixes and frames, since the filter's last start."""
    nodes, last = _forward(events(records, scene), scene)
    beliefs = [last]
    x, P = last.x, last.P
    for node in reversed(nodes):
        x, P = _back(node, x, P)
        beliefs.append(replace(node.belief, x=x, P=P))
    states = (nav_state(belief, scene) for belief in reversed(beliefs))
    return [state for state in states if state is not None]


def _forward(stream: Sequence[Event], scene: Scene) -> tuple[list[_Node], Belief]:
    """Nodes in order of time; a new start of the filter forgets what was before."""
    ordered = sorted(stream, key=lambda event: event.rank)
    belief = Belief(ordered[0].t if ordered else 0.0)
    nodes: list[_Node] = []
    starts, mark, before, steps = 0, belief, belief, []
    for event in ordered:
        moved: list[Step] = []
        kicked = event.kind == "accelerometer"
        after, _ = apply(belief, event, scene, moved)
        steps.extend(moved)
        if after.starts != starts:
            starts, nodes, steps, mark = after.starts, [], [], after
        elif after.x is not None and not kicked and event.kind != "gyro":
            before = _predicted(belief, event, scene)
            if steps and mark.x is not None:
                nodes.append(_Node(mark, before, *_combined(steps)))
                steps, mark = [], after
            else:
                mark = after
        belief = after
    return nodes, mark


def _predicted(belief: Belief, event: Event, scene: Scene) -> Belief:
    """The belief as it meets the measurement."""
    moved = propagate(belief, event.t, scene)
    if event.kind == "poses" and scene.config.coupling == "loose":
        q, _, cov = event.values
        return lasting_of_pose(moved, in_target_axes(cov, q), scene)
    if event.kind == "keypoints":
        pixels, cov = event.values
        return lasting_of_keypoints(moved, pixels, cov, scene)
    return moved


def _combined(steps: Sequence[Step]) -> tuple[np.ndarray, np.ndarray]:
    F, d = steps[0].F, steps[0].d
    for step in steps[1:]:
        F, d = step.F @ F, step.d * d
    return F, d


def _back(node: _Node, x: np.ndarray | None, P: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """C = P F^T P_pred^-1; e = C (x_s - x_pred); P_s = P + C (P_s' - P_pred) C^T."""
    filtered, predicted = node.belief, node.predicted
    assert x is not None
    assert P is not None
    assert filtered.x is not None
    assert filtered.P is not None
    assert predicted.x is not None
    assert predicted.P is not None
    FP = np.concatenate([node.F @ filtered.P[:CORE], node.d[:, None] * filtered.P[CORE:]])
    scale = np.sqrt(np.diagonal(predicted.P))
    factor = cho_factor(predicted.P / np.outer(scale, scale))
    C = (cho_solve(factor, FP / scale[:, None]) / scale[:, None]).T
    e = C @ relative_error(predicted.x, x)
    smoothed = filtered.P + C @ (P - predicted.P) @ C.T
    return corrected(filtered.x, e), 0.5 * (smoothed + smoothed.T)
