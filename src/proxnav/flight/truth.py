"""The truth of a simulated flight: both craft under real forces, the chaser steered along a reference path."""

from dataclasses import dataclass, field, fields
from typing import Literal

import numpy as np
from jaxtyping import Float, Int
from scipy.interpolate import CubicHermiteSpline

from proxnav.errors import InputError
from proxnav.flight.attitude_motion import WobbleConfig, mean_rates, tumble, wobble
from proxnav.flight.orbit_forces import (
    CHASER_DRAG,
    R_CHASER,
    R_TARGET,
    V_CHASER,
    V_TARGET,
    Burn,
    ForceConfig,
    Pair,
    drag,
    fly,
)
from proxnav.geometry import quaternion
from proxnav.geometry.arrays import frozen
from proxnav.geometry.celestial import R_eci_lvlh, R_eci_ric
from proxnav.geometry.pointing import continuous, q_a_cam_looking
from proxnav.geometry.relative_motion import POSITION, VELOCITY, cw_transition, eci_from_ric, ric_from_eci
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records import Trajectory

_DENSITY_SIGMA = 0.2
"""Spread of the logarithm of the air's density from run to run: solar activity is known no better."""
_THRUST_MPS2 = 0.04
"""Acceleration while burning: 1 N on 24 kg."""
_EXECUTION_SIGMA = 0.02
"""Error of a burn per axis, as a share of it: cold gas."""
_POINTING_WOBBLE = WobbleConfig(sigma_deg=0.1, period_s=60.0)
"""Attitude error of the camera about the line to the target."""


@dataclass(frozen=True)
class TumbleConfig:
    """A target that nobody controls."""

    rate_deg_s: tuple[float, float, float] = (0.5, 1.0, 0.3)
    """Inertial rate at the start, target axes."""
    inertia: tuple[float, float, float] = (1.0, 3.0, 3.2)
    """Principal moments along the target axes, up to a common factor, as they are thought to be."""
    inertia_sigma: float = 0.05
    """Relative spread of the real ones from run to run."""


@dataclass(frozen=True)
class TruthConfig:
    """How the truth is made from a reference trajectory."""

    step_s: float = 0.1
    """Between truth samples; the gyro reads once a step."""
    burn_interval_s: float = 600.0
    """The chaser corrects its path so often; 0 lets it drift."""
    target_wobble: WobbleConfig = field(default_factory=lambda: WobbleConfig(0.3, 300.0))
    """Attitude error of the target about its LVLH-fixed attitude."""
    camera_up: Literal["cross_track", "zenith"] = "cross_track"
    """What is up in the picture. The path never lies along the orbit's normal, so the roll stays smooth."""
    tumble: TumbleConfig | None = None
    """None: LVLH-fixed."""


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """States at n regular instants; rates and forces are means over the step before each instant."""

    epoch_utc: str
    t: Float[np.ndarray, "n"]
    """Seconds since the epoch."""
    r_eci_target_m: Float[np.ndarray, "n 3"]
    v_eci_target_mps: Float[np.ndarray, "n 3"]
    r_eci_chaser_m: Float[np.ndarray, "n 3"]
    v_eci_chaser_mps: Float[np.ndarray, "n 3"]
    q_eci_target: Float[np.ndarray, "n wxyz=4"]
    q_eci_cam: Float[np.ndarray, "n wxyz=4"]
    rate_target: Float[np.ndarray, "n 3"]
    """Inertial rate of the target, target axes [rad/s]."""
    rate_cam: Float[np.ndarray, "n 3"]
    """Inertial rate of the camera, camera axes [rad/s]."""
    specific_force: Float[np.ndarray, "n 3"]
    """What a perfect accelerometer reads, camera axes [m/s^2]."""

    def __post_init__(self) -> None:
        n = len(self.t)
        for f in fields(self)[1:]:
            width = {"t": None, "q_eci_target": 4, "q_eci_cam": 4}.get(f.name, 3)
            object.__setattr__(
                self, f.name, frozen(getattr(self, f.name), (n,) if width is None else (n, width), f.name)
            )

    def __len__(self) -> int:
        return len(self.t)

    @property
    def step_s(self) -> float:
        """Time between samples."""
        return float(self.t[1] - self.t[0])

    def every(self, rate_hz: float) -> Int[np.ndarray, "n_taken"]:
        """Indices of samples at that rate, from the first."""
        return np.arange(0, len(self), max(1, round(1.0 / (rate_hz * self.step_s))))

    @property
    def relative(self) -> tuple[Vector3, Vector3]:
        """(rho [m], rho_dot [m/s]) of the chaser in the target's RIC frame."""
        return ric_from_eci(self.r_eci_target_m, self.v_eci_target_mps, self.r_eci_chaser_m, self.v_eci_chaser_mps)

    @property
    def q_cam_target(self) -> QuatWxyz:
        """Attitude of the target in the camera frame."""
        return quaternion.multiply(quaternion.conjugate(self.q_eci_cam), self.q_eci_target)

    @property
    def t_cam_target_m(self) -> Vector3:
        """The target's origin in the camera frame [m]."""
        return quaternion.rotate(quaternion.conjugate(self.q_eci_cam), self.r_eci_target_m - self.r_eci_chaser_m)


