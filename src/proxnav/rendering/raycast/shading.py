"""Radiance of a point towards the eye: the Sun through its shadow, the light cache, and what a mirror ray sees."""

import numpy as np

from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.rendering.raycast.bsdf import fresnel, ggx, reflectance, table_albedo
from proxnav.rendering.raycast.environment import lobe_radiance
from proxnav.rendering.raycast.light_cache import OFFSET_M
from proxnav.rendering.raycast.surface import barycentric


@ray_kernel
def sun_rays(triangle, position, eye, normals, sun, which, origins, directions):
    """Fills a ray towards each hit's point `sun` (n, 3) of the disc and the hit's index; returns their number.

    Sides that turn away from the Sun need none.
    """
    count = 0
    for i in range(position.shape[0]):
        n, d, p = normals[triangle[i]], sun[i], position[i]
        towards = n[0] * (eye[0] - p[0]) + n[1] * (eye[1] - p[1]) + n[2] * (eye[2] - p[2])
        side = 1.0 if towards >= 0.0 else -1.0
        if side * (n[0] * d[0] + n[1] * d[1] + n[2] * d[2]) <= 0.0:
            continue
        for k in range(3):
            origins[count, k] = p[k] + OFFSET_M * side * n[k]
            directions[count, k] = d[k]
        which[count] = i
        count += 1
    return count


@ray_kernel
def mirror_rays(position, surface, which, origins, directions):
    """Fills the reflected ray of each hit whose material asks for one, and the hit's index; returns their number."""
    count = 0
    for i in range(position.shape[0]):
        s = surface[i]
        if s[15] <= 0.0:
            continue
        nv = s[0] * s[6] + s[1] * s[7] + s[2] * s[8]
        # a rough lobe leans from the mirrored direction to the normal (S. Lagarde, C. de Rousiers, "Moving Frostbite
        # to physically based rendering", SIGGRAPH 2014, section 4.9.3)
        rough = np.sqrt(s[13])
        lean = (1.0 - rough) * (np.sqrt(1.0 - rough) + rough)
        a, b = 1.0 - lean + 2.0 * nv * lean, lean
        rx, ry, rz = a * s[0] - b * s[6], a * s[1] - b * s[7], a * s[2] - b * s[8]
        n = np.sqrt(rx * rx + ry * ry + rz * rz)
        rx, ry, rz = rx / n, ry / n, rz / n
        under = rx * s[3] + ry * s[4] + rz * s[5]
        lift = max(0.0, 1e-3 - under)  # a bump may reflect into the surface itself: graze it instead
        rx, ry, rz = rx + lift * s[3], ry + lift * s[4], rz + lift * s[5]
        n = np.sqrt(rx * rx + ry * ry + rz * rz)
        for k in range(3):
            origins[count, k] = position[i, k] + OFFSET_M * s[3 + k]
        directions[count, 0], directions[count, 1], directions[count, 2] = rx / n, ry / n, rz / n
        which[count] = i
        count += 1
    return count


@ray_kernel
def _interpolate(index, weights, values, usable, out):
    """Fills `out` (3) with the light cache between three points; buried points do not count."""
    total = 0.0
    out[0] = out[1] = out[2] = 0.0
    for k in range(3):
        j = index[k]
        w = weights[k] * usable[j]
        total += w
        for c in range(3):
            out[c] += w * values[j, c]
    for c in range(3):
        out[c] = out[c] / total if total > 1e-6 else 0.0


@ray_kernel
def shade_sun(surface, sun, lit, irradiance, alpha_sun2, radiance):
    """Adds the light of the Sun in direction `sun` (3) that each hit reflects; `lit` (n) is the unshadowed share."""
    f = np.empty(3)
    for i in range(surface.shape[0]):
        if lit[i] <= 0.0:
            continue
        s = surface[i]
        nl = s[0] * sun[0] + s[1] * sun[1] + s[2] * sun[2]
        nv = s[0] * s[6] + s[1] * s[7] + s[2] * s[8]
        if nl <= 0.0 or nv <= 0.0:
            continue
        hx, hy, hz = s[6] + sun[0], s[7] + sun[1], s[8] + sun[2]
        h = np.sqrt(hx * hx + hy * hy + hz * hz)
        nh = min(1.0, (s[0] * hx + s[1] * hy + s[2] * hz) / h)
        alpha = np.sqrt(s[13] * s[13] + alpha_sun2)  # the disc widens the lobe of a smooth surface
        reflectance(nl, nv, nh, s[9:12], s[16:19], s[12], alpha, s[14], f)
        for c in range(3):
            radiance[i, c] += lit[i] * nl * irradiance[c] * f[c]


