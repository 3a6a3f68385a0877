"""Contact lines in one medium in one call: friction state, force, tangent, end of a step, active set.

A batch holds lines on any bodies in one medium, so a call from Python, which costs more than the law on a few strips,
is paid once for hundreds of bodies. Arguments that they share:

    system_q, system_v  coordinates (without reference values) and rates of the whole system, views of the engine's
                        memory
    reference           reference values of the system's coordinates
    active              (lines,) whether a line may touch the surface in this step; the others are passed over
    ends                (lines + 1, 2) first station and first coordinate of each line, and the ends of the last
    places              (coordinates, 2) place of each coordinate of a line in the system and among those of the bed
    geometry            stations of all lines, one after another
    lines               (lines,) records of `law`
    profile, medium     see `kernels.lines`; medium (1,)
    anchors             (stations, 2) m, the friction state; (stations, 6) with the ways of `ways`
"""

from __future__ import annotations

import numpy as np

from granular_contact.kernels import lines as one
from granular_contact.kernels.compiled import kernel, part
from granular_contact.kernels.law import TERMS

# Of proximity (lines, 3): depth of the deepest station (m), speed at which one approaches the surface (m/s), greatest
# depth so far (m).
DEEPEST, APPROACH, EVER = 0, 1, 2


@part
def rooms(ends):
    """Room for the longest line: (stations, 2) seven times, (coordinates,) three times."""
    n, m = 0, 0
    for r in range(ends.shape[0] - 1):
        n = max(n, ends[r + 1, 0] - ends[r, 0])
        m = max(m, ends[r + 1, 1] - ends[r, 1])
    return np.empty((7, n, 2)), np.empty((3, m))


@part
def gather(system_q, system_v, reference, places, q, v):
    """Fill q and v with the coordinates at these places of the system."""
    for i in range(places.shape[0]):
        at = places[i, 0]
        q[i] = system_q[at] + reference[at]
        v[i] = system_v[at]


@kernel
def reset_friction(system_q, reference, ends, places, geometry, anchors):
    """Reset the friction state of all lines where the bodies are."""
    room, body = rooms(ends)
    for r in range(ends.shape[0] - 1):
        s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
        c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
        gather(system_q, system_q, reference, places[c : c + m], body[0, :m], body[1, :m])
        one.reset_friction(body[0, :m], geometry[s : s + n], room[0, :n], room[1, :n], anchors[s : s + n])


@kernel
def force(system_q, system_v, reference, active, ends, places, geometry, lines, profile, medium, anchors, out):
    """Add the generalised forces of the active lines to out, the coordinates of the bed."""
    room, body = rooms(ends)
    totals = np.zeros((TERMS, 3))
    for r in range(lines.shape[0]):
        if not active[r]:
            continue
        s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
        c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
        q, v, f = body[0, :m], body[1, :m], body[2, :m]
        gather(system_q, system_v, reference, places[c : c + m], q, v)
        f[:] = 0.0
        one.force(
            q, v, geometry[s : s + n], lines[r], profile, medium[0], anchors[s : s + n],
            room[0, :n], room[1, :n], room[2, :n], totals, f,
        )  # fmt: skip
        for i in range(m):
            out[places[c + i, 1]] += f[i]


@kernel
def tangent(
    system_q,
    system_v,
    reference,
    active,
    ends,
    places,
    geometry,
    lines,
    profile,
    medium,
    anchors,
    fq,
    fv,
    triplets,
    count,
):
    """Append the entries of fq df/dq + fv df/dv as rows (row, column, value) to the first `count` triplets.

    Rows and columns are coordinates of the bed; entries of zero are left out. Returns the new count.
    """
    room, body = rooms(ends)
    matrix = np.empty((body.shape[1], body.shape[1]))
    for r in range(lines.shape[0]):
        if not active[r]:
            continue
        s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
        c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
        q, v, block = body[0, :m], body[1, :m], matrix[:m, :m]
        gather(system_q, system_v, reference, places[c : c + m], q, v)
        block[:] = 0.0
        one.tangent(
            q, v, geometry[s : s + n], lines[r], profile, medium[0], anchors[s : s + n],
            room[0, :n], room[1, :n], room[2, :n], fq, fv, block,
        )  # fmt: skip
        for i in range(m):
            for j in range(m):
                if block[i, j] != 0.0:
                    triplets[count, 0], triplets[count, 1] = places[c + i, 1], places[c + j, 1]
                    triplets[count, 2] = block[i, j]
                    count += 1
    return count


@kernel
def accept(
    system_q, system_v, reference, ends, places, geometry, lines, profile, medium, anchors, row, columns, proximity
):
    """End of a step for all lines, see `lines.accept`; columns (lines, 3), proximity (lines, 3) is filled."""
    room, body = rooms(ends)
    totals = np.zeros((TERMS, 3))
    for r in range(lines.shape[0]):
        s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
        c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
        q, v = body[0, :m], body[1, :m]
        gather(system_q, system_v, reference, places[c : c + m], q, v)
        proximity[r, DEEPEST], proximity[r, APPROACH] = one.accept(
            q, v, geometry[s : s + n], lines[r], profile, medium[0], anchors[s : s + n],
            room[0, :n], room[1, :n], room[2, :n], room, totals, row, columns[r],
        )  # fmt: skip
        proximity[r, EVER] = max(proximity[r, EVER], proximity[r, DEEPEST])


@kernel
def update_active(proximity, step, active):
    """Mark the lines that may touch the surface within a step (s), at four times their speed; whether there are any.

    active (lines,) is filled.
    """
    some = False
    for r in range(active.shape[0]):
        active[r] = proximity[r, DEEPEST] + 4.0 * step * (proximity[r, APPROACH] + 10.0 * step) > -1e-3
        some = some or active[r]
    return some