def simulate_truth(reference: Trajectory, config: TruthConfig, rng: np.random.Generator) -> Truth:
    """Flies both craft from the reference's first state; burns keep the chaser near the reference's relative path."""
    count = int(np.floor((reference.t[-1] - reference.t[0]) / config.step_s + 1e-9)) + 1
    if count < 2:
        raise InputError(
            f"a simulation needs a trajectory longer than {config.step_s} s, found {len(reference)} instants"
        )
    t = reference.t[0] + config.step_s * np.arange(count)
    forces = _todays_forces(rng)
    states, burns = _steer(reference, t, config, forces, rng)
    target, chaser = (states[:, R_TARGET], states[:, V_TARGET]), (states[:, R_CHASER], states[:, V_CHASER])
    q_eci_target = _target_attitude(t, *target, config, rng)
    q_eci_cam = _camera_attitude(states, config, rng)
    return Truth(
        reference.epoch_utc, t, *target, *chaser, q_eci_target, q_eci_cam,
        rate_target=mean_rates(q_eci_target, config.step_s),
        rate_cam=mean_rates(q_eci_cam, config.step_s),
        specific_force=_specific_force(t, *chaser, q_eci_cam, burns, forces),
    )  # fmt: skip


def _todays_forces(rng: np.random.Generator) -> ForceConfig:
    factor = float(np.exp(_DENSITY_SIGMA * rng.normal()))
    return ForceConfig(density_kg_m3=factor * ForceConfig.density_kg_m3)


def _steer(
    reference: Trajectory,
    t: Float[np.ndarray, "n"],
    config: TruthConfig,
    forces: ForceConfig,
    rng: np.random.Generator,
) -> tuple[Float[np.ndarray, "n 12"], list[Burn]]:
    """States at `t`, and the burns: each aims at the reference's place at the next burn, by Clohessy-Wiltshire."""
    rho, rho_dot = ric_from_eci(
        reference.r_eci_target_m, reference.v_eci_target_mps, reference.r_eci_chaser_m, reference.v_eci_chaser_mps
    )
    path = CubicHermiteSpline(reference.t, rho, rho_dot, axis=0) if len(reference) > 1 else None
    r_t, v_t = reference.r_eci_target_m[0], reference.v_eci_target_mps[0]
    state = np.concatenate([r_t, v_t, *eci_from_ric(r_t, v_t, rho[0], rho_dot[0])])
    every = max(1, round(config.burn_interval_s / config.step_s)) if config.burn_interval_s > 0 else len(t)
    out, burns = np.empty((len(t), 12)), []
    for k in range(0, len(t), every):
        leg = t[k : k + every + 1]
        if config.burn_interval_s > 0 and path is not None and len(leg) > 1:
            burns.append(_aim(state, leg, path, rng))
        states = fly(state, leg, forces, burns[-1:])
        out[k : k + len(leg)], state = states, states[-1]
    return out, burns


