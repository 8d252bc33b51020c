"""From a ray and the triangle that it met to everything that the shading needs about the point, in float64."""

import numpy as np

from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.geometry.compiled.vectors import cross, dot, minus, over, plus, put, times, triple
from proxnav.rendering.raycast.bsdf import MIN_ALPHA, fresnel
from proxnav.rendering.raycast.mesh import CORNER_NORMAL, POSITION, TANGENT_U, TANGENT_V, U, V
from proxnav.rendering.raycast.mip_levels import ALPHA, METALLIC, MOMENT, PLANES, SLOPE_U, SLOPE_V
from proxnav.rendering.raycast.texels import IOR, sample

NORMAL, FACE_NORMAL, TO_EYE = PLANES, PLANES + 3, PLANES + 6
FRESNEL, MIRROR, COLUMNS = PLANES + 9, PLANES + 10, PLANES + 11
"""Places in a surface's row behind those of its texel: shading normal (3), normal of the triangle (3), direction to the
eye (3), Fresnel reflectance, weight of the mirror ray; and the length of the row."""


@ray_kernel
def barycentric(corners, origin, ray, weights):
    """Fills the barycentric weights of the ray's point on the triangle (closest ones for a ray at its very edge)."""
    a = triple(corners[0], POSITION)
    e1, e2 = minus(triple(corners[1], POSITION), a), minus(triple(corners[2], POSITION), a)
    # T. Moeller, B. Trumbore, "Fast, minimum storage ray/triangle intersection", J. Graphics Tools 2(1), 1997
    p, t = cross(ray, e2), minus(origin, a)
    det, q = dot(e1, p), cross(t, e1)
    b1, b2 = dot(t, p) / det, dot(ray, q) / det
    if not (abs(b1) < 1e6 and abs(b2) < 1e6):  # the ray lies in the triangle's plane
        b1, b2 = 1.0 / 3.0, 1.0 / 3.0
    b1, b2 = max(b1, 0.0), max(b2, 0.0)
    excess = max(1.0, b1 + b2)
    weights[1], weights[2] = b1 / excess, b2 / excess
    weights[0] = 1.0 - weights[1] - weights[2]


@ray_kernel
def _between(corners, place, weights):
    """One number of the three corners at a point between them."""
    return weights[0] * corners[0, place] + weights[1] * corners[1, place] + weights[2] * corners[2, place]


@ray_kernel
def between(corners, first, weights):
    """A vector of the three corners at a point between them."""
    return (
        _between(corners, first, weights), _between(corners, first + 1, weights), _between(corners, first + 2, weights)
    )  # fmt: skip


@ray_kernel
def locate(triangle, rays, eye, camera_z, corners, position, depth, weights):
    """Fills position, depth along the camera's z axis (given in target axes) and barycentric weights of each hit."""
    for i in range(triangle.shape[0]):
        c = corners[triangle[i]]
        barycentric(c, eye, rays[i], weights[i])
        p = between(c, POSITION, weights[i])
        put(position[i], 0, p)
        depth[i] = dot(minus(p, eye), camera_z)


@ray_kernel
def describe(
    triangle, position, weights, eye, pixel_rad, corners, normals, tangents, part, texels, levels, parts, surface
):
    """Fills `surface` (n, COLUMNS): the texel, the shading normal with its texture and the Fresnel term at each hit."""
    for i in range(triangle.shape[0]):
        f = triangle[i]
        c, w, s, p = corners[f], weights[i], surface[i], parts[part[f]]
        to_eye = minus(eye, position[i])
        distance = np.sqrt(dot(to_eye, to_eye))
        to_eye = over(to_eye, distance)
        face = triple(normals[f], 0)
        cosine = dot(face, to_eye)
        side = 1.0 if cosine >= 0.0 else -1.0
        normal = times(side, between(c, CORNER_NORMAL, w))
        face = times(side, face)
        length = np.sqrt(dot(normal, normal))
        if length < 1e-6 or dot(normal, to_eye) <= 0.0:
            normal, length = face, 1.0
        normal = over(normal, length)
        # geometric mean of the footprint's two widths on the tilted surface
        footprint = distance * pixel_rad / np.sqrt(max(abs(cosine), 0.05))
        sample(texels, levels, p, _between(c, U, w), _between(c, V, w), footprint, s)
        if s[SLOPE_U] != 0.0 or s[SLOPE_V] != 0.0:
            t = tangents[f]
            bump = plus(plus(normal, s[SLOPE_U], triple(t, TANGENT_U)), s[SLOPE_V], triple(t, TANGENT_V))
            # a bump that turns away from the eye would be unlit: keep it just in view
            bump = plus(bump, max(0.0, 0.02 - dot(bump, to_eye)), to_eye)
            normal = over(bump, np.sqrt(dot(bump, bump)))
        put(s, NORMAL, normal)
        put(s, FACE_NORMAL, face)
        put(s, TO_EYE, to_eye)
        s[ALPHA] = min(max(np.sqrt(s[ALPHA] * s[ALPHA] + 2.0 * s[MOMENT]), MIN_ALPHA), 1.0)
        s[FRESNEL] = fresnel(dot(normal, to_eye), p[IOR])
        strength = (1.0 - s[METALLIC]) * s[FRESNEL] + s[METALLIC]
        s[MIRROR] = _ramp(strength, 0.05, 0.12) * (1.0 - _ramp(s[ALPHA], 0.12, 0.3))


@ray_kernel
def _ramp(x, low, high):
    return min(max((x - low) / (high - low), 0.0), 1.0)
