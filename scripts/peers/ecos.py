"""Ecos, through its Python package: its own loop in C++, no Python between steps.

Its wheel needs the library of oneTBB and doesn't bring it; that comes from the wheel of the package `tbb`, and is opened
before, since the wheel doesn't say where to look for it.
"""

import ctypes
import sys
from pathlib import Path

SIZE = 1e-3


class Ecos:
    """A ring of three units like those of `masters.py`, perhaps with ten values a step to a file."""

    def __init__(self, path, log=None):
        tbb = Path(sys.prefix) / "lib" / "libtbb.so.12"
        ctypes.CDLL(str(tbb), mode=ctypes.RTLD_GLOBAL)
        from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

        EcosLib.set_log_level("warn")
        self.structure = EcosSimulationStructure()
        for name in "abc":
            self.structure.add_model(name, path)
        for source, target in ("ca", "ab", "bc"):
            for out, into in (("y1", "u1"), ("y2", "u2")):
                self.structure.make_real_connection(f"{source}::{out}", f"{target}::{into}")
        self.simulation = EcosSimulation(SIZE, structure=self.structure)
        if log:
            names = [f"{unit}::{name}" for unit in "abc" for name in ("y1", "y2")]
            names += [f"{unit}::{name}" for unit in "ab" for name in ("u1", "u2")]
            self.simulation.add_csv_writer(log, identifiers=names)
        self.simulation.init()
        self.run(200)
        # y2 of the nearly free unit tends to twice the step size.
        found = self.simulation.get_real("a::y2")
        assert abs(found - 2 * SIZE) < 1e-9, f"Ecos made no steps: {found}"

    def run(self, steps):
        self.simulation.step(steps)
