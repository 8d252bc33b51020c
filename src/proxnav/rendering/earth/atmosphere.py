"""Clear air: how much of it there is, what it scatters and absorbs, and tables that depend on nothing else.

Single scattering by Rayleigh and Mie particles and absorption by ozone over exponential profiles, after E. Bruneton and
F. Neyret, "Precomputed atmospheric scattering", EGSR 2008; higher orders as an isotropic source after S. Hillaire,
"A scalable and production ready sky and atmosphere rendering technique", EGSR 2020.
Bands: 600-700, 500-600, 400-500 nm.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32

from proxnav.geometry.celestial import SUN_HALF_ANGLE
from proxnav.geometry.compiled.kernel import fast_kernel, fast_pasted_kernel, kernel
from proxnav.rendering.earth.ellipsoid import A_M, near_hit

TOP_M = 100e3  # m, no air above
R_TOP = A_M + TOP_M
H_RAYLEIGH = 8.0e3  # m, scale height of the air
H_MIE = 1.2e3  # m, scale height of the aerosol
RAYLEIGH = np.array([7.09e-6, 13.94e-6, 31.53e-6])  # 1/m at sea level: 1.24062e-6 / um^4 averaged over each band
AEROSOL_OPTICAL_DEPTH = np.array([0.040, 0.048, 0.058])  # clean continental air, Angstrom exponent 1
MIE_EXTINCTION = AEROSOL_OPTICAL_DEPTH / H_MIE
MIE_ALBEDO = 0.94  # single-scattering albedo
MIE_G = 0.74  # asymmetry
OZONE = np.array([1.30e-6, 1.90e-6, 0.085e-6])  # 1/m at 25 km, tent of half-width 15 km (about 300 Dobson units)
GROUND_ALBEDO = 0.25  # mean, for light that bounces once more before it is scattered

_T_R, _T_MU = 64, 256
_MS_H, _MS_MU = 24, 48
FROM_AIR, FROM_AEROSOL, ISOTROPIC, THROUGH, PATH = 0, 3, 6, 9, 12
"""Places in the row of a path: Rayleigh and Mie light without their phase functions, isotropic higher orders, and the
transmittance of the path, three bands each; and the length of the row."""
SUN_NODES = 1024
SUN_MU_MIN, SUN_MU_MAX = -0.31, 1.0  # to the end of astronomical twilight


class Air(NamedTuple):
    """Tables of the atmosphere."""

    transmittance: Float32[np.ndarray, "r mu band=3"]
    """Transmittance from a point to the top of the atmosphere, ground ignored."""
    multiple: Float32[np.ndarray, "h mu_sun band=3"]
    """Mean radiance of multiply scattered light per unit Sun irradiance [1/sr]."""
    sky_irradiance: Float32[np.ndarray, "sun_nodes band=3"]
    """Irradiance of level ground by the sky per unit Sun irradiance, against the cosine of the Sun's zenith angle."""


@fast_kernel
def densities(h):
    """Relative density of air, aerosol and ozone at altitude h [m]."""
    ozone = max(0.0, 1.0 - abs(h - 25e3) / 15e3)
    return math.exp(-h / H_RAYLEIGH), math.exp(-h / H_MIE), ozone


@fast_kernel
def _exit_distance(r, mu):
    return -r * mu + math.sqrt(max(0.0, r * r * (mu * mu - 1.0) + R_TOP * R_TOP))


