"""Radiance of a point towards the eye: the Sun through its shadow, the light cache, and what a mirror ray sees."""

import numpy as np

from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.geometry.compiled.vectors import dot, minus, over, plus, put, times, triple
from proxnav.rendering.raycast.bsdf import fresnel, ggx, reflectance, table_albedo
from proxnav.rendering.raycast.environment import lobe_radiance
from proxnav.rendering.raycast.light_cache import OFFSET_M
from proxnav.rendering.raycast.mesh import CORNER_NORMAL
from proxnav.rendering.raycast.mip_levels import ALPHA, MATT, METAL, METALLIC, MOMENT
from proxnav.rendering.raycast.surface import (
    FACE_NORMAL,
    FRESNEL,
    MIRROR,
    NORMAL,
    TO_EYE,
    barycentric,
    between,
)
from proxnav.rendering.raycast.texels import EMISSION, IOR


@ray_kernel
def sun_rays(triangle, position, eye, normals, sun, which, origins, directions):
    """Fills a ray towards each hit's point `sun` (n, 3) of the disc and the hit's index; returns their number.

    Sides that turn away from the Sun need none.
    """
    count = 0
    for i in range(position.shape[0]):
        n, d, p = normals[triangle[i]], sun[i], position[i]
        side = 1.0 if dot(n, minus(eye, p)) >= 0.0 else -1.0
        if side * dot(n, d) <= 0.0:
            continue
        put(origins[count], 0, plus(p, OFFSET_M * side, n))
        put(directions[count], 0, d)
        which[count] = i
        count += 1
    return count


@ray_kernel
def mirror_rays(position, surface, which, origins, directions):
    """Fills the reflected ray of each hit whose material asks for one, and the hit's index; returns their number."""
    count = 0
    for i in range(position.shape[0]):
        s = surface[i]
        if s[MIRROR] <= 0.0:
            continue
        normal, face, to_eye = triple(s, NORMAL), triple(s, FACE_NORMAL), triple(s, TO_EYE)
        # a rough lobe leans from the mirrored direction to the normal (S. Lagarde, C. de Rousiers, "Moving Frostbite
        # to physically based rendering", SIGGRAPH 2014, section 4.9.3)
        rough = np.sqrt(s[ALPHA])
        lean = (1.0 - rough) * (np.sqrt(1.0 - rough) + rough)
        ray = minus(times(1.0 - lean + 2.0 * dot(normal, to_eye) * lean, normal), times(lean, to_eye))
        ray = over(ray, np.sqrt(dot(ray, ray)))
        # a bump may reflect into the surface itself: graze it instead
        ray = plus(ray, max(0.0, 1e-3 - dot(ray, face)), face)
        put(origins[count], 0, plus(position[i], OFFSET_M, face))
        put(directions[count], 0, over(ray, np.sqrt(dot(ray, ray))))
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
        normal, to_eye = triple(s, NORMAL), triple(s, TO_EYE)
        nl, nv = dot(normal, sun), dot(normal, to_eye)
        if nl <= 0.0 or nv <= 0.0:
            continue
        half = plus(to_eye, 1.0, sun)
        nh = min(1.0, dot(normal, half) / np.sqrt(dot(half, half)))
        alpha = np.sqrt(s[ALPHA] * s[ALPHA] + alpha_sun2)  # the disc widens the lobe of a smooth surface
        reflectance(nl, nv, nh, s[MATT : MATT + 3], s[METAL : METAL + 3], s[METALLIC], alpha, s[FRESNEL], f)
        for c in range(3):
            radiance[i, c] += lit[i] * nl * irradiance[c] * f[c]


@ray_kernel
def shade_emission(triangle, part, parts, radiance):
    """Adds what the surfaces emit."""
    for i in range(triangle.shape[0]):
        p = parts[part[triangle[i]]]
        for c in range(3):
            radiance[i, c] += p[EMISSION + c]


