"""Noise that the flight itself teaches: how new each pose's error is, and how large accelerations are.

What the error model and the constants say is the prior. Matching covariances to innovations: R. Mehra, "Approaches to
adaptive filtering", IEEE Transactions on Automatic Control 17(5), 1972.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from proxnav.navigation.belief import Memory, Tracking
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.gates import POSE_GATE
from proxnav.navigation.kernels.dynamics import squared_rate
from proxnav.navigation.layout import N_POSE, E, PoseCovariance, X, diagonal
from proxnav.navigation.process_noise import SLOW_ACCELERATION, TURN_SHARE

_PRIOR_FRAMES = 4
"""So many frames weigh as much as the error model: an estimator of another kind is to be known before it is refused."""
_MOST_FRAMES = 100.0
"""So many frames back the poses' errors are remembered: views change within minutes."""
_LEAST_NEW = 0.3
"""Least new share over the model's; a mean of few frames may be anything, even negative."""
_MOST_NEW = 2.0
"""One frame counts as at most this share: what is larger is a wrong pose, not noise."""
_LEAST_LASTING = 0.01
"""Least lasting share over the model's."""
_MEMORY_FRAMES = 60
"""So many frames weigh as much as the model's memory."""
_ALIKE_PER_LOG = 0.18
"""Correlation of neighbouring innovations where errors last e times shorter than the filter thinks, at the model's
shares and a frame a second."""
_LOG_MEMORY = float(np.log(1.0 / 20.0)), float(np.log(2.0))
"""Least and most."""
_SLOW_S = 200.0
"""Over so long the slow acceleration's size is learnt."""
_TURN_S = 100.0
"""Over so long the size of the unmodelled angular acceleration is learnt."""
_LEAST_TURN = 0.05
"""Least angular acceleration over what is assumed at first."""
_MOST_TURN = 1.0
"""Angular acceleration of a free body as a share of its squared rate."""


def white_share(memory: Memory, setup: FilterSetup) -> float:
    """Share of a pose's claimed covariance that is new in each frame."""
    white = setup.config.noise.poses.white_share
    return max(white + memory.new_share, _LEAST_NEW * white)


def lasting_share(memory: Memory, setup: FilterSetup) -> float:
    """Share of a pose's claimed covariance that lasts: what is new beyond the model does not last."""
    share = setup.lasting_pose_share
    if setup.config.coupling == "tight":
        return share
    return max(share - max(memory.new_share, 0.0), _LEAST_LASTING * share)


def taught_by_pose(
    belief: Tracking, y: Float[np.ndarray, "6"], C: PoseCovariance, predicted: PoseCovariance, setup: FilterSetup
) -> Tracking:
    """The belief with what one innovation y teaches of the new share; nothing from a pose that no share explains.

    C: what the pose claims; predicted: covariance of the innovation without the new error. One step of Fisher's scoring
    of log N(y; 0, predicted + share C), weighted by its information in frames whose innovation is the new error alone.
    """
    white, memory = white_share(belief.memory, setup), belief.memory
    if not y @ np.linalg.solve(predicted + max(white, 1.0) * C, y) <= POSE_GATE:
        return belief
    S = predicted + white * C
    A, z = np.linalg.solve(S, C), np.linalg.solve(S, y)
    information = float(np.sum(A * A.T))
    shown = white + float(z @ C @ z - np.trace(A)) / information
    weight = information * white**2 / N_POSE
    count = min(memory.pose_count + weight, _MOST_FRAMES)
    excess = min(shown, _MOST_NEW) - setup.config.noise.poses.white_share
    new = memory.new_share + weight / (count + _PRIOR_FRAMES) * (excess - memory.new_share)
    innovation = np.linalg.solve(np.linalg.cholesky(S), y)
    taught = replace(
        memory, new_share=new, pose_count=count, last_innovation=innovation, log_memory=_log_memory(memory, innovation)
    )
    return replace(belief, memory=taught)


def memory_s(memory: Memory, setup: FilterSetup) -> float:
    """How long the camera's errors last."""
    return setup.lasting_tau_s * float(np.exp(memory.log_memory))


def _log_memory(memory: Memory, innovation: Float[np.ndarray, "6"]) -> float:
    """Logarithm of how long the errors last, in units of the model's time, after one more whitened innovation.

    Neighbours of one sign say that errors change faster than the filter lets them.
    """
    alike = float(innovation @ memory.last_innovation) / N_POSE
    step = alike / (_ALIKE_PER_LOG * (memory.pose_count + _MEMORY_FRAMES))
    return float(np.clip(memory.log_memory - step, *_LOG_MEMORY))


def resized(belief: Tracking, before: Memory, setup: FilterSetup) -> Tracking:
    """The lasting pose error in the size of the share that is learnt now."""
    scale = np.sqrt(lasting_share(belief.memory, setup) / lasting_share(before, setup))
    if scale == 1.0:
        return belief
    x, P = belief.x.copy(), belief.P.copy()
    x[X.pose_translation] *= scale
    x[X.pose_rotation] *= scale
    P[E.pose_error, :] *= scale
    P[:, E.pose_error] *= scale
    return replace(belief, x=x, P=P)


def taught_by_motion(belief: Tracking, dt: float, setup: FilterSetup) -> Memory:
    """The memory after dt: sizes of the slow acceleration and of the unmodelled angular one, towards expected ones.

    Neither slow acceleration falls below its prior's size.
    """
    memory = belief.memory
    shown = np.square(belief.x[X.acceleration]) + belief.P[diagonal(E.acceleration)]
    slow = memory.slow_variance + min(dt / _SLOW_S, 1.0) * (shown - memory.slow_variance)
    slow = np.maximum(slow, np.square(SLOW_ACCELERATION))
    return replace(memory, slow_variance=slow, turn_factor=_turn_factor(belief, dt, float(setup.noise[TURN_SHARE])))


def _turn_factor(belief: Tracking, dt: float, prior: float) -> float:
    """Towards the size that the state shows; unchanged where nothing is left out of Euler's equations."""
    known = belief.memory.turn_factor
    if prior == 0.0:
        return known
    shown = np.square(belief.x[X.turn_acceleration]) + belief.P[diagonal(E.turn_acceleration)]
    ratio = float(np.sqrt(shown.mean())) / (prior * squared_rate(belief.x, belief.P))
    return float(np.clip(known + min(dt / _TURN_S, 1.0) * (ratio - known), _LEAST_TURN, _MOST_TURN / prior))
