"""What a machine is: its variables, its equations, how it is driven and logged."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class State:
    """A state. `start` names the parameter or the output that sets it; `spread` is how far starts differ from run to run."""

    name: str
    unit: str
    start: str
    value: float
    spread: float


@dataclass(frozen=True)
class Input:
    """An input. `log_unit` is what the log is written in, and `log` says how: (model - offset) / scale."""

    name: str
    unit: str
    rest: float
    size: float
    log_unit: str
    log: tuple = (1.0, 0.0)
    kind: str = "steps"
    hold: str = "zero"
    logged: bool = True


@dataclass(frozen=True)
class Output:
    """An output with the sensor's standard deviation in the model's unit."""

    name: str
    unit: str
    noise: float
    log_unit: str
    log: tuple = (1.0, 0.0)


@dataclass(frozen=True)
class Parameter:
    """A parameter. `hide` is the largest change worth hiding: in the unit, or as a share where `scale` is relative."""

    name: str
    unit: str
    value: float
    low: float
    high: float
    scale: str
    phrase: str
    hide: float = 0.0

    @property
    def candidate(self):
        return self.hide != 0.0


@dataclass(frozen=True)
class Machine:
    """A machine. `rhs(x, u, p)` and `outputs(x, u, p)` are numpy over any number of variants at once; `extra` are forces that
    nobody lists, as additional entries of p, neutral at 0. `step` is the unit's own idea of a step where it isn't a row: inputs
    that run along lines want more than one between two rows. `units`: the description has units of measurement.
    `late`: an output that the unit computes in a step only. `fixed`: nothing sets its states, every run begins where the unit does. Several units: `build` gives all files, `scenario` is the one that connects them, `places` says whose each variable is."""

    name: str
    states: tuple
    inputs: tuple
    outputs_of: tuple
    parameters: tuple
    rhs: object
    outputs: object
    row: float
    substeps: int
    duration: float
    build: object
    extra: dict = field(default_factory=dict)
    runs: int = 4
    late: str = ""
    saves_state: bool = True
    step: float = 0.0
    one_sided: bool = False
    units: bool = True
    fixed: bool = False
    scenario: str = ""
    places: dict = field(default_factory=dict)

    def full(self, name):
        """`instance.variable` of a variable, or of an effect at one."""
        return f"{self.places.get(name.split(':')[0], self.name)}.{name}"

    def nominal(self):
        values = {parameter.name: parameter.value for parameter in self.parameters}
        return values | dict.fromkeys(self.extra, 0.0)
