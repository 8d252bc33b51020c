"""From a ray and the triangle that it met to everything that the shading needs about the point, in float64."""

import numpy as np

from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.rendering.raycast.bsdf import MIN_ALPHA, fresnel
from proxnav.rendering.raycast.texels import sample

COLUMNS = 19
"""Of a surface's description: normal 0-2, normal of the triangle 3-5, direction to the eye 6-8, matt colour 9-11,
metallic 12, alpha 13, Fresnel reflectance 14, weight of the mirror ray 15, metal colour 16-18."""


@ray_kernel
def barycentric(corners, origin, ray, weights):
    """Fills the barycentric weights of the ray's point on the triangle (closest ones for a ray at its very edge)."""
    ax, ay, az = corners[0, 0], corners[0, 1], corners[0, 2]
    e1x, e1y, e1z = corners[1, 0] - ax, corners[1, 1] - ay, corners[1, 2] - az
    e2x, e2y, e2z = corners[2, 0] - ax, corners[2, 1] - ay, corners[2, 2] - az
    # T. Moeller, B. Trumbore, "Fast, minimum storage ray/triangle intersection", J. Graphics Tools 2(1), 1997
    px, py, pz = ray[1] * e2z - ray[2] * e2y, ray[2] * e2x - ray[0] * e2z, ray[0] * e2y - ray[1] * e2x
    det = e1x * px + e1y * py + e1z * pz
    tx, ty, tz = origin[0] - ax, origin[1] - ay, origin[2] - az
    qx, qy, qz = ty * e1z - tz * e1y, tz * e1x - tx * e1z, tx * e1y - ty * e1x
    b1 = (tx * px + ty * py + tz * pz) / det
    b2 = (ray[0] * qx + ray[1] * qy + ray[2] * qz) / det
    if not (abs(b1) < 1e6 and abs(b2) < 1e6):  # the ray lies in the triangle's plane
        b1, b2 = 1.0 / 3.0, 1.0 / 3.0
    b1, b2 = max(b1, 0.0), max(b2, 0.0)
    excess = max(1.0, b1 + b2)
    weights[1], weights[2] = b1 / excess, b2 / excess
    weights[0] = 1.0 - weights[1] - weights[2]


@ray_kernel
def locate(triangle, rays, eye, camera_z, corners, position, depth, weights):
    """Fills position, depth along the camera's z axis (given in target axes) and barycentric weights of each hit."""
    for i in range(triangle.shape[0]):
        c = corners[triangle[i]]
        barycentric(c, eye, rays[i], weights[i])
        z = 0.0
        for k in range(3):
            position[i, k] = weights[i, 0] * c[0, k] + weights[i, 1] * c[1, k] + weights[i, 2] * c[2, k]
            z += (position[i, k] - eye[k]) * camera_z[k]
        depth[i] = z


@ray_kernel
def describe(
    triangle, position, weights, eye, pixel_rad, corners, normals, tangents, part, texels, levels, parts, surface
):
    """Fills `surface` (n, 19): shading normal with its texture, material and Fresnel term at each hit."""
    m = np.empty(12)
    for i in range(triangle.shape[0]):
        f = triangle[i]
        c, w, s, p = corners[f], weights[i], surface[i], parts[part[f]]
        vx, vy, vz = eye[0] - position[i, 0], eye[1] - position[i, 1], eye[2] - position[i, 2]
        distance = np.sqrt(vx * vx + vy * vy + vz * vz)
        vx, vy, vz = vx / distance, vy / distance, vz / distance
        gx, gy, gz = normals[f, 0], normals[f, 1], normals[f, 2]
        cosine = gx * vx + gy * vy + gz * vz
        side = 1.0 if cosine >= 0.0 else -1.0
        nx = side * (w[0] * c[0, 3] + w[1] * c[1, 3] + w[2] * c[2, 3])
        ny = side * (w[0] * c[0, 4] + w[1] * c[1, 4] + w[2] * c[2, 4])
        nz = side * (w[0] * c[0, 5] + w[1] * c[1, 5] + w[2] * c[2, 5])
        gx, gy, gz = side * gx, side * gy, side * gz
        n = np.sqrt(nx * nx + ny * ny + nz * nz)
        if n < 1e-6 or nx * vx + ny * vy + nz * vz <= 0.0:
            nx, ny, nz, n = gx, gy, gz, 1.0
        nx, ny, nz = nx / n, ny / n, nz / n
        u = w[0] * c[0, 6] + w[1] * c[1, 6] + w[2] * c[2, 6]
        v = w[0] * c[0, 7] + w[1] * c[1, 7] + w[2] * c[2, 7]
        # geometric mean of the footprint's two widths on the tilted surface
        footprint = distance * pixel_rad / np.sqrt(max(abs(cosine), 0.05))
        sample(texels, levels, p, u, v, footprint, m)
        if m[8] != 0.0 or m[9] != 0.0:
            t = tangents[f]
            bx = nx + m[8] * t[0] + m[9] * t[3]
            by = ny + m[8] * t[1] + m[9] * t[4]
            bz = nz + m[8] * t[2] + m[9] * t[5]
            # a bump that turns away from the eye would be unlit: keep it just in view
            facing = bx * vx + by * vy + bz * vz
            lift = max(0.0, 0.02 - facing)
            bx, by, bz = bx + lift * vx, by + lift * vy, bz + lift * vz
            n = np.sqrt(bx * bx + by * by + bz * bz)
            nx, ny, nz = bx / n, by / n, bz / n
        s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8] = nx, ny, nz, gx, gy, gz, vx, vy, vz
        s[9], s[10], s[11], s[12] = m[0], m[1], m[2], m[3]
        s[16], s[17], s[18] = m[4], m[5], m[6]
        alpha = max(np.sqrt(m[7] * m[7] + 2.0 * m[10]), MIN_ALPHA)
        s[13] = min(alpha, 1.0)
        F = fresnel(nx * vx + ny * vy + nz * vz, p[4])
        s[14] = F
        strength = (1.0 - m[3]) * F + m[3]
        s[15] = _ramp(strength, 0.05, 0.12) * (1.0 - _ramp(s[13], 0.12, 0.3))


@ray_kernel
def _ramp(x, low, high):
    return min(max((x - low) / (high - low), 0.0), 1.0)
