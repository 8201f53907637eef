"""The cabin, by a unit as code generators of ten years ago made them: it lives once in a process, forgets what was set before the
experiment, listens to no start time, and a reset leaves its clock running."""

import dataclasses

from ..unit_c import build
from . import cabin, house

MACHINE = dataclasses.replace(
    cabin.MACHINE,
    name="shed",
    build=lambda machine, folder: build(machine, folder, house.C, "v[T_a] = x[0]; v[T_b] = x[1];", step=60.0, old=True),
)