@kernel
def _transmittance_table(n_r, n_mu, steps):
    table = np.empty((n_r, n_mu, 3), dtype=np.float32)
    span = math.sqrt(R_TOP * R_TOP - A_M * A_M)
    for i in range(n_r):
        rho = span * i / (n_r - 1)
        r = math.sqrt(rho * rho + A_M * A_M)
        d_min, d_max = R_TOP - r, rho + span
        for j in range(n_mu):
            d = d_min + (d_max - d_min) * j / (n_mu - 1)
            mu = 1.0 if d <= 0.0 else (span * span - rho * rho - d * d) / (2.0 * r * d)
            mu = min(1.0, max(-1.0, mu))
            length = _exit_distance(r, mu)
            tau = np.zeros(3)
            for s in range(steps):
                t = length * (s + 0.5) / steps
                h = max(0.0, math.sqrt(r * r + t * t + 2.0 * r * mu * t) - A_M)
                air, aerosol, ozone = densities(h)
                tau += (air * RAYLEIGH + aerosol * MIE_EXTINCTION + ozone * OZONE) * (length / steps)
            for k in range(3):
                table[i, j, k] = math.exp(-tau[k])
    return table


@fast_pasted_kernel
def _mix(table, i, j, k, w00, w01, w10, w11):
    return w00 * table[i, j, k] + w01 * table[i, j + 1, k] + w10 * table[i + 1, j, k] + w11 * table[i + 1, j + 1, k]


@fast_kernel
def sun_transmittance(table, r, mu):
    """Share of the Sun's light (three bands) that reaches radius r [m] where its zenith angle has cosine mu.

    Zero in Earth's shadow, with a penumbra of the Sun's width.
    """
    horizon = -math.sqrt(max(0.0, 1.0 - (A_M / r) ** 2)) if r > A_M else 0.0
    disc = (mu - horizon) / (2.0 * SUN_HALF_ANGLE) + 0.5  # the disc softens the edge of Earth's shadow
    if disc <= 0.0:
        return 0.0, 0.0, 0.0
    disc = min(1.0, disc)
    span = math.sqrt(R_TOP * R_TOP - A_M * A_M)
    if r >= R_TOP:
        # Above the air the Sun is either clear of it or seen through it from the point where its ray enters.
        b = -r * mu
        closest2 = r * r * (1.0 - mu * mu)
        if mu >= 0.0 or closest2 >= R_TOP * R_TOP:
            return disc, disc, disc
        enter = b - math.sqrt(R_TOP * R_TOP - closest2)
        mu = (r * mu + enter) / R_TOP
        r = R_TOP
    rho = math.sqrt(max(0.0, r * r - A_M * A_M))
    d = max(0.0, _exit_distance(r, mu))
    d_min, d_max = R_TOP - r, rho + span
    x = min(1.0, max(0.0, (d - d_min) / (d_max - d_min))) * (_T_MU - 1)
    y = min(1.0, rho / span) * (_T_R - 1)
    j, i = min(int(x), _T_MU - 2), min(int(y), _T_R - 2)
    fx, fy = x - j, y - i
    w00, w01, w10, w11 = (1 - fy) * (1 - fx), (1 - fy) * fx, fy * (1 - fx), fy * fx
    return (
        disc * _mix(table, i, j, 0, w00, w01, w10, w11),
        disc * _mix(table, i, j, 1, w00, w01, w10, w11),
        disc * _mix(table, i, j, 2, w00, w01, w10, w11),
    )


@fast_kernel
def _multiple_lookup(table, h, mu):
    x = min(1.0, max(0.0, (mu - SUN_MU_MIN) / (SUN_MU_MAX - SUN_MU_MIN))) * (_MS_MU - 1)
    y = math.sqrt(min(1.0, max(0.0, h / TOP_M))) * (_MS_H - 1)
    j, i = min(int(x), _MS_MU - 2), min(int(y), _MS_H - 2)
    fx, fy = x - j, y - i
    w00, w01, w10, w11 = (1 - fy) * (1 - fx), (1 - fy) * fx, fy * (1 - fx), fy * fx
    return (
        _mix(table, i, j, 0, w00, w01, w10, w11),
        _mix(table, i, j, 1, w00, w01, w10, w11),
        _mix(table, i, j, 2, w00, w01, w10, w11),
    )


