"""Base class of laws of resistance. A law is one class in one file, and one line in `catalogue`.

The class of a law has

- `law`, its tag in YAML, and its coefficients: fields with bounds. The Parameters of the docstring are their
  descriptions in editors. A coefficient has a name without unit in Python; its alias, the key in YAML, ends with the
  unit. A coefficient that may be null and has no default is not stated by some sources; a run needs it. Each
  annotation also says how the coefficient scales with gravity, see `laws.gravity`;
- `equation`, `terms`, `takes`, `by_component` and `resultant`, see `Law`;
- `constants`, the names of the numbers (all float) that its forces need, and `numbers`, which returns their values;
- its forces, as the static methods below.

Forces are plain functions. Numba compiles them when they are first needed. They may call plain functions of their file,
and kernels such as `sand.kernels.bar_statics.horizontal_force`. A law does not import numba.

Vectors are tuples. In the plane they have the components x, y (up) of the world frame, in space x, y, z (up) of the
frame of the bed. Depths are vertical, in m and positive below the free surface; velocities are in m/s. `m` is the
record with the constants of the law and of its static friction (`sand.kernels.friction`). For lines and outlines a law
has one of `stress`, `traction` and `strip_force`; for balls it has `ball_force`:

    stress(t, u, m)        stress per depth (2,) N/m^3 on an element with the tangent t that moves in the direction u,
                           unit vectors
    traction(z, t, u, width, side, j, m)
                           stresses (2,) and (2,) Pa of the first and the second term at a depth z > 0; width (m);
                           side: +1 or -1 if the outward normal is to the left or right of t, 0 on thin plates;
                           j: shear displacement (m)
    strip_force(strip, line, m, f)
                           add the end forces (N) of the immersed part of a strip to f[term, end, xy];
                           strip: `sand.kernels.strip.Strip`; line: record `sand.kernels.law.LINE`
    cap_force(c, v, line, m, f)
                           optional: add the force (N) on the free end face at end 1 of a strip along c (m), which
                           moves with v, to f[term, 1, xy]
    ball_force(z, v, e, line, m, f)
                           add the force (N) at the centre of a ball to f[term, xy]; z: depth of its lowest point;
                           e: stretch of its bristle (m)
    drag_anchor(p, anchor, m)
                           optional: position (m) of an anchor after an accepted step that ends with its station at p
                           (m)

In space a `stress` is enough for surfaces (`sand.kernels.slices`). Other functions there, with the unit normal n of an
element, which points outward where side is 1 (side 0: thin plate):

    facet_stress(n, u, m), facet_traction(z, n, u, side, j, m)
                           as `stress` and `traction`, with vectors (3,)
    facet_inertia(n, v, side, m)
                           traction (3,) Pa of a second term beside a stress, from the velocity v
    facet_force(z, n, v, e, spread, side, j, m)
                           all tractions of a law that uses none of the others, see `sand.kernels.facet_blocks.force`
    bar_force(strip, cluster, m, f), bar_cap(c, v, cluster, m, f), space_ball_force(z, v, e, cluster, m, f)
                           as `strip_force`, `cap_force` and `ball_force`; cluster: record
                           `sand.kernels.space_law.CLUSTER`
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, field_serializer

from granular_contact.laws.coefficients import Coefficients
from granular_contact.laws.functions import check_law
from granular_contact.laws.gravity import EARTH, at_gravity
from granular_contact.laws.kinds import SHAPE_NAMES, Kind
from granular_contact.laws.scatter import MeasuredScatter, Scatter
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity
from granular_contact.values.strict import Faults, Listed, OrName, OrNull, Positive, Text, listed

if TYPE_CHECKING:  # a config is read without numpy
    import numpy as np
    from numpy.typing import NDArray

METADATA = (  # fields of every medium other than the coefficients of its law
    *("name", "validity", "source", "standing", "provenance", "scatter", "measured_scatter"),
    *("measured_gravity", "angle_of_repose"),
)


class Law(Coefficients):
    """A law with its coefficients: a medium.

    Parameters
    ----------
    name : str, optional
        Name in messages and columns; by default the tag of the law.
    source : str, optional
        Where the coefficients come from.
    standing : str, optional
        Evidence for the coefficients, as `two or more independent sources`.
    provenance : {"published", "fitted", "own"}, optional
        Whose numbers the coefficients are.
    validity : Validity
        Range in which the coefficients were measured.
    scatter : Scatter, optional
        Scatter of the static resistance; null: none.
    measured_scatter : sequence of MeasuredScatter
        Measured scatter of forces in this medium, by names that `scatter: {measured: ...}` takes.
    measured_gravity : float
        Gravity at which the coefficients were measured (m/s2), above 0. At another gravity they are scaled as their law
        says.
    angle_of_repose : float, optional
        Steepest slope (deg) on which the medium rests; null: not stated.

    Attributes
    ----------
    equation : str
        The published resultant or stress.
    terms : tuple of str
        Names of the terms of the law, three at most.
    takes : frozenset
        Kinds of shape that the law acts on, see `laws.kinds`.
    dynamic : frozenset
        Names of terms that depend on the speed; these do not scatter.
    by_component : bool
        Whether the static force opposes each component of the velocity by itself, and not the direction of the motion.
    resultant : bool
        Whether the source gives a single force at the middle of the immersed part, as `load: {form: resultant}` applies
        it.
    constants : tuple of str
        Names of the numbers that the forces need.

    Raises
    ------
    ValueError
        A number is not allowed. The message says what is allowed.
    TypeError
        A coefficient is missing, unknown or given twice.
    """

    name: Annotated[Text, OrNull(), Field(default=None)]
    source: Text | None = None
    standing: Text | None = None
    provenance: Literal["published", "fitted", "own"] | None = None
    validity: Validity = Field(NOT_STATED, alias="range")
    scatter: Scatter | None = None
    measured_scatter: Annotated[tuple[MeasuredScatter, ...], Listed, OrName()] = ()
    measured_gravity: Positive = Field(EARTH, alias="measured_gravity_m_s2")
    angle_of_repose: Annotated[float, Field(gt=0, lt=90)] | None = Field(None, alias="angle_of_repose_deg")
    law: str

    equation: ClassVar[str]
    terms: ClassVar[tuple[str, ...]]
    takes: ClassVar[frozenset[Kind]]
    dynamic: ClassVar[frozenset[str]] = frozenset({"drag", "viscous", "inertial"})
    by_component: ClassVar[bool] = False
    resultant: ClassVar[bool] = False
    constants: ClassVar[tuple[str, ...]]

    def numbers(self, gravity: float) -> dict[str, float]:
        """Values of the constants that the forces need. The coefficients are already those at this gravity.

        Parameters
        ----------
        gravity : float
            Gravity (m/s2), 0 or more.

        Returns
        -------
        dict
            Values of `constants` in SI units. A constant that is left out is 0.
        """
        raise NotImplementedError

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:
        """Record of the coefficients, as the kernels read it.

        Parameters
        ----------
        static : Elastoplastic or Smooth
            Regularisation of the sign in the static resistance.
        gravity : float
            Gravity (m/s2); its sign does not matter.

        Returns
        -------
        (1,) array
            The record.

        Raises
        ------
        ValueError
            A coefficient is missing that the source does not state.
        TypeError
            Kernels can't call the functions of the law, or `numbers` returns a name that is not in `constants`.
        """
        from granular_contact.sand.kernels.plates import PRESSED

        if self.lacking:
            missing = ", ".join(f"{type(self).__name__}.{key}" for key in self.lacking)
            raise ValueError(f"{missing}: got None, allowed is the number of your case: its source does not state it")
        record = self.blank()
        numbers = at_gravity(self, abs(gravity)).numbers(abs(gravity))
        if unknown := [name for name in numbers if name not in self.constants]:
            source = f"{type(self).__name__}.numbers gives {', '.join(unknown)}"
            raise TypeError(f"{source}; allowed are the names in its constants: {', '.join(self.constants)}")
        for name, value in numbers.items():
            record[name] = value
        static.fill(record)
        record["pressed"] = PRESSED * (record["u_y"] + record["v_eps"])  # u_y or v_eps is 0
        return record

    @classmethod
    def blank(cls) -> NDArray[np.void]:
        """Record (1,) of the law with all numbers 0.

        The call loads the compiler, and makes the law known to the kernels.

        Raises
        ------
        TypeError
            The class of the law has a fault, see `laws.functions`.
        """
        check_law(cls)
        from granular_contact.sand.kernels.joining import PARTS, blank

        return blank(next(base for base in cls.__mro__ if PARTS & vars(base).keys()))

    @property
    def lacking(self) -> list[str]:
        """Keys of the coefficients that the source does not state and nobody has given; a run needs them."""
        fields = type(self).model_fields.items()
        return [field.alias or name for name, field in fields if field.is_required() and getattr(self, name) is None]

    @property
    def needs_path_length(self) -> bool:
        """Whether the forces need path lengths or shear displacements, see `sand.kernels.path_length`."""
        return self.shear_grows or self.scatters

    @property
    def scatters(self) -> bool:
        """Whether the static resistance scatters."""
        return self.scatter is not None and self.scatter.relative != 0.0

    def _faults(self) -> Faults:
        chosen = self.scatter.measured if self.scatter is not None else None
        names = [measurement.name for measurement in self.measured_scatter]
        if chosen is not None and chosen not in names:
            known = f"allowed is {listed(names)}"
            if not names:
                known = "no scatter was measured in this medium; allowed are relative and length_m"
            yield ("scatter", "measured"), f"got {chosen}, {known}"

    def fill_scatter(self, record: Any, in_space: bool = False) -> None:
        """Write the scatter of the medium, if it has any, into records.

        Parameters
        ----------
        record : array
            The record (1,) of a contact line, or the records (n,) of clusters. They are changed.
        in_space : bool
            Whether the bodies are in space, where the force over an area scatters less.
        """
        if self.scatter is None:
            return
        record["scatter"], record["grain"] = self.scatter.numbers(self.measured_scatter, in_space)
        record["seed"] = self.scatter.seed
        record["static"] = sum(1 << i for i, term in enumerate(self.terms) if term not in self.dynamic)

    @property
    def shear_grows(self) -> bool:
        """Whether the forces need the shear displacement of the medium."""
        return False

    @property
    def lacking_in_space(self) -> list[str]:
        """Keys of coefficients that the medium needs in space, though not in the plane, and that are not given."""
        return []

    @classmethod
    def tag(cls) -> str:
        """Value of the key `law` in YAML."""
        return str(cls._tags()["law"])

    @classmethod
    def positions(cls) -> list[str]:
        """Names in the order of positional arguments: the coefficients of the law, then what every medium has."""
        return [*(name for name in cls.model_fields if name not in (*METADATA, "law")), *METADATA]

    def model_post_init(self, context: Any, /) -> None:
        """Name a medium without a name after its law."""
        if self.name is None:
            self.__dict__["name"] = self.law

    def __repr_args__(self) -> Any:
        """Yield what `repr` shows: the coefficients, and the name if it is not that of the law."""
        shown = [name for name in self.positions() if name not in METADATA]
        yield from ((name, getattr(self, name)) for name in shown)
        if self.name != self.law:
            yield "name", self.name

    def _repr_html_(self) -> str:
        from html import escape

        rows = {"law": self.law, "equation": self.equation, **self.model_dump(mode="json", by_alias=True)}
        cells = (f"<tr><td>{key}</td><td>{escape(str(value))}</td></tr>" for key, value in rows.items() if value)
        return f"<p><b>{escape(str(self.name))}</b></p><table>{''.join(cells)}</table>"

    @field_serializer("name")
    def _own_name(self, name: str) -> str | None:
        return None if name == self.law else name


def accepted_shapes(medium: Law) -> str:
    """Sentence that names the shapes on which a medium acts.

    Parameters
    ----------
    medium : Law
        The medium.

    Returns
    -------
    str
        As "play_sand takes round bars (...)".
    """
    return f"{medium.name} takes {', '.join(name for kind, name in SHAPE_NAMES.items() if kind in medium.takes)}"


def term_names(media: Collection[Law]) -> tuple[str, ...]:
    """Names of the terms of media that act together.

    Parameters
    ----------
    media : collection of Law
        The media of a bed.

    Returns
    -------
    tuple of str
        The terms of a single medium as they are; those of several with the name of the medium in front, with a number
        if two media have one name.
    """
    if len(media) == 1:
        return tuple(next(iter(media)).terms)
    names = [medium.name for medium in media]
    labels = [name if names.count(name) == 1 else f"{name}_{i + 1}" for i, name in enumerate(names)]
    return tuple(f"{label}_{term}" for label, medium in zip(labels, media, strict=True) for term in medium.terms)
