"""Builds a co-simulation unit in C (FMI 2.0) from a machine's declaration and its equations in C: `unit.c` beside this file is the
rest. Needs gcc. Not made by the product's exporter, on purpose."""

import hashlib
import platform
import subprocess
import tempfile
import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

HERE = Path(__file__).resolve().parent
# factor and exponents of (kg, m, s, A, K, mol, rad)
UNITS = {
    "A": {"A": 1}, "V": {"kg": 1, "m": 2, "s": -3, "A": -1}, "Ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2}, "rad": {"rad": 1}, "rad/s": {"rad": 1, "s": -1},
    "N.m/A": {"kg": 1, "m": 2, "s": -2, "A": -1}, "kg.m2": {"kg": 1, "m": 2}, "N.m": {"kg": 1, "m": 2, "s": -2},
    "N.m.s/rad": {"kg": 1, "m": 2, "s": -1, "rad": -1}, "N.m/rad": {"kg": 1, "m": 2, "s": -2, "rad": -1},
    "m": {"m": 1}, "m/s": {"m": 1, "s": -1}, "m/s2": {"m": 1, "s": -2}, "kg": {"kg": 1}, "N": {"kg": 1, "m": 1, "s": -2},
    "N/m": {"kg": 1, "s": -2}, "N.s/m": {"kg": 1, "s": -1}, "N/m3": {"kg": 1, "m": -2, "s": -2}, "K": {"K": 1},
    "W": {"kg": 1, "m": 2, "s": -3}, "F": {"kg": -1, "m": -2, "s": 4, "A": 2}, "A.h": {"A": 1, "s": 1, "factor": 3600.0},
    "1": {}, "1/K": {"K": -1}, "J/K": {"kg": 1, "m": 2, "s": -2, "K": -1}, "W/K": {"kg": 1, "m": 2, "s": -3, "K": -1},
    "Ohm/K": {"kg": 1, "m": 2, "s": -3, "A": -2, "K": -1}, "%": {"factor": 0.01}, "W/%": {"kg": 1, "m": 2, "s": -3, "factor": 100.0},
    "W/(m2.K)": {"kg": 1, "s": -3, "K": -1}, "1/s": {"s": -1}, "l": {"m": 3, "factor": 1e-3}, "l/s": {"m": 3, "s": -1, "factor": 1e-3},
    "s": {"s": 1}, "mol/l": {"mol": 1, "m": -3, "factor": 1e3}, "J/mol": {"kg": 1, "m": 2, "s": -2, "mol": -1},
}  # fmt: skip


def variables(machine):
    """(name, unit, causality, variability, initial, start, low, high, phrase), in the order of value references."""
    starts = {} if machine.fixed else {state.start: state for state in machine.states}
    rows = [(one.name, one.unit, "input", "continuous", None, one.rest, None, None, "") for one in machine.inputs]
    for one in machine.outputs_of:
        state = starts.pop(one.name, None)
        exact = ("exact", state.value) if state else ("calculated", None)
        rows.append((one.name, one.unit, "output", "continuous", *exact, None, None, ""))
    for state in starts.values():
        rows.append((state.start, state.unit, "parameter", "fixed", "exact", state.value, None, None, ""))
    for one in machine.parameters:
        rows.append((one.name, one.unit, "parameter", "tunable", "exact", one.value, one.low, one.high, one.phrase))
    return rows


