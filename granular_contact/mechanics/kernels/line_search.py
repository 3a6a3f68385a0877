"""A place on the way of an iteration from which the next one does not lead back.

Where bristles begin to hold, all within a narrow range of speeds, an iteration of Newton's method leads many of them to
the other side of it, and the next one back. What the change of an iteration has along the way that led to its start is
1 times that way at the beginning, and negative beyond the place where the way should have ended. That place is sought
by false position, where one end that stays counts half (Dowell and Jarratt 1971). Were forces those of a potential, it
would be where that is least on the way.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.mechanics.kernels.iterations import (
    ALONG,
    AT,
    CHANGE,
    FOLLOWS,
    FROM,
    HIGH,
    KEPT,
    KEPT_MULTIPLIERS,
    LAST,
    LEVER,
    LOW,
    MULTIPLIERS,
    NEXT,
    NOWHERE,
    NUMBER,
    OF,
    OF_HIGH,
    OF_LOW,
    ON_LINE,
    PAIRS,
    SEEKS,
    SQUARE,
    STAGE,
    TRIES,
    WAY,
    WAY_OF_MULTIPLIERS,
    A,
    Q,
    V,
    numbers,
    row,
    rows,
)

# What a change has along the way, over its length: at which it led too far, and is near enough to nothing; most places
# that are tried; share of what is left at either end that the next one keeps away from.
BEYOND, NEAR, MOST_TRIES, EDGE = -0.3, 0.5, 8, 0.1
START, FAR = 0, 1  # rows of `way`


@part
def go_to(words):
    """Move to the place on the way that is to be tried, or was found."""
    share = row(words, ON_LINE)[AT]
    q, v, a, of = row(words, Q), row(words, V), row(words, A), row(words, OF)
    multipliers, kept, way = row(words, MULTIPLIERS), rows(words, KEPT), rows(words, WAY)
    kept_multipliers, constraints = rows(words, KEPT_MULTIPLIERS), rows(words, WAY_OF_MULTIPLIERS)
    for i in range(a.shape[0]):
        further = way[START, i] + share * way[FAR, i] - a[i]
        q[i] += of[0] * further
        v[i] += of[1] * further
        a[i] += further
        kept[FROM, i] = a[i]
    for i in range(multipliers.shape[0]):
        multipliers[i] = kept_multipliers[FROM, i] = constraints[START, i] + share * constraints[FAR, i]


@part
def along(words):
    """What the last change has along the way, as a share of its length."""
    lever, kept, way = row(words, LEVER), rows(words, KEPT), rows(words, WAY)
    total = 0.0
    for i in range(lever.shape[0]):
        total += lever[i] * way[FAR, i] * kept[CHANGE, i]
    return total / row(words, ON_LINE)[SQUARE]


@part
def draw(words):
    """Take for the way that from where the last iteration began to where the next one does."""
    a, multipliers, lever = row(words, A), row(words, MULTIPLIERS), row(words, LEVER)
    kept, way, line = rows(words, KEPT), rows(words, WAY), row(words, ON_LINE)
    kept_multipliers, constraints = rows(words, KEPT_MULTIPLIERS), rows(words, WAY_OF_MULTIPLIERS)
    square = 0.0
    for i in range(a.shape[0]):
        way[START, i], way[FAR, i] = kept[FROM, i], a[i] - kept[FROM, i]
        square += (lever[i] * way[FAR, i]) ** 2
        kept[FROM, i] = a[i]
    for i in range(multipliers.shape[0]):
        constraints[START, i] = kept_multipliers[FROM, i]
        constraints[FAR, i] = multipliers[i] - kept_multipliers[FROM, i]
        kept_multipliers[FROM, i] = multipliers[i]
    line[SQUARE], numbers(words, NUMBER)[STAGE] = square, ALONG if square > 0.0 else NOWHERE


@part
def turn_back(words, share):
    """Begin to seek a place on the way, where `go_to` then goes; share: what the change from its end has along it."""
    number, line = numbers(words, NUMBER), row(words, ON_LINE)
    number[STAGE], number[TRIES] = SEEKS, 0
    number[PAIRS], number[NEXT], number[FOLLOWS] = 0, 0, 0
    line[AT], line[LAST] = 1.0, 0.0
    line[LOW], line[OF_LOW] = 0.0, 1.0
    seek(words, share)


@part
def seek(words, share):
    """Choose another place on the way; share: what the change from the last one has along it."""
    line, number = row(words, ON_LINE), numbers(words, NUMBER)
    if share > 0.0:
        if number[TRIES] > 1 and line[LOW] == line[LAST]:
            line[OF_HIGH] *= 0.5
        line[LOW], line[OF_LOW] = line[AT], share
    else:
        if number[TRIES] > 1 and line[HIGH] == line[LAST]:
            line[OF_LOW] *= 0.5
        line[HIGH], line[OF_HIGH] = line[AT], share
    between = line[OF_LOW] / (line[OF_LOW] - line[OF_HIGH])
    line[LAST], line[AT] = line[AT], line[LOW] + (line[HIGH] - line[LOW]) * min(1.0 - EDGE, max(EDGE, between))
    number[TRIES] += 1


@part
def found(words):
    """Whether the place has been found, or enough were tried; if not, another one is chosen."""
    share = along(words)
    if abs(share) > NEAR and numbers(words, NUMBER)[TRIES] < MOST_TRIES:
        seek(words, share)
        return False
    return True
