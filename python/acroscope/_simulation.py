"""Simulations step by step."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from fractions import Fraction
from os import PathLike
from types import TracebackType
from typing import Any, Self, SupportsFloat, overload

from . import _acroscope
from ._folder import names
from ._runs import Kind, Value, _of_kind


class Simulation:
    """A scenario step by step.

        with ac.Simulation("full-state", inputs=["plant.tau"]) as sim:
            while sim.step() is not None:
                sim.set("plant.tau", my_controller(sim.get("plant.q1"), sim.get("plant.q2")))

    `inputs` are taken from whatever drives them in the scenario, and yours to set; a single name will do, too. `values` are start
    values and parameters; what drives an input that is not among `inputs` would overwrite it, so that it is refused. With `isolate`
    each unit runs in a process of its own (on Linux), and `step_limit` is how many seconds a call into an isolated unit may take. `close`, or the end of a `with`, frees the units and ends these processes.
    """

    def __init__(
        self,
        scenario: str | PathLike[str],
        values: Mapping[str, Value] | None = None,
        *,
        stop: float | str | Fraction | None = None,
        inputs: str | Sequence[str] = (),
        isolate: bool = False,
        step_limit: float | None = None,
    ) -> None:
        end = None if stop is None else str(stop)
        self._open: _acroscope.Simulation | None = None
        self._open = _acroscope.Simulation(os.fspath(scenario), dict(values or {}), end, names(inputs), isolate, step_limit)

    @property
    def _inner(self) -> _acroscope.Simulation:
        if self._open is None:
            raise _acroscope.Error("the simulation is closed")
        return self._open

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Frees the units, and ends their processes; nothing else can be asked of the simulation then."""
        self._open = None

    @property
    def time(self) -> float:
        """Simulated time in s."""
        return self._inner.time

    @property
    def resolved(self) -> str:
        """The scenario with every value that is used, as TOML."""
        return self._inner.resolved

    @property
    def notices(self) -> list[str]:
        """What one should know, but what stops nothing."""
        return self._inner.notices

    def set(self, name: str, value: str | SupportsFloat) -> None:
        """Gives `instance.variable` a value: any start value before the run, an input or tunable parameter in it. What a connection or
        source drives is refused. The run begins with the first `get`, `save` or step; `reset` leads back to before it."""
        self._inner.set(name, value)

    @overload
    def get(self, name: str) -> float: ...
    @overload
    def get(self, name: str, kind: type[Kind]) -> Kind: ...
    def get(self, name: str, kind: type[Kind] | None = None) -> Any:
        """The value of `instance.variable` now, in its own type: a float, an int, a bool or a str. To a type checker it is a float, of
        which int and bool are kinds; `get(name, str)` is a str to it, and an error if it is none.

        Values are there once the units are initialised, which the first `get` does: it begins the run. Start values are set before, or
        after a `reset`; those that a scenario uses stand in `resolved`, which begins nothing."""
        return _of_kind(name, self._inner.get(name), kind)

    def step(self, until: float | None = None) -> float | None:
        """On to the next communication point, or to the last one not later than `until`. Answers the time then, or None if the simulation
        was at its end already. `until` must not be before `time`."""
        if until is None:
            return self._inner.step()
        try:
            end = float(until)
        except (TypeError, ValueError, OverflowError):
            problem = f"until = {until!r}: a time in s that is not before the time now, {self.time} s"
            raise _acroscope.InputError(problem) from None
        return self._inner.advance_to(end)

    def save(self) -> _acroscope.State:
        """The state now: of the units, the values between them, and what is under way with a delay. Begins the run, as `get` does."""
        return self._inner.save()

    def restore(self, state: _acroscope.State) -> None:
        """Back to a saved state, of this simulation or of another one of the same scenario; from there the same bits."""
        self._inner.restore(state)

    def reset(self) -> None:
        """Back to before the start; start values stay."""
        self._inner.reset()

    def __repr__(self) -> str:
        return "<Simulation, closed>" if self._open is None else f"<Simulation at {self.time} s>"
