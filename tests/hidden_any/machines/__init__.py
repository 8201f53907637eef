"""All machines, by name."""

from . import buck, cabin, car, cart, cell, drive, heating, house, motor, reactor, room, shed, sled, tank, valve

ALL = {module.MACHINE.name: module.MACHINE for module in (motor, car, room, cell, cart, house, drive, tank, heating, cabin, shed, sled, buck, reactor, valve)}