def _aim(state: Pair, leg: Float[np.ndarray, "n"], path: CubicHermiteSpline, rng: np.random.Generator) -> Burn:
    """The burn at the start of a leg after which the chaser drifts to the path at its end."""
    r, v = state[R_TARGET], state[V_TARGET]
    rho, rho_dot = ric_from_eci(r, v, state[R_CHASER], state[V_CHASER])
    n = float(np.linalg.norm(np.cross(r, v)) / (r @ r))
    Phi = cw_transition(n, float(leg[-1] - leg[0]))
    wanted = np.linalg.solve(Phi[POSITION, VELOCITY], path(leg[-1]) - Phi[POSITION, POSITION] @ rho)
    dv = (wanted - rho_dot) * (1.0 + _EXECUTION_SIGMA * rng.normal(size=3))
    size = float(np.linalg.norm(dv))
    duration = min(size / _THRUST_MPS2, float(leg[-1] - leg[0]))
    push = R_eci_ric(r, v) @ dv / max(size, 1e-12) * _THRUST_MPS2
    return Burn(float(leg[0]), duration, (float(push[0]), float(push[1]), float(push[2])))


def _target_attitude(
    t: Float[np.ndarray, "n"], r: Vector3, v: Vector3, config: TruthConfig, rng: np.random.Generator
) -> QuatWxyz:
    """q_eci_target of a target at r with velocity v, in ECI."""
    lvlh = quaternion.from_matrix(R_eci_lvlh(r, v))
    if config.tumble is not None:
        rate = np.deg2rad(np.array(config.tumble.rate_deg_s))
        a, b, c = np.array(config.tumble.inertia) * (1.0 + config.tumble.inertia_sigma * rng.normal(size=3))
        return continuous(tumble(lvlh[0], rate, (a, b, c), t))
    errors = wobble(config.target_wobble, config.step_s, len(t), rng)
    return continuous(quaternion.multiply(lvlh, quaternion.exp(errors)))


def _camera_attitude(states: Float[np.ndarray, "n 12"], config: TruthConfig, rng: np.random.Generator) -> QuatWxyz:
    """q_eci_cam of a camera that looks at the target."""
    r, v = states[:, R_TARGET], states[:, V_TARGET]
    axis = {"cross_track": 1, "zenith": 2}[config.camera_up]  # of LVLH, both down
    look = q_a_cam_looking(r - states[:, R_CHASER], -R_eci_lvlh(r, v)[..., axis], v)
    errors = wobble(_POINTING_WOBBLE, config.step_s, len(states), rng)
    return continuous(quaternion.multiply(continuous(look), quaternion.exp(errors)))


def _specific_force(
    t: Float[np.ndarray, "n"], r: Vector3, v: Vector3, q_eci_cam: QuatWxyz, burns: list[Burn], forces: ForceConfig
) -> Vector3:
    """Drag and thrust of the chaser in camera axes [m/s^2], thrust meaned over the step before each instant."""
    felt = drag(r, v, CHASER_DRAG, forces)
    dt = t[1] - t[0]
    for burn in burns:
        near = slice(int(np.searchsorted(t, burn.start_s, "right")), int(np.searchsorted(t, burn.end_s + dt, "right")))
        overlap = np.minimum(t[near], burn.end_s) - np.maximum(t[near] - dt, burn.start_s)
        felt[near] += np.clip(overlap, 0.0, None)[:, None] / dt * np.array(burn.acceleration_eci)
    return quaternion.rotate(quaternion.conjugate(q_eci_cam), felt)
