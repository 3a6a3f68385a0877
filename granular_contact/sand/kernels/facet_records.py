"""Record types of facets: of one facet in the frame of its body, and of a block of facets that a law loads together.

A row of `elements` that is a facet has the fields of FACET:

    centroid    (3,) m
    reach       greatest distance from the centroid to a corner (m)
    normal      (3,) unit vector; of bodies it points outward
    area        m^2
    a, b        (3,) m; corners of a triangle are a, b and -a - b from its centroid, those of a parallelogram a + b,
                a - b, -a + b and -a - b, so that a and b are its half edges
    side        1: loaded only where the normal points ahead; 0: a thin plate, either face can lead
    form        TRIANGLE, PARALLELOGRAM, PATCH or RIM
    curvatures  (2,) 1/m: change of the normal per length along a and along b

A PATCH of a round surface is a parallelogram whose normal turns. A RIM has no area and takes no force: it consists of a
circle around the normal with the radius a[0], and of spheres around all points of the circle with the radius a[1] (m).
No point of a round body is deeper than the deepest of its rims.

A block is one record BLOCK, whose fields are arrays with one number for each of at most LANES facets, so that a law
treats several facets in one instruction. `facets.gather` fills the fields before `growing`. Vectors have three rows:

    depth               z > 0: mean depth of the immersed part (m)
    normal              n
    velocity            v of the centroid (m/s)
    stretch             e of the bristle (m)
    spread              (2,) by how much n . v grows along a and along b (m/s)
    side                as in FACET
    shear               j: shear displacement (m), see `path_length`
    area                of the immersed part (m^2)
    scatter             (2,) factors of the two terms of the law, see `facet_paths`
    growing_arm         from the reference point of the body to the point at which the growing term acts (m)
    constant_arm        likewise, to the point at which the constant term acts (m)
    centroid_depth      depth of the centroid (m)
    turn_a, turn_b      change of the normal from the centroid along a and along b
    row                 index of the facet among the elements of its cluster
    path, ahead, grain, grain_ends      work arrays of `facet_paths`, (1,), (1,), (1,), (2,)
    growing, constant   tractions that the law fills in: stress per depth (N/m^3) of the term that grows with depth, and
                        stress (Pa) of the constant term
    direction, share    direction of motion u that the law takes, and share of its static force, see `facet_blocks.lead`
"""

from __future__ import annotations

from granular_contact.jit.memory import as_records, record_room
from granular_contact.jit.records import fields, record_dtype

TRIANGLE, PARALLELOGRAM, PATCH, RIM = range(4)  # forms
FACET = record_dtype(
    [
        ("centroid", "f8", (3,)),
        ("reach", "f8"),
        ("normal", "f8", (3,)),
        ("area", "f8"),
        *(("a", "f8", (3,)), ("b", "f8", (3,))),
        *fields("f8", "side", "form"),
        ("curvatures", "f8", (2,)),
    ]
)
COLUMNS = FACET.itemsize // 8  # of a row of `elements` that is a facet
as_facets = as_records(FACET)

LANES = 32
BLOCK = record_dtype(
    [
        ("depth", "f8", (LANES,)),
        *((name, "f8", (3, LANES)) for name in ("normal", "velocity", "stretch")),
        ("spread", "f8", (2, LANES)),
        *((name, "f8", (LANES,)) for name in ("side", "shear", "area")),
        ("scatter", "f8", (2, LANES)),
        *((name, "f8", (3, LANES)) for name in ("growing_arm", "constant_arm")),
        ("centroid_depth", "f8", (LANES,)),
        *((name, "f8", (3, LANES)) for name in ("turn_a", "turn_b")),
        ("row", "i8", (LANES,)),
        *((name, "f8", (LANES,)) for name in ("path", "ahead", "grain")),
        ("grain_ends", "f8", (2, LANES)),
        *((name, "f8", (3, LANES)) for name in ("growing", "constant", "direction")),
        ("share", "f8", (LANES,)),
    ]
)
block_room = record_room(BLOCK)
