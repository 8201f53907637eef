"""Simulates each unit alone through FMPy and prints what came out.

    python scripts/fmpy_simulate.py [--stop T]

The plant falls from the paper's initial state (14); the camera watches an arm that swings slowly along the manifold;
the controller is asked for its torque along the manifold.
"""

import argparse
from pathlib import Path

import numpy as np
from fmpy import simulate_fmu

UNITS = Path(__file__).resolve().parent.parent / "target" / "fmus"
RATIO = 1.880 / 4.779  # theta_10 / theta_9


def manifold(stop):
    """A slow swing along the equilibrium manifold (13), as a table of inputs."""
    time = np.linspace(0.0, stop, 601)
    q2 = 1.2 * np.sin(2 * np.pi * time / 20.0)
    q1 = -np.arcsin(RATIO * np.sin(q2))
    columns = {"time": time, "q1": q1, "q2": q2, "dq1": np.gradient(q1, time), "dq2": np.gradient(q2, time)}
    return np.rec.fromarrays(list(columns.values()), names=list(columns))


def simulate(name, stop, **options):
    path = UNITS / f"acrobot_{name}.fmu"
    result = simulate_fmu(str(path), stop_time=stop, output_interval=1 / 600, **options)
    print(f"{path.name}: {len(result)} points to {result['time'][-1]:g} s")
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stop", type=float, default=5.0, help="simulated seconds (default 5)")
    stop = parser.parse_args().stop

    plant = simulate("plant", min(stop, 2.0))
    fall = plant["time"][plant["contact"]][:1]
    print(f"  falls from (14): contact at {fall[0]:.3f} s" if len(fall) else "  has not fallen yet")

    poses = manifold(stop)
    camera = simulate("camera", stop, input=poses)
    seen = camera["valid"]
    # FMPy sets an input at the begin of a step, so a frame shows the pose of one communication step before.
    error = np.interp(camera["t_mid"][seen] - 1 / 600, poses["time"], poses["q2"]) - camera["q2_est"][seen]
    print(f"  {camera['frame'][-1]} frames, q2 estimated to {1e3 * np.sqrt(np.mean(error**2)):.2f} mrad rms")

    poses = np.rec.fromarrays(
        [*(poses[name] for name in poses.dtype.names), np.zeros(len(poses)), np.full(len(poses), -1, dtype=np.int32)],
        names=[*poses.dtype.names, "z_desired", "frame"],
    )
    controller = simulate("controller", stop, input=poses)
    print(f"  z from {controller['z_hat'].min():.3f} to {controller['z_hat'].max():.3f}", end=", ")
    print(f"pulled back to 0 with torques from {controller['tau'].min():.2f} to {controller['tau'].max():.2f} N.m")


if __name__ == "__main__":
    main()
