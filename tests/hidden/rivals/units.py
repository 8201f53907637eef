"""The product's plant and camera units as a rival's model: what any user has, loaded by FMPy and called through FMI 2.0.

With them a rival stands where the product's own diagnosis stands: the same equations, the same pictures, the same distance
from whatever made the data. FMPy loads and instantiates; rows are stepped by the functions themselves, as its wrappers
take ten times as long as the unit.
"""

import ctypes
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

from .image import Unpredictable

PLANT = "acrobot_plant.fmu"
CAMERA = "acrobot_camera.fmu"
STATE = ("q1_0", "q2_0", "dq1_0", "dq2_0")
NODE = ("q1", "q2", "dq1", "dq2", "tau_applied")
FRAME = ("area1", "u1", "v1", "area2", "u2", "v2", "area3", "u3", "v3")
POSE = ("q1", "q2", "dq1", "dq2")
JUMP = 1e-3  # share of a frame's interval in which the arm is put where the interval begins
AVERAGED = 4  # noisy pictures of a pose whose mean is the expected one: noise moves what a threshold sees
FREE = 1e9  # rad: a trial state is held by no stop
Reals = ctypes.POINTER(ctypes.c_double)


class Unit:
    """One instance, set up anew for each use."""

    def __init__(self, file):
        folder = extract(str(file))
        description = read_model_description(folder)
        self.variables = {v.name: v for v in description.modelVariables}
        self.fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="rival",
                             modelIdentifier=description.coSimulation.modelIdentifier)
        self.fmu.instantiate()
        dll, self.component = self.fmu.dll, self.fmu.component
        self._step, self._set, self._get = (_function(dll, name, *arguments) for name, *arguments in (
            ("fmi2DoStep", ctypes.c_double, ctypes.c_double, ctypes.c_int),
            ("fmi2SetReal", ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p),
            ("fmi2GetReal", ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)))

    def begin(self, values, at=0.0):
        """Sets values by name (what the unit doesn't know is the maker's own) and leaves initialization at that time."""
        self.fmu.reset()
        for name, value in values.items():
            variable = self.variables.get(name)
            if variable is None:
                continue
            setter, kind = {"Real": (self.fmu.setReal, float), "Integer": (self.fmu.setInteger, round),
                            "Boolean": (self.fmu.setBoolean, bool)}[variable.type]
            setter([variable.valueReference], [kind(value)])
        self.fmu.setupExperiment(startTime=at)
        self.fmu.enterInitializationMode()
        try:
            self.fmu.exitInitializationMode()
        except FMICallException as refused:
            raise Unpredictable(str(refused)) from refused

    def port(self, names):
        """(references, room for values) of some Reals, as the two calls below take them."""
        references = (ctypes.c_uint * len(names))(*(self.variables[n].valueReference for n in names))
        return references, np.zeros(len(names))

    def set(self, port, values):
        port[1][:] = values
        _check(self._set(self.component, port[0], len(port[0]), port[1].ctypes.data))

    def get(self, port):
        _check(self._get(self.component, port[0], len(port[0]), port[1].ctypes.data))
        return port[1]

    def step(self, time, size):
        _check(self._step(self.component, time, size, 1))


def _function(dll, name, *arguments):
    """A handle of its own: FMPy's has other argument types."""
    return ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, *arguments)((name, dll))


def _check(status):
    if status > 1:  # beyond OK and warning
        raise Unpredictable(f"the unit answered with status {status}")


class Units:
    """Both, behind the same calls as `maker.Maker`."""

    early = early_plant = 0.1  # s before the first row: within that a lag of the actuator has settled

    def __init__(self, folder):
        folder = Path(folder)
        self.plant = Unit(folder / PLANT)
        self.torque, self.node = self.plant.port(("tau", "tau_1")), self.plant.port(NODE)
        self.camera = Unit(folder / CAMERA)
        self.pose, self.frame = self.camera.port(POSE), self.camera.port(FRAME)
        self.valid = self.camera.variables["valid"].valueReference

    def replay(self, plant):
        return lambda commands, times, start: self._replay(commands, times, start, plant)

    def _replay(self, commands, times, start, plant):
        first = int(np.searchsorted(commands[:, 0], times[0] + 1e-9))
        last = int(np.searchsorted(commands[:, 0], times[-1] - 1e-9))
        held = commands[first - 1, 1:] if first > 0 else np.zeros(2)
        self.plant.begin({**plant, **dict(zip(STATE, start)), "q2_max": FREE, "tau": held[0], "tau_1": held[1],
                          "tau_0": held[0]}, times[0])
        nodes = np.zeros((len(times), 5))
        nodes[0] = self.plant.get(self.node)
        at, now = times[0], first
        for k in range(1, len(times)):
            while now < last and commands[now, 0] < times[k] - 1e-9:
                if commands[now, 0] > at:
                    self.plant.step(at, commands[now, 0] - at)
                    at = commands[now, 0]
                self.plant.set(self.torque, commands[now, 1:])
                now += 1
            if times[k] > at:
                self.plant.step(at, times[k] - at)
                at = times[k]
            nodes[k] = self.plant.get(self.node)
        return nodes

    def rendered(self, poses, camera):
        if camera["sigma"] == 0.0:
            return self.noisy(poses, camera)
        return np.mean([self.noisy(poses, camera, 7919 * (k + 1)) for k in range(AVERAGED)], axis=0)

    def noisy(self, poses, camera, seed=1):
        interval = 1.0 / camera["omega_cam"]
        half = 0.5 * camera["E_t"] * interval
        self.camera.begin({**camera, "T_delay": 0.0, "drop_rate": 0.0, "seed": seed})
        out = np.full((len(poses), 9), np.nan)
        for k, pose in enumerate(np.asarray(poses)[:, :4]):
            rates = pose[2:]
            from_, to = k * interval, (k + 1) * interval
            jumped = from_ + JUMP * interval
            self.camera.set(self.pose, [*(pose[:2] + (half - interval) * rates), *rates])
            self.camera.step(from_, jumped - from_)
            self.camera.set(self.pose, [*(pose[:2] + half * rates), *rates])
            self.camera.step(jumped, to - jumped)
            if self.camera.fmu.getBoolean([self.valid])[0]:
                out[k] = self.camera.get(self.frame)
        return out
