"""Forces that an engine holds over a step, made implicit: the end of the step is felt as mass that bodies gain.

An engine that asks for forces once a step would need steps far below u_y / v for bristles as stiff as F / u_y. So the
force on an element is taken where the step will end, and straight from there to where its bristle is not stretched:

    F_1 = F - K (q_1 - q),    q_1 - q = (s h + tau) (v_1 - v),
    K = |F| / |q| (1 - n n^T) + |F| / (n . q) n n^T

with F and q (see `planar_friction.drive`) at the place p + h v that the element would reach in the step h with a
velocity v that is foreseen, s = 1 below the yield and u_y / |stretch| beyond it. The slope is that of the bristle below
the yield and the secant beyond it: never too small and never opposite to the motion, so that no step is too long to
stand. Along the normal n of an element of which one side alone is loaded the force ends where n . q does. As
v_1 - v = h a for the v at the start,

    F_1 = F - M a,    M = h (s h + tau) K,

the step with F and with an inertia M at each element, in addition to the body's own, ends where F_1 acts. With a
foreseen change of v what the added inertia takes up is that of the difference alone.

Arguments that they share:

    poses       (bodies, 6, 3) of the bodies in the frame of the bed, see `space_law`
    bristle     record BRISTLE: the constants of the static friction
    step        h (s)
    wrench      (bodies, 6) force (N) and moment (N m) about the reference point of a body, frame of the bed
    arms        (bodies, 3) m from the point about which an engine has twists to the reference point, world frame
    added       (bodies, 6, 6) inertia that is added, for twists about that point: angular, then linear; world frame
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, room1
from granular_contact.jit.records import record_dtype

# Of a clock: length of the step (s); how long the one took that ended here (s), 0 if none did; else whether a motion
# begins here, with the friction state at rest.
STEP, PASSED, BEGINS = 0, 1, 2
# The constants of `friction`, and whether a law opposes components of the motion one by one.
_NUMBERS = [("u_y", "f8"), ("tau", "f8"), ("v_eps", "f8"), ("pressed", "f8")]
BRISTLE = record_dtype([*_NUMBERS, ("friction", "i8"), ("parted", "?")])


@part
def place_bodies(numbers, tops, positions, rotations, centres, twists, turn, poses, arms):
    """Fill poses and arms from the state of an engine's bodies.

    numbers (bodies,): theirs among those of the engine; positions (all, 3) m, rotations (all, 9); twists (bodies, 6):
    angular velocity (rad/s), and velocity (m/s) of what of the body is at the point centres[tops] (all, 3) m. All in
    the world frame; turn (3, 3) as of `space_bodies`.
    """
    for b in range(numbers.shape[0]):
        x, R, c, V = positions[numbers[b]], rotations[numbers[b]], centres[tops[b]], twists[b]
        rx, ry, rz = x[0] - c[0], x[1] - c[1], x[2] - c[2]
        vx, vy, vz = V[3] + V[1] * rz - V[2] * ry, V[4] + V[2] * rx - V[0] * rz, V[5] + V[0] * ry - V[1] * rx
        pose = poses[b]
        arms[b, 0], arms[b, 1], arms[b, 2] = rx, ry, rz
        for i in range(3):
            t0, t1, t2 = turn[i, 0], turn[i, 1], turn[i, 2]
            for j in range(3):
                pose[i, j] = t0 * R[j] + t1 * R[3 + j] + t2 * R[6 + j]
            pose[3, i] = t0 * x[0] + t1 * x[1] + t2 * x[2]
            pose[4, i] = t0 * vx + t1 * vy + t2 * vz
            pose[5, i] = t0 * V[0] + t1 * V[1] + t2 * V[2]


@part
def gather_twists(last, parents, axes, v, twists):
    """Fill twists (bodies, 6) of bodies from the rates v (m,) of a tree: axes (m, 6) of its degrees of freedom.

    last (bodies,): the last degree of freedom that moves a body, -1 if none does; parents (m,): the one before each.
    """
    for b in range(last.shape[0]):
        for k in range(6):
            twists[b, k] = 0.0
        i = last[b]
        while i >= 0:
            for k in range(6):
                twists[b, k] += axes[i, k] * v[i]
            i = parents[i]


@part
def advance(pose, then, step, out):
    """Fill a pose (6, 3) with where a body at a pose is after a step with the velocities of the pose `then`."""
    wx, wy, wz = step * then[5, 0], step * then[5, 1], step * then[5, 2]
    angle = math.sqrt(wx * wx + wy * wy + wz * wz)
    a = math.sin(angle) / angle if angle > 1e-9 else 1.0
    b = (1.0 - math.cos(angle)) / (angle * angle) if angle > 1e-4 else 0.5
    for j in range(3):
        x, y, z = pose[0, j], pose[1, j], pose[2, j]
        cx, cy, cz = wy * z - wz * y, wz * x - wx * z, wx * y - wy * x
        out[0, j] = x + a * cx + b * (wy * cz - wz * cy)
        out[1, j] = y + a * cy + b * (wz * cx - wx * cz)
        out[2, j] = z + a * cz + b * (wx * cy - wy * cx)
        out[3, j] = pose[3, j] + step * then[4, j]
        out[4, j], out[5, j] = then[4, j], then[5, j]


@part
def to_world(turn, x, y, z):
    """A vector (3,) of the bed's frame in the world's."""
    return (
        turn[0, 0] * x + turn[1, 0] * y + turn[2, 0] * z,
        turn[0, 1] * x + turn[1, 1] * y + turn[2, 1] * z,
        turn[0, 2] * x + turn[1, 2] * y + turn[2, 2] * z,
    )


@part
def add_inertia(mass, nx, ny, nz, x, y, z, added):
    """Add a mass (kg) at a place (m) that is felt along n alone to the upper triangle of an added inertia (6, 6)."""
    a, b, c = y * nz - z * ny, z * nx - x * nz, x * ny - y * nx
    d, e, f, g = mass * nx, mass * ny, mass * nz, mass * a
    h, i = mass * b, mass * c
    added[0, 0] += g * a
    added[0, 1] += g * b
    added[0, 2] += g * c
    added[0, 3] += g * nx
    added[0, 4] += g * ny
    added[0, 5] += g * nz
    added[1, 1] += h * b
    added[1, 2] += h * c
    added[1, 3] += h * nx
    added[1, 4] += h * ny
    added[1, 5] += h * nz
    added[2, 2] += i * c
    added[2, 3] += i * nx
    added[2, 4] += i * ny
    added[2, 5] += i * nz
    added[3, 3] += d * nx
    added[3, 4] += d * ny
    added[3, 5] += d * nz
    added[4, 4] += e * ny
    added[4, 5] += e * nz
    added[5, 5] += f * nz


@part
def add_point(mass, x, y, z, added):
    """Add a mass (kg) at a place (m) to the upper triangle of an added inertia (6, 6)."""
    mx, my, mz = mass * x, mass * y, mass * z
    added[0, 0] += my * y + mz * z
    added[1, 1] += mx * x + mz * z
    added[2, 2] += mx * x + my * y
    added[0, 1] -= mx * y
    added[0, 2] -= mx * z
    added[1, 2] -= my * z
    added[0, 4] -= mz
    added[0, 5] += my
    added[1, 3] += mz
    added[1, 5] -= mx
    added[2, 3] -= my
    added[2, 4] += mx
    added[3, 3] += mass
    added[4, 4] += mass
    added[5, 5] += mass


@part
def momentum(added, twist, out):
    """Set out (6,) to the momentum of an added inertia with a twist (6,): force-like first, then about its point."""
    for i in range(6):
        k = 0.0
        for j in range(6):
            k += added[i, j] * twist[j]
        out[i - 3 if i >= 3 else i + 3] = k


@part
def add_to_matrix(last, parents, axes, added, matrix):
    """Add what bodies gained to the mass matrix (m, m) of a tree, its lower triangle.

    last (bodies,), parents and axes as of `gather_twists`.
    """
    y = room1(6)
    for b in range(last.shape[0]):
        if added[b, 5, 5] == 0.0 and added[b, 3, 3] == 0.0 and added[b, 4, 4] == 0.0:
            continue
        i = last[b]
        while i >= 0:
            for k in range(6):
                y[k] = 0.0
                for c in range(6):
                    y[k] += added[b, k, c] * axes[i, c]
            j = i
            while j >= 0:
                for k in range(6):
                    matrix[i, j] += axes[j, k] * y[k]
                j = parents[j]
            i = parents[i]


@kernel(nogil=True)
def add_damping(starts, counts, columns, derivatives, damping, shares, matrix):
    """Add to a mass matrix (m, m) what is implicit of other forces: shares (2,), of derivatives and of damping (m,).

    derivatives: by rates, sparse: row i has counts[i] of them from starts[i] on, in these columns.
    """
    for i in range(damping.shape[0]):
        matrix[i, i] += shares[1] * damping[i]
        if shares[0] != 0.0:
            for k in range(starts[i], starts[i] + counts[i]):
                matrix[i, columns[k]] += shares[0] * derivatives[k]


@part
def solve_symmetric(matrix, x):
    """Solve A y = x, y in place of x (m,), for a positive definite A (m, m); its lower triangle is overwritten.

    As A = L^T D L, from the last row to the first (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.5):
    of a tree, whose freedoms stand after those that carry them, no zero fills in, and zeros are passed over.
    """
    m = x.shape[0]
    for k in range(m - 1, -1, -1):
        for i in range(k - 1, -1, -1):
            if matrix[k, i] == 0.0:
                continue
            share = matrix[k, i] / matrix[k, k]
            for j in range(i + 1):
                matrix[i, j] -= share * matrix[k, j]
            matrix[k, i] = share
            x[i] -= share * x[k]
        x[k] /= matrix[k, k]
    for k in range(m):
        for i in range(k):
            x[k] -= matrix[k, i] * x[i]


@part
def foreseen_load(turn, wrench, arms, added, past, step, foreseen):
    """Fill foreseen (bodies, 6), force and moment about the points of twists, world frame; whether there is any wrench.

    The wrench where the step is foreseen to end, and what the added inertia takes up of the gain past (bodies, 6) of
    twists that was foreseen.
    """
    p, some = room1(6), False
    for b in range(wrench.shape[0]):
        fx, fy, fz = to_world(turn, wrench[b, 0], wrench[b, 1], wrench[b, 2])
        mx, my, mz = to_world(turn, wrench[b, 3], wrench[b, 4], wrench[b, 5])
        x, y, z = arms[b, 0], arms[b, 1], arms[b, 2]
        momentum(added[b], past[b], p)
        w = foreseen[b]
        w[0], w[1], w[2] = fx + p[0] / step, fy + p[1] / step, fz + p[2] / step
        w[3] = mx + y * fz - z * fy + p[3] / step
        w[4] = my + z * fx - x * fz + p[4] / step
        w[5] = mz + x * fy - y * fx + p[5] / step
        for k in range(6):
            some = some or wrench[b, k] != 0.0
    return some


@part
def about(w, x, y, z, out):
    """Set a wrench (6,) to be about a point at x, y, z (m) from the point that w (6,) is about."""
    out[0], out[1], out[2] = w[0], w[1], w[2]
    out[3] = w[3] - y * w[2] + z * w[1]
    out[4] = w[4] - z * w[0] + x * w[2]
    out[5] = w[5] - x * w[1] + y * w[0]


@part
def load_error(numbers, tops, inertial, centres, added, gained, foreseen, step, loads, error):
    """Fill error (bodies, 6), about the points of twists: what a step's loads (bodies, 6) lack where it ended.

    gained (bodies, 6): of twists, in a step with these loads, which are about centres of mass inertial (all, 3) m.
    """
    p, q = room1(6), room1(6)
    for b in range(numbers.shape[0]):
        n, c = numbers[b], centres[tops[b]]
        about(loads[b], c[0] - inertial[n, 0], c[1] - inertial[n, 1], c[2] - inertial[n, 2], q)
        momentum(added[b], gained[b], p)
        for k in range(6):
            error[b, k] = foreseen[b, k] - p[k] / step - q[k]


@part
def to_freedoms(last, parents, axes, wrenches, out):
    """Fill out (m,) with wrenches (bodies, 6) on bodies as forces along degrees of freedom, see `gather_twists`."""
    out[:] = 0.0
    for b in range(last.shape[0]):
        i = last[b]
        while i >= 0:
            for k in range(6):
                out[i] += axes[i, k] * wrenches[b, k - 3 if k >= 3 else k + 3]
            i = parents[i]


@part
def less_taken_up(b, n, c, inertial, added, change, step, loads, q):
    """Fill q (6,) with loads[b] less what the added inertia takes up of a change (bodies, 6) of twists.

    About the centre of mass, inertial[n]; loads (bodies, 6), added and twists are about c (3,) m.
    """
    p = room1(6)
    momentum(added[b], change[b], p)
    for k in range(6):
        p[k] = loads[b, k] - p[k] / step
    about(p, inertial[n, 0] - c[0], inertial[n, 1] - c[1], inertial[n, 2] - c[2], q)


@part
def correct_loads(numbers, tops, inertial, centres, added, change, step, error, loads):
    """Add to loads (bodies, 6) their error less what the added inertia takes up of a change (bodies, 6) of twists."""
    q = room1(6)
    for b in range(numbers.shape[0]):
        less_taken_up(b, numbers[b], centres[tops[b]], inertial, added, change, step, error, q)
        for k in range(6):
            loads[b, k] += q[k]


@part
def extrapolated(numbers, tops, inertial, centres, added, past, foreseen, step, loads, slopes):
    """Fill slopes (bodies, 6) with what the added inertia makes of the loads (bodies, 6), about the same points.

    That is the part which was not found where a step was foreseen to end, but along its slope from there.
    """
    q = room1(6)
    for b in range(numbers.shape[0]):
        less_taken_up(b, numbers[b], centres[tops[b]], inertial, added, past, step, foreseen, q)
        for k in range(6):
            slopes[b, k] = loads[b, k] - q[k]


@part
def end_step(numbers, tops, inertial, centres, loads, twists, now, passed, works, gained):
    """End of a step that took a time (s): work (J) of the loads (bodies, 6) is added to works (bodies,).

    On the mean of the twists (bodies, 6) at its start and now; gained is filled with their difference.
    """
    for b in range(numbers.shape[0]):
        n, c = numbers[b], centres[tops[b]]
        x, y, z = inertial[n, 0] - c[0], inertial[n, 1] - c[1], inertial[n, 2] - c[2]
        power = 0.0
        for V in (twists[b], now[b]):
            vx, vy, vz = V[3] + V[1] * z - V[2] * y, V[4] + V[2] * x - V[0] * z, V[5] + V[0] * y - V[1] * x
            power += loads[b, 0] * vx + loads[b, 1] * vy + loads[b, 2] * vz
            power += loads[b, 3] * V[0] + loads[b, 4] * V[1] + loads[b, 5] * V[2]
        works[b] += 0.5 * passed * power
        for k in range(6):
            gained[b, k] = now[b, k] - twists[b, k]


@part
def blank(seen):
    """Begin to see bodies anew, see `space_law.DEPTH`."""
    for b in range(seen.shape[0]):
        seen[b, 0], seen[b, 1], seen[b, 2] = -np.inf, 0.0, np.inf


@part
def foresee(poses, sizes, speed, twists, gained, share, later, wrench, added):
    """Where a step leads if twists gain what they gained in the one before: that in share, their sum in later.

    Only as much of it as leaves half of a twist, so that nothing turns round that only comes to rest; and little of it
    below a speed (m/s), where bristles bear that do not slide: there it would drive what it comes too late for. sizes
    (bodies,): how far bodies reach from their reference points (m). Before, later has the twists of now; they go to
    twists. wrench and added are emptied.
    """
    clear(wrench)
    clear(added)
    for b in range(twists.shape[0]):
        for k in range(6):
            twists[b, k] = later[b, k]
        square, along = 0.0, 0.0
        for k in range(6):
            square += twists[b, k] * twists[b, k]
            along += twists[b, k] * gained[b, k]
        part = min(1.0, -0.5 * square / along) if along < 0.0 else 1.0
        square = 0.0
        for k in range(3):
            square += poses[b, 4, k] ** 2 + (sizes[b] * poses[b, 5, k]) ** 2
        part *= square / (square + speed * speed)
        for k in range(6):
            share[b, k] = part * gained[b, k]
            later[b, k] = twists[b, k] + share[b, k]


@part
def farthest(sizes, arms, one, other):
    """Greatest difference of the velocity (m/s) of any point of a body between twists one and other (bodies, 6)."""
    most = 0.0
    for b in range(sizes.shape[0]):
        wx, wy, wz = one[b, 0] - other[b, 0], one[b, 1] - other[b, 1], one[b, 2] - other[b, 2]
        x, y, z = arms[b, 0], arms[b, 1], arms[b, 2]
        turn = math.sqrt(wx * wx + wy * wy + wz * wz)
        vx, vy = one[b, 3] - other[b, 3] + wy * z - wz * y, one[b, 4] - other[b, 4] + wz * x - wx * z
        vz = one[b, 5] - other[b, 5] + wx * y - wy * x
        move = math.sqrt(vx * vx + vy * vy + vz * vz)
        most = max(most, move + sizes[b] * turn)
    return most


@part
def find_base(applied, numbers, written, home, base):
    """Fill base (bodies, 6) where the rows applied[numbers] are not those that were written, nor those of home."""
    for b in range(numbers.shape[0]):
        for k in range(6):
            now = applied[numbers[b], k]
            if now != written[b, k] and (now == 0.0 or now != home[b, k]):
                base[b, k] = now


@kernel(nogil=True)
def write_loads(applied, numbers, base, loads, written):
    """Set the rows applied[numbers], and written, to base and loads together."""
    for b in range(numbers.shape[0]):
        for k in range(6):
            written[b, k] = base[b, k] + loads[b, k]
            applied[numbers[b], k] = written[b, k]