def description(machine, guid, step, old=False):
    lines = ['<?xml version="1.0" encoding="UTF-8"?>',
             f'<fmiModelDescription fmiVersion="2.0" modelName="{machine.name}" guid="{guid}" numberOfEventIndicators="0">',
             f'  <CoSimulation modelIdentifier="{machine.name}" canHandleVariableCommunicationStepSize="true"'
             f' canGetAndSetFMUstate="{str(machine.saves_state and not old).lower()}"'
             f' canBeInstantiatedOnlyOncePerProcess="{str(old).lower()}"/>', "  <UnitDefinitions>"]  # fmt: skip
    for unit in sorted({row[1] for row in variables(machine)}):
        base = " ".join(f'{key}="{value}"' for key, value in UNITS[unit].items())
        lines.append(f'    <Unit name="{unit}"><BaseUnit {base}/></Unit>')
    lines += ["  </UnitDefinitions>", f'  <DefaultExperiment stepSize="{machine.step or machine.row}"/>', "  <ModelVariables>"]
    rows = variables(machine)
    for place, (name, unit, causality, variability, initial, start, low, high, phrase) in enumerate(rows):
        known = f' initial="{initial}"' if initial else ""
        text = f" description={quoteattr(phrase)}" if phrase else ""
        numbers = "".join(f' {key}="{value!r}"' for key, value in (("start", start), ("min", low), ("max", high)) if value is not None)
        lines.append(f'    <ScalarVariable name="{name}" valueReference="{place}" causality="{causality}" variability="{variability}"'
                     f'{known}{text}><Real unit="{unit}"{numbers}/></ScalarVariable>')  # fmt: skip
    lines += ["  </ModelVariables>", "  <ModelStructure>", "    <Outputs>"]
    places = [place + 1 for place, row in enumerate(rows) if row[2] == "output"]
    lines += [f'      <Unknown index="{place}"/>' for place in places]
    computed = [place for place in places if rows[place - 1][4] == "calculated"]
    lines += ["    </Outputs>"]
    if computed:
        lines += ["    <InitialUnknowns>", *(f'      <Unknown index="{place}"/>' for place in computed), "    </InitialUnknowns>"]
    return "\n".join([*lines, "  </ModelStructure>", "</fmiModelDescription>", ""])


def header(machine, derivatives, outputs, guid, step):
    rows = variables(machine)
    names = ", ".join(row[0] for row in rows)
    starts = ", ".join(repr(float(row[5] or 0.0)) for row in rows)
    begins = [repr(state.value) if machine.fixed else f"v[{state.start}]" for state in machine.states]
    begin = " ".join(f"x[{place}] = {value};" for place, value in enumerate(begins))
    return f"""enum {{ {names}, NV }};
enum {{ NX = {len(machine.states)} }};
#define GUID "{guid}"
#define STEP {step!r}
static const double START[NV] = {{ {starts} }};
static void begin(const double *v, double *x) {{ {begin} }}
static void derivatives(const double *v, const double *x, double *dx) {{ {derivatives} }}
static void outputs(double *v, const double *x) {{ {outputs} }}
"""


def build(machine, folder, derivatives, outputs, step, old=False, late=None):
    """Writes `<name>.fmu` into a folder and returns its path. `old`, and `late`, an output: ways that other tools' units have (`unit.c`)."""
    text = description(machine, "GUID", step, old) + header(machine, derivatives, outputs, "GUID", step) + (HERE / "unit.c").read_text()
    guid = hashlib.sha256(text.encode()).hexdigest()[:32]
    target = Path(folder) / f"{machine.name}.fmu"
    platforms = {"Linux": ("linux64", "so"), "Darwin": ("darwin64", "dylib")}
    place, suffix = platforms[platform.system()]
    with tempfile.TemporaryDirectory() as work:
        work = Path(work)
        (work / "model.h").write_text(header(machine, derivatives, outputs, guid, step))
        library = work / f"{machine.name}.{suffix}"
        flags = ["-O2", "-shared", "-fPIC", "-Wall", *(["-DOLD"] if old else []), *([f"-DLATE={late}"] if late else [])]
        command = ["gcc", *flags, "-I", work, HERE / "unit.c", "-o", library, "-lm"]
        subprocess.run(command, check=True, capture_output=True, text=True)
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("modelDescription.xml", description(machine, guid, step, old))
            archive.write(library, f"binaries/{place}/{library.name}")
    return target
