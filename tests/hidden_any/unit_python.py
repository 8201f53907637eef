"""Builds a co-simulation unit with PythonFMU from a machine's declaration and its equations in Python. Such a unit has no units of
measurement, and expects Python in the process that loads it (`environment`)."""

import os
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path


def source(machine, derivatives, step):
    lines = ["from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real", "", "",
             f"class {machine.name}(Fmi2Slave):", "    def __init__(self, **kwargs):", "        super().__init__(**kwargs)",
             "        self.x = []"]  # fmt: skip
    values = {one.name: one.rest for one in machine.inputs} | {one.name: 0.0 for one in machine.outputs_of}
    values |= {state.start: state.value for state in machine.states} | {one.name: one.value for one in machine.parameters}
    lines += [f"        self.{name} = {float(value)!r}" for name, value in values.items()]
    for one in machine.inputs:
        lines += [f'        self.register_variable(Real("{one.name}", causality=Fmi2Causality.input))']
    for one in machine.outputs_of:
        lines += [f'        self.register_variable(Real("{one.name}", causality=Fmi2Causality.output))']
    named = [(state.start, "") for state in machine.states] + [(one.name, one.phrase) for one in machine.parameters]
    for name, phrase in named:
        lines += [f'        self.register_variable(Real("{name}", causality=Fmi2Causality.parameter,'
                  f' variability=Fmi2Variability.tunable, description="{phrase}"))']  # fmt: skip
    starts = ", ".join(f"self.{state.start}" for state in machine.states)
    shown = [f"        self.{state.name} = self.x[{place}]" for place, state in enumerate(machine.states)
             if state.name in {one.name for one in machine.outputs_of}]  # fmt: skip
    lines += ["", "    def exit_initialization_mode(self):", f"        self.x = [{starts}]", *shown, "", "    def slopes(self):"]
    return "\n".join(lines) + derivatives + f"""
    def do_step(self, current_time, step_size):
        parts = max(1, round(step_size / {step}))
        h = step_size / parts
        for _ in range(parts):
            x = self.x
            k1 = self.slopes()
            self.x = [a + 0.5 * h * k for a, k in zip(x, k1)]
            k2 = self.slopes()
            self.x = [a + 0.5 * h * k for a, k in zip(x, k2)]
            k3 = self.slopes()
            self.x = [a + h * k for a, k in zip(x, k3)]
            k4 = self.slopes()
            self.x = [a + h / 6 * (p + 2 * q + 2 * r + s) for a, p, q, r, s in zip(x, k1, k2, k3, k4)]
""" + "\n".join(shown) + "\n        return True\n"


def build(machine, folder, derivatives, step):
    """Writes `<name>.fmu` into a folder and returns its path."""
    with tempfile.TemporaryDirectory() as work:
        (Path(work) / f"{machine.name}.py").write_text(source(machine, derivatives, step))
        command = [sys.executable, "-m", "pythonfmu", "build", "-f", f"{machine.name}.py"]
        subprocess.run(command, cwd=work, check=True, capture_output=True)
        target = Path(folder) / f"{machine.name}.fmu"
        target.write_bytes((Path(work) / f"{machine.name}.fmu").read_bytes())
    return target


def environment():
    """What a process without Python needs to load such a unit."""
    library = Path(sysconfig.get_config_var("LIBDIR")) / sysconfig.get_config_var("LDLIBRARY")
    found = {"LD_PRELOAD": str(library), "PYTHONPATH": sysconfig.get_path("purelib")} if library.suffix == ".so" else {}
    return os.environ | found
