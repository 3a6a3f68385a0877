"""Steps of `mujoco_scene` without Python: one compiled loop calls the sand and MuJoCo.

The work of `MujocoBed.apply` in a step, with the same kernels in the same order, is compiled into one function, which
calls MuJoCo's functions in its library. So the run time is that of a callback written in C. Limits: one medium, fixed
steps, implicit integrators.
"""

from __future__ import annotations

import ctypes
import time
from functools import lru_cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numba import njit
from numpy.typing import NDArray

from granular_contact.engines.mujoco.trial import FULL_M_TAKES_DATA, STATE
from granular_contact.mujoco import MujocoBed
from validation.peers.mujoco_scene import Laws

Array = NDArray[np.float64]
_VOID, _PLACE = None, ctypes.c_void_p
_LIBRARY = ctypes.CDLL(str(next(Path(mujoco.__file__).parent.glob("libmujoco.so*"))))


def _engine(name: str, *more: Any) -> Any:
    """Function of MuJoCo's library that takes model, data, and arguments of the types `more`."""
    function = getattr(_LIBRARY, name)
    return ctypes.CFUNCTYPE(_VOID, _PLACE, _PLACE, *more)(ctypes.cast(function, _PLACE).value)


def run(bed: MujocoBed, model: Any, data: Any, controls: Array, states: Array, laws: Laws) -> float:
    """Make a step for each row of controls (n, drives), fill states (n + 1, nq); return the processor time (s)."""
    assert not len(laws.places)
    step = bed.of(data)._step
    (act,), trial = step._force_calls, step._trial
    called = step._begin, act, step._guess, trial.damp, step._correct
    march = _march(tuple(kernel.func for kernel in called))
    trial.shares[:] = -model.opt.timestep, 0.0
    mass = (
        data.qM if not FULL_M_TAKES_DATA else trial.matrix
    )  # old versions of `mj_fullM` take it as their last argument, after the matrix
    given = (
        model._address,
        data._address,
        tuple(kernel.args for kernel in called),
        step.bed,
        data.ctrl,
        data.qpos,
        trial.state,
    )
    given += (trial.matrix, mass)
    march(*given, model.opt.timestep, controls[:0], states)  # compiles the loop
    began = time.process_time()
    march(*given, model.opt.timestep, controls, states)
    return time.process_time() - began


@lru_cache
def _march(kernels: tuple[Any, ...]) -> Any:
    """Compile the loop with these kernels: begin, forces, guess, damping and correct."""
    begins, acts, guesses, damps, corrects = kernels
    position, velocity, second = _engine("mj_fwdPosition"), _engine("mj_fwdVelocity"), _engine("mj_step2")
    get, put = (_engine(name, _PLACE, ctypes.c_uint) for name in ("mj_getState", "mj_setState"))
    whole = _engine("mj_step")
    full = ctypes.CFUNCTYPE(_VOID, _PLACE, _PLACE, _PLACE)(ctypes.cast(_LIBRARY.mj_fullM, _PLACE).value)
    kept, old = STATE, not FULL_M_TAKES_DATA

    @njit
    def march(model, data, arguments, bed, controls_now, place, state, matrix, mass, step, controls, states):
        bed[0].step = step
        for i in range(controls.shape[0]):
            states[i] = place
            controls_now[:] = controls[i]
            position(model, data)
            bed[0].elapsed, bed[0].starts = step if i else 0.0, i == 0
            begins(*arguments[0])
            acts(*arguments[1])
            if guesses(*arguments[2]):
                get(model, data, state.ctypes, kept)
                velocity(model, data)
                second(model, data)
                if old:
                    full(model, matrix.ctypes, mass.ctypes)
                else:
                    full(model, data, matrix.ctypes)
                damps(*arguments[3])
                corrects(*arguments[4])
                put(model, data, state.ctypes, kept)
            whole(model, data)
        states[controls.shape[0]] = place

    return march