@fast_kernel
def march(transmittance, multiple, r0, mu, mu_sun0, nu, t_end, steps, out):
    """Light scattered towards the eye along a path through the air, per unit Sun irradiance.

    r0: start radius [m]; mu, mu_sun0: cosines of zenith angle of ray and Sun there; nu: cosine between ray and Sun;
    t_end: length [m] (ends on the ground, on a shell or beyond the air). Fills the row `out` (PATH).
    """
    t_start = 0.0
    if r0 > R_TOP:
        t_start = near_hit(1.0, r0 * mu, R_TOP, r0)
    for k in range(PATH):
        out[k] = 0.0 if k < THROUGH else 1.0
    if t_start < 0.0 or t_end <= t_start:
        return
    t_low = min(max(-r0 * mu, t_start), t_end)  # where the path is lowest
    through0, through1, through2 = 1.0, 1.0, 1.0
    before, after = t_low - t_start, t_end - t_low
    n_before = steps if after <= 0.0 else (0 if before <= 0.0 else steps // 2)
    for s in range(steps):
        # Steps shrink quadratically towards the lowest point, where the air is.
        if s < n_before:
            hi, lo = 1.0 - s / n_before, 1.0 - (s + 1) / n_before
            t, dt = t_low - before * (0.5 * (hi + lo)) ** 2, before * (hi * hi - lo * lo)
        else:
            n_after = steps - n_before
            lo, hi = (s - n_before) / n_after, (s - n_before + 1) / n_after
            t, dt = t_low + after * (0.5 * (hi + lo)) ** 2, after * (hi * hi - lo * lo)
        r = math.sqrt(r0 * r0 + t * t + 2.0 * r0 * mu * t)
        h = max(0.0, r - A_M)
        air, aerosol, ozone = densities(h)
        mu_sun = (r0 * mu_sun0 + t * nu) / r
        sun = sun_transmittance(transmittance, r, mu_sun)
        higher = _multiple_lookup(multiple, h, mu_sun)
        through0 *= _gather(out, 0, through0, dt, air, aerosol, ozone, sun[0], higher[0])
        through1 *= _gather(out, 1, through1, dt, air, aerosol, ozone, sun[1], higher[1])
        through2 *= _gather(out, 2, through2, dt, air, aerosol, ozone, sun[2], higher[2])
    out[THROUGH], out[THROUGH + 1], out[THROUGH + 2] = through0, through1, through2


@fast_kernel
def _gather(out, k, before, dt, air, aerosol, ozone, sun, higher):
    """Adds the light of one step of a path in band k; returns the step's transmittance."""
    scatter_r, scatter_m = RAYLEIGH[k] * air, MIE_ALBEDO * MIE_EXTINCTION[k] * aerosol
    extinction = RAYLEIGH[k] * air + MIE_EXTINCTION[k] * aerosol + OZONE[k] * ozone
    step = math.exp(-extinction * dt)
    through = before * (dt if 1.0 - step < 1e-4 else (1.0 - step) / extinction)
    out[FROM_AIR + k] += scatter_r * sun * through
    out[FROM_AEROSOL + k] += scatter_m * sun * through
    out[ISOTROPIC + k] += (scatter_r + scatter_m) * higher * through
    return step


@fast_pasted_kernel
def rayleigh_phase(nu):
    """Phase function of air [1/sr] at scattering angle arccos(nu)."""
    return 3.0 / (16.0 * math.pi) * (1.0 + nu * nu)


@fast_pasted_kernel
def mie_phase(nu):
    """Cornette-Shanks phase function of aerosol [1/sr]."""
    g2 = MIE_G * MIE_G
    base = 1.0 + g2 - 2.0 * MIE_G * nu
    return 3.0 / (8.0 * math.pi) * (1.0 - g2) * (1.0 + nu * nu) / ((2.0 + g2) * base * math.sqrt(base))


@kernel
def _multiple_table(transmittance, n_h, n_mu, steps):
    """Hillaire's geometric series: second-order light, times 1 / (1 - share that is scattered again)."""
    dark = np.zeros((_MS_H, _MS_MU, 3), dtype=np.float32)
    table = np.empty((n_h, n_mu, 3), dtype=np.float32)
    ones = np.ones((_MS_H, _MS_MU, 3), dtype=np.float32)
    path, again = np.empty(PATH), np.empty(PATH)
    n = 8
    for i in range(n_h):
        r = A_M + 1.0 + TOP_M * (i / (n_h - 1)) ** 2 * 0.999
        for j in range(n_mu):
            mu_sun = SUN_MU_MIN + (SUN_MU_MAX - SUN_MU_MIN) * j / (n_mu - 1)
            sin_sun = math.sqrt(max(0.0, 1.0 - mu_sun * mu_sun))
            second, share = np.zeros(3), np.zeros(3)
            for a in range(n):
                mu = -1.0 + 2.0 * (a + 0.5) / n
                sin = math.sqrt(1.0 - mu * mu)
                for b in range(n):
                    phi = math.pi * (b + 0.5) / n
                    nu = mu * mu_sun + sin * sin_sun * math.cos(phi)
                    ground = near_hit(1.0, r * mu, A_M, r)
                    end = ground if ground > 0.0 else _exit_distance(r, mu)
                    march(transmittance, dark, r, mu, mu_sun, nu, end, steps, path)
                    march(transmittance, ones, r, mu, mu_sun, nu, end, steps, again)
                    mu_ground = (r * mu_sun + end * nu) / A_M
                    g0, g1, g2 = sun_transmittance(transmittance, A_M + 1.0, min(1.0, mu_ground))
                    g = (g0, g1, g2)
                    for k in range(3):
                        second[k] += (path[FROM_AIR + k] + path[FROM_AEROSOL + k]) / (4.0 * math.pi) / (n * n)
                        share[k] += again[ISOTROPIC + k] / (n * n)
                        if ground > 0.0:
                            bounce = GROUND_ALBEDO / math.pi * max(0.0, mu_ground) * g[k]
                            second[k] += path[THROUGH + k] * bounce / (n * n)
            for k in range(3):
                table[i, j, k] = second[k] / (1.0 - min(0.95, share[k]))
    return table


@kernel
def _sky_irradiance_table(transmittance, multiple, n, steps):
    table = np.empty((n, 3), dtype=np.float32)
    path = np.empty(PATH)
    for j in range(n):
        mu_sun = SUN_MU_MIN + (SUN_MU_MAX - SUN_MU_MIN) * j / (n - 1)
        sin_sun = math.sqrt(max(0.0, 1.0 - mu_sun * mu_sun))
        total = np.zeros(3)
        for a in range(8):
            mu = math.sqrt((a + 0.5) / 8.0)  # equal shares of projected solid angle
            sin = math.sqrt(1.0 - mu * mu)
            for b in range(8):
                nu = mu * mu_sun + sin * sin_sun * math.cos(math.pi * (b + 0.5) / 8.0)
                r = A_M + 1.0
                march(transmittance, multiple, r, mu, mu_sun, nu, _exit_distance(r, mu), steps, path)
                for k in range(3):
                    air, aerosol = path[FROM_AIR + k], path[FROM_AEROSOL + k]
                    total[k] += rayleigh_phase(nu) * air + mie_phase(nu) * aerosol + path[ISOTROPIC + k]
        for k in range(3):
            table[j, k] = total[k] * math.pi / 64.0
    return table


@cache
def air() -> Air:
    """The tables of the atmosphere, computed at first use."""
    transmittance = _transmittance_table(_T_R, _T_MU, 256)
    multiple = _multiple_table(transmittance, _MS_H, _MS_MU, 16)
    multiple[:, 0] = 0.0  # night
    coarse = _sky_irradiance_table(transmittance, multiple, 65, 16)
    coarse[0] = 0.0
    x, fine = np.linspace(0.0, 1.0, 65), np.linspace(0.0, 1.0, SUN_NODES)
    sky = np.stack([np.interp(fine, x, coarse[:, k]) for k in range(3)], axis=-1).astype(np.float32)
    return Air(transmittance, multiple, sky)
