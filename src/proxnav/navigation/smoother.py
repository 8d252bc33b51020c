"""Every state from all measurements: forward filter, then Rauch, Tung and Striebel backwards on tangent errors.

H. Rauch, F. Tung, C. Striebel, "Maximum likelihood estimates of linear dynamic systems", AIAA Journal 3(8), 1965.
For reports and for labels where nobody knows the truth; it keeps a covariance per reading instant (60 kB each).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from proxnav.navigation.apply import apply
from proxnav.navigation.belief import Belief, Tracking, Waiting, nav_state
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.kernels.error_state import corrected, relative_error
from proxnav.navigation.layout import N_CORE, Covariance, StateVector
from proxnav.navigation.measurements import lasting_of_keypoints, lasting_of_pose, noise_of_pose
from proxnav.navigation.mounting import in_camera_axes
from proxnav.navigation.propagate import Step, predicted
from proxnav.navigation.readings import Acceleration, GyroReading, KeypointFrame, PoseFix, Reading, rank
from proxnav.navigation.stream import readings
from proxnav.records import NavState, SensorRecords


@dataclass(frozen=True, slots=True, eq=False)
class _Node:
    """Filtered belief at one instant and the way to the next: its prediction and the transition to it."""

    filtered: Tracking
    predicted: Tracking
    step: Step


def smooth(records: SensorRecords, setup: FilterSetup) -> list[NavState]:
    """Smoothed states at the instants of fixes and frames, since the filter's last start."""
    mounting = setup.config.mounting
    nodes, last = _forward([in_camera_axes(one, mounting) for one in readings(records, setup)], setup)
    if isinstance(last, Waiting):
        return []
    x, P, beliefs = last.x, last.P, [last]
    for node in reversed(nodes):
        x, P = _back(node, x, P)
        beliefs.append(replace(node.filtered, x=x, P=P))
    return [nav_state(belief, setup) for belief in reversed(beliefs)]


def _forward(stream: Sequence[Reading], setup: FilterSetup) -> tuple[list[_Node], Belief]:
    """Nodes in order of time and the belief after the last; a new start of the filter forgets what was before."""
    ordered = sorted(stream, key=rank)
    belief: Belief = Waiting(ordered[0].t if ordered else 0.0)
    mark: Belief = belief
    nodes: list[_Node] = []
    steps: list[Step] = []
    for reading in ordered:
        after, _ = apply(belief, reading, setup, steps)
        if after.memory.starts != belief.memory.starts:
            nodes, steps, mark = [], [], after
        elif isinstance(belief, Tracking) and not isinstance(reading, GyroReading | Acceleration):
            if steps and isinstance(mark, Tracking):
                nodes.append(_Node(mark, _met(belief, reading, setup), _combined(steps)))
                steps = []
            mark = after
        belief = after
    return nodes, mark


def _met(belief: Tracking, reading: Reading, setup: FilterSetup) -> Tracking:
    """The belief as it meets the measurement."""
    moved = predicted(belief, reading.t, setup)
    if isinstance(reading, PoseFix) and setup.config.coupling == "loose":
        return lasting_of_pose(moved, noise_of_pose(reading, setup), setup)
    if isinstance(reading, KeypointFrame):
        return lasting_of_keypoints(moved, reading, setup)
    return moved


def _combined(steps: Sequence[Step]) -> Step:
    F, d = steps[0].F, steps[0].d
    for step in steps[1:]:
        F, d = step.F @ F, step.d * d
    return Step(F, d)


def _back(node: _Node, x: StateVector, P: Covariance) -> tuple[StateVector, Covariance]:
    """C = P F^T P_pred^-1; e = C (x_s - x_pred); P_s = P + C (P_s' - P_pred) C^T."""
    filtered, predicted, step = node.filtered, node.predicted, node.step
    FP = np.concatenate([step.F @ filtered.P[:N_CORE], step.d[:, None] * filtered.P[N_CORE:]])
    scale = np.sqrt(np.diagonal(predicted.P))
    certain = scale == 0.0  # what this filter takes for known
    scale = np.where(certain, 1.0, scale)
    factor = cho_factor(predicted.P / np.outer(scale, scale) + np.diag(certain))
    C = (cho_solve(factor, FP / scale[:, None]) / scale[:, None]).T
    e = C @ relative_error(predicted.x, x)
    smoothed = filtered.P + C @ (P - predicted.P) @ C.T
    return corrected(filtered.x, e), 0.5 * (smoothed + smoothed.T)
