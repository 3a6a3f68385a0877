"""Area and first moments of the immersed part of a facet, in closed form.

Over the immersed part of a facet of area A, with the depth z, which is linear in the position d,

    int dA = A s,    int z dA = A m,    int d dA = A o,    int z d dA = A p.

A whole triangle with the corners d_i at the depths z_i has s = 1, m = mean(z_i), o = mean(d_i) and
p = (sum z_i sum d_i + sum z_i d_i) / 12. A part with one corner k is a triangle, whose other corners lie at the shares
z_k / (z_k - z_j) of the edges; a part with two corners is the whole triangle minus a part with one. A parallelogram is
two triangles; a whole parallelogram with half edges a and b, along which the depth grows by z_a and z_b, has
p = (z_a a + z_b b) / 3 about its centre.

The part within a layer is the part below its top minus the part below its bottom. The moments of a part below a level
at the depth D, with depths from that level, give the moments with depths from the surface:

    int dA = A s,    int z dA = A (m + D s),    int d dA = A o,    int z d dA = A (p + D o).
"""

from __future__ import annotations

from granular_contact.jit.compiled import part

LEAST = 1e-13  # of a facet in a layer: smaller parts are round-off of the difference


@part
def corner_part(zk, zi, zj, k, i, j):
    """Moments s, m, o (3,), p (3,) of the part of a triangle on that side of the surface on which only corner k lies.

    zk: its depth, of another sign than the depths zi and zj (m) of the other corners; corners (3,) m, o and p from any
    origin.
    """
    s, t = zk / (zk - zi), zk / (zk - zj)
    x = k[0] + (s * (i[0] - k[0]) + t * (j[0] - k[0])) / 3.0
    y = k[1] + (s * (i[1] - k[1]) + t * (j[1] - k[1])) / 3.0
    z = k[2] + (s * (i[2] - k[2]) + t * (j[2] - k[2])) / 3.0
    share, quarter = s * t, 0.25 * s * t * zk / 3.0
    px, py, pz = quarter * (3.0 * x + k[0]), quarter * (3.0 * y + k[1]), quarter * (3.0 * z + k[2])
    return share, share * zk / 3.0, share * x, share * y, share * z, px, py, pz


@part
def triangle_part(za, zb, zc, a, b, c):
    """Moments of the immersed part of a triangle; za, zb, zc (m): depths of its corners a, b, c (3,) m."""
    below = int(za > 0.0) + int(zb > 0.0) + int(zc > 0.0)  # (a sum of numpy booleans is a boolean, in Python)
    if below == 0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    z = (za + zb + zc) / 12.0
    x, y, w = a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]
    px = z * x + (za * a[0] + zb * b[0] + zc * c[0]) / 12.0
    py = z * y + (za * a[1] + zb * b[1] + zc * c[1]) / 12.0
    pz = z * w + (za * a[2] + zb * b[2] + zc * c[2]) / 12.0
    if below == 3:
        return 1.0, 4.0 * z, x / 3.0, y / 3.0, w / 3.0, px, py, pz
    if (zb > 0.0) == (zc > 0.0):
        s, m, ox, oy, oz, qx, qy, qz = corner_part(za, zb, zc, a, b, c)
    elif (za > 0.0) == (zc > 0.0):
        s, m, ox, oy, oz, qx, qy, qz = corner_part(zb, zc, za, b, c, a)
    else:
        s, m, ox, oy, oz, qx, qy, qz = corner_part(zc, za, zb, c, a, b)
    if below == 1:
        return s, m, ox, oy, oz, qx, qy, qz
    return 1.0 - s, 4.0 * z - m, x / 3.0 - ox, y / 3.0 - oy, w / 3.0 - oz, px - qx, py - qy, pz - qz


@part
def parallelogram_part(z, za, zb, a, b):
    """Moments of the immersed part of a parallelogram, about its centre; arguments as in `immersed_part`."""
    d, e = (a[0] + b[0], a[1] + b[1], a[2] + b[2]), (a[0] - b[0], a[1] - b[1], a[2] - b[2])
    back, left = (-d[0], -d[1], -d[2]), (-e[0], -e[1], -e[2])
    s, m, ox, oy, oz, px, py, pz = triangle_part(z + za + zb, z - za - zb, z + za - zb, d, back, e)
    t, n, ux, uy, uz, vx, vy, vz = triangle_part(z + za + zb, z - za + zb, z - za - zb, d, left, back)
    return (
        *(0.5 * (s + t), 0.5 * (m + n)),
        *(0.5 * (ox + ux), 0.5 * (oy + uy), 0.5 * (oz + uz)),
        *(0.5 * (px + vx), 0.5 * (py + vy), 0.5 * (pz + vz)),
    )


@part
def immersed_part(four, z, za, zb, a, b):
    """Moments s, m (m), o (3,) m, p (3,) m2 of the part of a facet below the surface, about its centroid.

    four: whether it is a parallelogram with half edges a and b (3,) m, else a triangle with the corners a, b and
    -a - b; z (m): depth of the centroid; za, zb (m): growth of the depth along a and b. s is 0 if no part is immersed.
    """
    (ax, ay, az), (bx, by, bz), zc = a, b, -za - zb
    if four:
        low = abs(za) + abs(zb)
        high = low
    else:
        low, high = -min(za, min(zb, zc)), max(za, max(zb, zc))
    if z >= low and z > 0.0:
        if four:
            third = 1.0 / 3.0
            return (
                *(1.0, z, 0.0, 0.0, 0.0),
                *(third * (za * ax + zb * bx), third * (za * ay + zb * by), third * (za * az + zb * bz)),
            )
        k = 1.0 / 12.0
        px, py = za * ax + zb * bx + zc * (-ax - bx), za * ay + zb * by + zc * (-ay - by)
        return 1.0, z, 0.0, 0.0, 0.0, k * px, k * py, k * (za * az + zb * bz + zc * (-az - bz))
    if z <= -high:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if four:
        return parallelogram_part(z, za, zb, a, b)
    return triangle_part(z + za, z + zb, z + zc, a, b, (-ax - bx, -ay - by, -az - bz))


@part
def between(four, z, za, zb, a, b, top, bottom):
    """`immersed_part` for the part between the depths top and bottom (m, 0 <= top)."""
    s, m, ox, oy, oz, px, py, pz = immersed_part(four, z - top, za, zb, a, b)
    if s <= 0.0 or bottom <= top:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    m, px, py, pz = m + top * s, px + top * ox, py + top * oy, pz + top * oz
    if z + abs(za) + abs(zb) > bottom:
        t, n, ux, uy, uz, vx, vy, vz = immersed_part(four, z - bottom, za, zb, a, b)
        s, m, ox, oy, oz = s - t, m - n - bottom * t, ox - ux, oy - uy, oz - uz
        px, py, pz = px - vx - bottom * ux, py - vy - bottom * uy, pz - vz - bottom * uz
    if s <= LEAST or m <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return s, s * min(bottom, max(top, m / s)), ox, oy, oz, px, py, pz
