"""All machines, by name."""

from . import car, cart, cell, motor, room

ALL = {module.MACHINE.name: module.MACHINE for module in (motor, car, room, cell, cart)}