@ray_kernel
def shade_emission(triangle, part, parts, radiance):
    """Adds what the surfaces emit."""
    for i in range(triangle.shape[0]):
        p = parts[part[triangle[i]]]
        for c in range(3):
            radiance[i, c] += p[5 + c]


@ray_kernel
def shade_ambient(triangle, weights, surface, mesh_cache, usable, indirect, table, radiance):
    """Adds the diffuse reflection of the light cache, and the part of the gloss that needs no mirror ray."""
    E = np.empty(3)
    for i in range(triangle.shape[0]):
        s = surface[i]
        _interpolate(mesh_cache[triangle[i]], weights[i], indirect, usable, E)
        nv = max(s[0] * s[6] + s[1] * s[7] + s[2] * s[8], 1e-3)
        gloss = table_albedo(table, nv, s[13]) * (1.0 - s[15])
        for c in range(3):
            diffuse = (1.0 - s[14]) * s[9 + c]
            mirror = gloss * ((1.0 - s[12]) * s[14] + s[16 + c])
            radiance[i, c] += (diffuse + mirror) * E[c] / np.pi


@ray_kernel
def shade_mirror(
    which, directions, seen, origins, corners, mesh_cache, part, parts, means, usable, indirect, sun_seen, sun,
    irradiance, surface, sky, lobes, table, radiance,
):  # fmt: skip
    """Adds what the mirror rays see: the target, shaded by the means of its parts, else Earth and sky over the lobe."""
    L, w, origin, ray = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    E, S = np.empty(3), np.empty(3)
    for j in range(which.shape[0]):
        i = which[j]
        s = surface[i]
        f = seen[j]
        if f >= 0:
            for k in range(3):
                origin[k], ray[k] = origins[j, k], directions[j, k]
            barycentric(corners[f], origin, ray, w)
            _interpolate(mesh_cache[f], w, indirect, usable, E)
            _interpolate(mesh_cache[f], w, sun_seen, usable, S)
            _shade_reflected(
                corners[f], w, ray, parts[part[f]], means[part[f]], E, S[0], sun, irradiance, sky, lobes, table, L
            )
        else:
            lobe_radiance(sky, lobes, directions[j, 0], directions[j, 1], directions[j, 2], s[13], L)
        nv = max(s[0] * s[6] + s[1] * s[7] + s[2] * s[8], 1e-3)
        gloss = table_albedo(table, nv, s[13]) * s[15]
        for c in range(3):
            radiance[i, c] += gloss * ((1.0 - s[12]) * s[14] + s[16 + c]) * L[c]


@ray_kernel
def _shade_reflected(corners, w, ray, part, mean, E, seen, sun, irradiance, sky, lobes, table, L):
    """Fills `L` (3) with the radiance against `ray` of a point seen in a mirror; its own gloss shows the open sky."""
    nx = w[0] * corners[0, 3] + w[1] * corners[1, 3] + w[2] * corners[2, 3]
    ny = w[0] * corners[0, 4] + w[1] * corners[1, 4] + w[2] * corners[2, 4]
    nz = w[0] * corners[0, 5] + w[1] * corners[1, 5] + w[2] * corners[2, 5]
    n = max(np.sqrt(nx * nx + ny * ny + nz * nz), 1e-9)
    nx, ny, nz = nx / n, ny / n, nz / n
    nv = -(nx * ray[0] + ny * ray[1] + nz * ray[2])
    if nv < 0.0:
        nx, ny, nz, nv = -nx, -ny, -nz, -nv
    nv = max(nv, 1e-2)
    alpha = min(max(np.sqrt(mean[7] * mean[7] + 2.0 * mean[10]), 1e-2), 1.0)
    F = fresnel(nv, part[4])
    x, y, z = ray[0] + 2.0 * nv * nx, ray[1] + 2.0 * nv * ny, ray[2] + 2.0 * nv * nz
    r = np.sqrt(x * x + y * y + z * z)
    lobe_radiance(sky, lobes, x / r, y / r, z / r, alpha, L)
    albedo = table_albedo(table, nv, alpha)
    nl, lobe = nx * sun[0] + ny * sun[1] + nz * sun[2], 0.0
    if nl > 0.0 and seen > 0.0:
        hx, hy, hz = sun[0] - ray[0], sun[1] - ray[1], sun[2] - ray[2]
        h = np.sqrt(hx * hx + hy * hy + hz * hz)
        lobe = ggx(nl, nv, min(1.0, (nx * hx + ny * hy + nz * hz) / h), alpha)
    for c in range(3):
        sunlight = irradiance[c] * seen * max(nl, 0.0)
        matt = (1.0 - F) * mean[c] * (E[c] + sunlight) / np.pi
        gloss = (1.0 - mean[3]) * F + mean[4 + c]
        L[c] = part[5 + c] + matt + gloss * (albedo * L[c] + lobe * sunlight)