@ray_kernel
def shade_ambient(triangle, weights, surface, mesh_cache, usable, indirect, table, radiance):
    """Adds the diffuse reflection of the light cache, and the part of the gloss that needs no mirror ray."""
    E = np.empty(3)
    for i in range(triangle.shape[0]):
        s = surface[i]
        _interpolate(mesh_cache[triangle[i]], weights[i], indirect, usable, E)
        gloss = _gloss(s, table) * (1.0 - s[MIRROR])
        for c in range(3):
            diffuse = (1.0 - s[FRESNEL]) * s[MATT + c]
            mirror = gloss * ((1.0 - s[METALLIC]) * s[FRESNEL] + s[METAL + c])
            radiance[i, c] += (diffuse + mirror) * E[c] / np.pi


@ray_kernel
def _gloss(s, table):
    """Share of the light from the eye's direction that the lobe of a surface reflects."""
    return table_albedo(table, max(dot(triple(s, NORMAL), triple(s, TO_EYE)), 1e-3), s[ALPHA])


@ray_kernel
def shade_mirror(
    which, directions, seen, origins, corners, mesh_cache, part, parts, means, usable, indirect, sun_seen, sun,
    irradiance, surface, sky, lobes, table, radiance,
):  # fmt: skip
    """Adds what the mirror rays see: the target, shaded by the means of its parts, else Earth and sky over the lobe."""
    L, w, E, S = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for j in range(which.shape[0]):
        i = which[j]
        s = surface[i]
        f = seen[j]
        if f >= 0:
            origin, ray = times(1.0, origins[j]), times(1.0, directions[j])  # in float64
            barycentric(corners[f], origin, ray, w)
            _interpolate(mesh_cache[f], w, indirect, usable, E)
            _interpolate(mesh_cache[f], w, sun_seen, usable, S)
            _shade_reflected(
                corners[f], w, ray, parts[part[f]], means[part[f]], E, S[0], sun, irradiance, sky, lobes, table, L
            )
        else:
            lobe_radiance(sky, lobes, triple(directions[j], 0), s[ALPHA], L)
        gloss = _gloss(s, table) * s[MIRROR]
        for c in range(3):
            radiance[i, c] += gloss * ((1.0 - s[METALLIC]) * s[FRESNEL] + s[METAL + c]) * L[c]


@ray_kernel
def _shade_reflected(corners, w, ray, part, mean, E, seen, sun, irradiance, sky, lobes, table, L):
    """Fills `L` (3) with the radiance against `ray` of a point seen in a mirror; its own gloss shows the open sky."""
    n = between(corners, CORNER_NORMAL, w)
    n = over(n, max(np.sqrt(dot(n, n)), 1e-9))
    nv = -dot(n, ray)
    if nv < 0.0:
        n, nv = times(-1.0, n), -nv
    nv = max(nv, 1e-2)
    alpha = min(max(np.sqrt(mean[ALPHA] * mean[ALPHA] + 2.0 * mean[MOMENT]), 1e-2), 1.0)
    F = fresnel(nv, part[IOR])
    onward = plus(ray, 2.0 * nv, n)
    lobe_radiance(sky, lobes, over(onward, np.sqrt(dot(onward, onward))), alpha, L)
    albedo = table_albedo(table, nv, alpha)
    nl, lobe = dot(n, sun), 0.0
    if nl > 0.0 and seen > 0.0:
        half = minus(sun, ray)
        lobe = ggx(nl, nv, min(1.0, dot(n, half) / np.sqrt(dot(half, half))), alpha)
    for c in range(3):
        sunlight = irradiance[c] * seen * max(nl, 0.0)
        matt = (1.0 - F) * mean[MATT + c] * (E[c] + sunlight) / np.pi
        gloss = (1.0 - mean[METALLIC]) * F + mean[METAL + c]
        L[c] = part[EMISSION + c] + matt + gloss * (albedo * L[c] + lobe * sunlight)
