"""What a law of resistance is: one class in one file, and one line in `catalogue`.

The class of a law says

- `law`, its tag in YAML, and its coefficients: fields with bounds, whose text below is their description for editors. A
  coefficient is named without its unit in Python, and its key in YAML, the alias, ends with the unit. One that may be
  null and has no default is left open by some sources, and a run needs it. Beside each stands how it scales with
  gravity, see `laws.gravity`.
- `equation`, `terms` and `takes`, `by_component` and `resultant`, see `Law`;
- `constants`, the names of the numbers (all float) that its forces need, and `numbers`, which gives their values;
- its forces, as static methods named and called as the stubs in `sand.kernels.law` and `plates`: for lines and
  outlines `stress`, `traction` or `strip_force` and, if it knows one, `cap_force`; for balls `ball_force`. `m` has the
  constants.

Forces are plain functions that numba compiles when they are first needed: they may call plain functions of their file,
and kernels as `sand.kernels.bar_statics.horizontal_force`. Nothing of numba is imported here.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, field_serializer

from granular_contact.laws.coefficients import Coefficients
from granular_contact.laws.functions import refuse_faulty
from granular_contact.laws.gravity import EARTH, at_gravity
from granular_contact.laws.kinds import WORDS, Kind
from granular_contact.laws.scatter import MeasuredScatter, Scatter
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity
from granular_contact.values.strict import Faults, Listed, OrName, OrNull, Positive, Text, listed

if TYPE_CHECKING:  # a config is read without numpy
    import numpy as np
    from numpy.typing import NDArray

ABOUT = (
    *("name", "validity", "source", "standing", "provenance", "scatter", "measured_scatter"),
    *("measured_gravity", "angle_of_repose"),
)


class Law(Coefficients):
    """A law with its coefficients: a medium.

    Parameters
    ----------
    name : str, optional
        For messages and columns; the tag of the law unless given.
    source : str, optional
        Where the coefficients come from.
    standing : str, optional
        What they rest on, as `two or more independent sources`.
    provenance : {"published", "fitted", "own"}, optional
        Whose numbers they are.
    validity : Validity
        Where the coefficients were measured.
    scatter : Scatter, optional
        Of the static resistance; null: none.
    measured_scatter : sequence of MeasuredScatter
        What was measured of it, by names that `scatter: {measured: ...}` takes.
    measured_gravity : float
        At which the coefficients were measured (m/s2), above 0: at another one they are scaled as their law says.
    angle_of_repose : float, optional
        Steepest slope (deg) that the medium keeps; null: not stated.

    Attributes
    ----------
    equation : str
        The published resultant or stress.
    terms : tuple of str
        Names of the law's terms, three at most.
    takes : frozenset
        Kinds of shape it is for, see `laws.kinds`.
    dynamic : frozenset
        Terms that come from the speed, which do not scatter.
    by_component : bool
        Whether its static force opposes each component of the velocity by itself, and not the motion as a whole.
    resultant : bool
        Whether its source gives a single force at the middle of the immersed part, as `load: {form: resultant}` has it.
    constants : tuple of str
        Names of the numbers that its forces need.

    Raises
    ------
    ValueError
        A number is not allowed; with what is.
    TypeError
        One is missing, unknown or given twice.
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
        """Numbers that the forces need, where the coefficients are those at this gravity (`laws.gravity`).

        Parameters
        ----------
        gravity : float
            m/s2, 0 or more.

        Returns
        -------
        dict
            Values of `constants` in SI units, those left out being 0.
        """
        raise NotImplementedError

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:
        """Coefficients as the record that the kernels read.

        Parameters
        ----------
        static : Elastoplastic or Smooth
            How the sign of the static resistance is regularised.
        gravity : float
            m/s2; its sense does not matter.

        Returns
        -------
        (1,) array
            The record.

        Raises
        ------
        ValueError
            A coefficient that the source leaves open was not given.
        TypeError
            Kernels can't call the functions of the law, or its numbers are none of its constants.
        """
        from granular_contact.sand.kernels.plates import PRESSED

        if self.lacking:
            got = ", ".join(f"{type(self).__name__}.{key}" for key in self.lacking)
            raise ValueError(f"{got}: got None, allowed is the number of your case: its source does not state it")
        record = self.blank()
        numbers = at_gravity(self, abs(gravity)).numbers(abs(gravity))
        if unknown := [name for name in numbers if name not in self.constants]:
            has = f"{type(self).__name__}.numbers gives {', '.join(unknown)}"
            raise TypeError(f"{has}; allowed are the names in its constants: {', '.join(self.constants)}")
        for name, value in numbers.items():
            record[name] = value
        static.fill(record)
        record["pressed"] = PRESSED * (record["u_y"] + record["v_eps"])  # one of them is 0
        return record

    @classmethod
    def blank(cls) -> NDArray[np.void]:
        """Record (1,) of the law with all numbers 0; the law is joined to the kernels, which loads the compiler."""
        refuse_faulty(cls)
        from granular_contact.sand.kernels.joining import PARTS, blank

        return blank(next(one for one in cls.__mro__ if PARTS & vars(one).keys()))

    @property
    def lacking(self) -> list[str]:
        """Keys without which the medium can't act: those that its source leaves open."""
        fields = type(self).model_fields.items()
        return [field.alias or name for name, field in fields if field.is_required() and getattr(self, name) is None]

    @property
    def needs_path_length(self) -> bool:
        """Whether its forces need path lengths or shear displacements, see `sand.kernels.path_length`."""
        return self.shear_grows or self.scatters

    @property
    def scatters(self) -> bool:
        """Whether its static resistance scatters."""
        return self.scatter is not None and self.scatter.relative != 0.0

    def _faults(self) -> Faults:
        asked = self.scatter.measured if self.scatter is not None else None
        names = [one.name for one in self.measured_scatter]
        if asked is not None and asked not in names:
            known = f"allowed is {listed(names)}"
            if not names:
                known = "no scatter was measured in this medium; allowed are relative and length_m"
            yield ("scatter", "measured"), f"got {asked}, {known}"

    def fill_scatter(self, record: Any, in_space: bool = False) -> None:
        """Write its scatter, if it has any, into records.

        Parameters
        ----------
        record : array
            The record (1,) of a contact line, or the records of clusters; they are changed.
        in_space : bool
            Whether bodies are in space, where a force over an area scatters less.
        """
        if self.scatter is None:
            return
        record["scatter"], record["grain"] = self.scatter.numbers(self.measured_scatter, in_space)
        record["seed"] = self.scatter.seed
        record["static"] = sum(1 << i for i, term in enumerate(self.terms) if term not in self.dynamic)

    @property
    def shear_grows(self) -> bool:
        """Whether its forces need the shear displacement of the medium."""
        return False

    @property
    def lacking_in_space(self) -> list[str]:
        """Keys without which the medium can't act in space, though it can in the plane."""
        return []

    @classmethod
    def tag(cls) -> str:
        """Value of the key `law` in YAML."""
        return str(cls._tags()["law"])

    @classmethod
    def positions(cls) -> list[str]:
        """As in `Coefficients`: the law's own numbers first."""
        return [*(name for name in cls.model_fields if name not in (*ABOUT, "law")), *ABOUT]

    def model_post_init(self, context: Any, /) -> None:
        """Name a medium without a name after its law."""
        if self.name is None:
            self.__dict__["name"] = self.law

    def __repr_args__(self) -> Any:
        """What `repr` shows: the numbers, and the name where it is not that of the law; not the sources."""
        shown = [name for name in self.positions() if name not in ABOUT]
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


def what_it_takes(medium: Law) -> str:
    """Sentence on the shapes that a medium acts on."""
    return f"{medium.name} takes {', '.join(words for kind, words in WORDS.items() if kind in medium.takes)}"


def term_names(media: Collection[Law]) -> tuple[str, ...]:
    """Names of the terms of media that act together: those of one alone, else each after its medium."""
    if len(media) == 1:
        return tuple(next(iter(media)).terms)
    names = [medium.name for medium in media]
    labels = [name if names.count(name) == 1 else f"{name}_{i + 1}" for i, name in enumerate(names)]
    return tuple(f"{label}_{term}" for label, medium in zip(labels, media, strict=True) for term in medium.terms)
