"""Runs an amended scenario in FMPy, a master that isn't ours, against a run that no diagnosis saw.

Units step in the order of the file, each connection carries the newest value, sources deliver what they are at the begin of a step
(a line: at its middle)."""

import tomllib
from fractions import Fraction
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from .machines import ALL
from .simulate import held

UNITS = Path(__file__).resolve().parents[2] / "target" / "fmus"


class Unit:
    """An instance in FMPy."""

    def __init__(self, entry, folders, values):
        path = next(folder / entry["fmu"] for folder in folders if (folder / entry["fmu"]).is_file())
        self.description = read_model_description(str(path), validate=False)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        model = self.description.coSimulation.modelIdentifier
        self.slave = FMU2Slave(guid=self.description.guid, unzipDirectory=extract(str(path)), modelIdentifier=model, instanceName=entry["name"])
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        settable = {name: value for name, value in values.items() if self.variables[name].initial == "exact" or self.causality(name) == "input"}
        for name, value in settable.items():
            self.set(name, value)
        self.slave.enterInitializationMode()
        # some units heed values in this mode only
        for name, value in settable.items():
            self.set(name, value)

    def causality(self, name):
        return self.variables[name].causality

    def set(self, name, value):
        variable = self.variables[name]
        cast = {"Real": float, "Integer": int, "Enumeration": int, "Boolean": bool, "String": str}[variable.type]
        getattr(self.slave, "set" + {"Enumeration": "Integer"}.get(variable.type, variable.type))([variable.valueReference], [cast(value)])

    def get(self, name):
        return self.slave.getReal([self.variables[name].valueReference])[0]


def run(scenario, folders, fed, starts, wanted, times):
    """Values of `wanted` (full names) at the times of a run. `fed`: {full name of an input: (times, values, hold)}."""
    entries = scenario["units"]
    interval = float(Fraction(str(scenario.get("interval") or entries[0]["interval"])))
    sets = [entry.get("set", {}) | {k.split(".", 1)[1]: v for k, v in starts.items() if k.startswith(entry["name"] + ".")} for entry in entries]
    units = {entry["name"]: Unit(entry, folders, values) for entry, values in zip(entries, sets, strict=True)}
    # what a source fed is fed by the left-out run, be it the input itself or the effects before it
    sources = {source["to"]: source.get("column") for source in scenario.get("sources", [])}
    leads = {column: to for to, column in sources.items() if column}
    links = [(link["from"].split(".", 1), link["to"].split(".", 1)) for link in scenario.get("connections", [])]

    def feed(name, at, middle):
        for full, (stamps, values, hold) in fed.items():
            unit, variable = leads.get(full, full).split(".", 1)
            if unit == name:
                when = np.array([at + (0.5 * interval if hold == "linear" and middle else 0.0)])
                units[unit].set(variable, held(stamps, values, when, hold)[0])
        for (source, output), (unit, variable) in links:
            if unit == name:
                units[unit].set(variable, units[source].get(output))

    for _ in range(2):
        for name in units:
            feed(name, 0.0, False)
    for unit in units.values():
        unit.slave.exitInitializationMode()
    pairs = [name.split(".", 1) for name in wanted]
    grid = interval * np.arange(int(np.ceil((times[-1] - times[0]) / interval - 1e-6)) + 1)
    rows = [[units[unit].get(name) for unit, name in pairs]]
    for at in grid[:-1]:
        for name, unit in units.items():
            feed(name, at, True)
            unit.slave.doStep(at, interval)
        rows.append([units[unit].get(name) for unit, name in pairs])
    for unit in units.values():
        unit.slave.terminate()
        unit.slave.freeInstance()
    rows = np.array(rows)
    return {name: np.interp(times - times[0], grid, rows[:, place]) for place, name in enumerate(wanted)}


def alone(machine, folder):
    """The nominal scenario."""
    if machine.scenario:
        return tomllib.loads((Path(folder) / machine.scenario).read_text())
    return {"units": [{"name": machine.name, "fmu": f"{machine.name}.fmu"}]}


def closed(folder, amended, answer):
    """Share of the gap to the left-out run that the amended scenario closes; None where nothing stands above the noise."""
    machine, left = ALL[answer["machine"]], answer["left_out"]
    times = np.array(left["times"])
    fed = {machine.full(one.name): (times, np.array(left["commands"][one.name]), one.hold) for one in machine.inputs}
    starts = {machine.full(name): value for name, value in left["starts"].items()}
    scenario = tomllib.loads(Path(amended).read_text())
    folders = [Path(amended).parent, Path(folder), UNITS]
    behind = {link["from"]: link["to"].split(".", 1)[0] + ".y" for link in scenario.get("connections", []) if "output_effects" in link["to"]}
    names = [machine.full(one.name) for one in machine.outputs_of]
    nominal = alone(machine, folder) | {"interval": scenario["units"][0]["interval"]}
    before = run(nominal, folders, fed, starts, names, times)
    after = run(scenario, folders, fed, starts, [behind.get(name, name) for name in names], times)

    def size(found, wanted):
        rest = [(found[w] - np.array(left["clean"][one.name])) / one.noise for w, one in zip(wanted, machine.outputs_of, strict=True)]
        return float(np.mean(np.square(rest)))

    # without the sensors' noise, so that the floor is 0: the numerics of unit and truth
    gap = size(before, names)
    return round(1 - size(after, [behind.get(name, name) for name in names]) / gap, 4) if gap > 0.01 else None
