"""Search over three-point subsets and the competition between the poses that it finds."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.vectors import put, rotate
from proxnav.pose.solve.kernels.p3p import p3p
from proxnav.pose.solve.kernels.refinement import distances, refine
from proxnav.pose.solve.kernels.weights import squared

ENUMERATED = 10  # up to this many keypoints all three-point subsets are tried, beyond it subsets are drawn
MAX_SAMPLES = 1000  # most subsets drawn
CONFIDENCE = 0.9999  # probability of having drawn one subset of inliers, at which drawing stops
MODES = 4  # candidate poses kept after the search
MODE_TRACE = 1.0 + 2.0 * math.cos(math.radians(15.0))  # candidates nearer than this are one mode
SAME_TRACE = 1.0 + 2.0 * math.cos(math.radians(5.0))  # refined poses nearer than this are one optimum


@kernel
def _cost(R, t, X, xy, ray_info, side, gate2, best):
    """Truncated squared error (MSAC) on the plane z = 1; infinite when a point is on the wrong side or above best."""
    total = 0.0
    for i in range(len(X)):
        p = rotate(R, X[i])
        z = p[2] + t[2]
        if z * side <= 0.0:
            return np.inf
        total += min(squared(ray_info[i], (p[0] + t[0]) / z - xy[i, 0], (p[1] + t[1]) / z - xy[i, 1]), gate2)
        if total > best:
            return np.inf
    return total


@kernel
def _trace(A, B):
    """Trace of A^T B: 1 + 2 cos of the angle between two rotations."""
    return np.sum(A * B)


@kernel
def _keep(R, t, cost, modes_R, modes_t, costs):
    """Enters a candidate: it replaces the mode it resembles if it is better, else the worst mode."""
    slot, free = -1, 0
    for k in range(MODES):
        if costs[k] < np.inf and _trace(modes_R[k], R) > MODE_TRACE:
            slot = k
        if costs[k] > costs[free]:
            free = k
    slot = free if slot < 0 else slot
    if cost < costs[slot]:
        modes_R[slot], modes_t[slot], costs[slot] = R, t, cost


@kernel
def search(X, xy, ray_info, side, gate2, modes_R, modes_t, costs):
    """Poses of three-point subsets, all of them or drawn until enough, sorted into distinct modes; how many were tried.

    The draw is the same for the same number of points.
    """
    n = len(X)
    every = n <= ENUMERATED
    rays, three = np.empty((3, 3)), np.empty((3, 3))
    Rs, ts, picks = np.empty((4, 3, 3)), np.empty((4, 3)), np.array([0, 1, 2])
    state, needed, drawn, best = np.uint64(1), MAX_SAMPLES, 0, np.inf
    while every or drawn < needed:
        if not every:
            for m in range(3):
                fresh = False
                while not fresh:
                    state = state * np.uint64(6364136223846793005) + np.uint64(1442695040888963407)
                    picks[m] = np.int64((state >> np.uint64(33)) % np.uint64(n))
                    fresh = (m < 1 or picks[m] != picks[0]) and (m < 2 or picks[m] != picks[1])
        for m in range(3):
            x, y = xy[picks[m], 0], xy[picks[m], 1]
            norm = math.sqrt(1.0 + x * x + y * y)
            put(rays[m], 0, (x / norm, y / norm, 1.0 / norm))
            put(three[m], 0, X[picks[m]])
        worst = np.max(costs)
        for s in range(p3p(three, rays, side, Rs, ts)):
            cost = _cost(Rs[s], ts[s], X, xy, ray_info, side, gate2, worst)
            if cost < np.inf:
                _keep(Rs[s], ts[s], cost, modes_R, modes_t, costs)
            if cost < best:
                best = cost
                share = max(0.0, 1.0 - cost / (n * gate2))  # at most the inlier share
                miss = math.log(max(1e-12, 1.0 - share**3))
                needed = min(needed, max(30, int(math.log(1.0 - CONFIDENCE) / min(miss, -1e-12)) + 1))
        drawn += 1
        if every:
            picks[2] += 1
            if picks[2] == n:
                picks[1] += 1
                if picks[1] == n - 1:
                    picks[0] += 1
                    if picks[0] == n - 2:
                        break
                    picks[1] = picks[0] + 1
                picks[2] = picks[1] + 1
    return drawn


@kernel
def polish(R, t, X, pixels, info, gate_info, lens, side, gate2, loss, k2, widen, d2, use):
    """Alternates gate and refinement, from a wide gate to the final one; returns the truncated cost over all points."""
    n = len(X)
    for step in range(4):
        distances(R, t, X, pixels, gate_info, lens, side, d2)
        limit = gate2 * (widen * widen if step == 0 else 1.0)
        same, count = step > 1, 0
        for i in range(n):
            inside = d2[i] <= limit
            same = same and inside == use[i]
            use[i] = inside
            count += inside
        if same:
            break
        if count < 3 or refine(R, t, X, pixels, info, use, lens, side, loss, k2, 10 if step == 0 else 20) == np.inf:
            break
    distances(R, t, X, pixels, gate_info, lens, side, d2)
    for i in range(n):
        use[i] = d2[i] <= gate2
    distances(R, t, X, pixels, info, lens, side, d2)
    total = 0.0
    for i in range(n):
        total += min(d2[i], gate2)
    return total


@kernel
def compete(modes_R, modes_t, costs, X, pixels, info, gate_info, lens, gate2, loss, k2, widen, use):
    """Polishes every mode; returns (best, its cost, the best that is another optimum or -1, its cost)."""
    n = len(X)
    d2, flags = np.empty(n), np.zeros((MODES, n), dtype=np.bool_)
    refined = np.full(MODES, np.inf)
    limit = np.min(costs) + 0.35 * n * gate2 + 4.0 * gate2
    for k in range(MODES):
        if costs[k] <= limit and costs[k] < np.inf:
            refined[k] = polish(
                modes_R[k], modes_t[k], X, pixels, info, gate_info, lens, 1.0, gate2, loss, k2, widen, d2, flags[k]
            )
    best, rival, rival_cost = int(np.argmin(refined)), -1, np.inf
    for k in range(MODES):
        if k != best and refined[k] < rival_cost and _trace(modes_R[k], modes_R[best]) < SAME_TRACE:
            rival, rival_cost = k, refined[k]
    use[:] = flags[best]
    return best, refined[best], rival, rival_cost
