"""Logs of DFKI's double pendulums as data sets for `acroscope diagnose`: an example of how to bring a rig's own logs.

    git clone https://github.com/dfki-ric-underactuated-lab/double_pendulum
    python scripts/rigs/dfki.py double_pendulum out/rigs            writes out/rigs/c0 and others
    cargo acroscope diagnose out/rigs/c0 --out out/rigs/c0-diagnosis

Real machines: three arms with encoders and motor current, excited from hanging, and balanced at the unstable upright (acrobot
by LQR, pendubot by TVLQR; acrobot by TVLQR with falls). The logs are BSD-3-Clause.

What has to be done for any rig is here: angles are absolute and from the upright (docs/units.md: q1 of link 1, q2 of link 2), the
torque at the joint is `tau`, that of link 1 against the ground `tau_1`, and the nominal model is a pinned arm (R = 0: theta_2 =
theta_7 = 0) with the masses and lengths as published, without friction and rotor inertia, which the diagnosis is to find.
"""

import argparse
import csv
import math
from pathlib import Path

GRAVITY = 9.81
RECORDS = Path("data/experiment_records")
# identified_parameters/design_*/model_*/model_parameters.yml, the rigid body alone
ARM_A = dict(
    I1=0.053470810264216295, I2=0.02392374528789766, m1=0.5593806151425046, m2=0.6043459469186889,
    r1=0.3, r2=0.18377686083653508, l1=0.3,
)
ARM_C = dict(
    I1=0.02671076499939512, I2=0.053878129629650884, m1=0.6416937799349799, m2=0.563935954099688,
    r1=0.2, r2=0.3212669909674605, l1=0.2,
)
ARM_C1 = dict(
    I1=0.031887199591513114, I2=0.05086984812807257, m1=0.5234602302310271, m2=0.6255677234174437,
    r1=0.2, r2=0.25569305436052964, l1=0.2,
)
# name: (arm, where its logs lie)
SETS = {
    "c0": (ARM_C, "design_C.0/20220914/sys_id/*.csv"),
    "c0-upright": (ARM_C, "design_C.0/20220914/172144_acrobot_lqr_video/trajectory.csv"),
    "c0-falls": (ARM_C, "design_C.0/20220914/*_acrobot_tvlqr_video/trajectory.csv"),
    "c1": (ARM_C1, "design_C.1/sys_id/20230629/*/trajectory.csv"),
    "a0-upright": (ARM_A, "design_A.0/20220819/*/trajectory.csv"),
    "a0-2022-08-12": (ARM_A, "design_A.0/20220812/sys_id/*.csv"),
}
# names of the columns in the two formats of these logs
FORMATS = [
    ("pos_meas1", "pos_meas2", "vel_meas1", "vel_meas2", "tau_meas1", "tau_meas2"),
    ("pos1", "pos2", "vel1", "vel2", "tau1", "tau2"),
]


def thetas(arm):
    """The plant's parameters (paper, eq. (12)) of a pinned arm."""
    return {
        "theta_1": arm["I1"] + arm["m2"] * arm["l1"] ** 2,
        "theta_2": 0.0,
        "theta_5": arm["I2"],
        "theta_7": 0.0,
        "theta_8": arm["m2"] * arm["r2"] * arm["l1"],
        "theta_9": GRAVITY * (arm["m1"] * arm["r1"] + arm["m2"] * arm["l1"]),
        "theta_10": GRAVITY * arm["m2"] * arm["r2"],
    }


def manifest(arm, runs):
    """dataset.toml: the nominal model and what is known of the noise."""
    nominal = "".join(f'"plant.{name}" = {value:.10g}\n' for name, value in thetas(arm).items())
    listed = "".join(f'\n[[run]]\ndir = "{run}"\n' for run in runs)
    return f"""format = 1
scenario = "visual-servo"

[set]
{nominal}"plant.q2_max" = 1e9
"plant.velocity_terms" = true

[noise]                   # encoder step 3.8e-4 rad; rates are the motors' own
"plant.q1" = 1.1e-4
"plant.q2" = 1.6e-4
"plant.dq1" = 0.05
"plant.dq2" = 0.07
{listed}"""


def rows(path):
    """time, angles, rates and torques of one log; none if it holds no such columns."""
    with path.open(newline="") as file:
        table = csv.DictReader(file)
        names = next((names for names in FORMATS if names[0] in (table.fieldnames or [])), None)
        if names is None:
            return
        before = -math.inf
        for row in table:
            try:
                time, *values = (float(row[name]) for name in ("time", *names))
            except (KeyError, TypeError, ValueError) as error:
                raise SystemExit(f"{path}:{table.line_num}: a number is needed in time and {', '.join(names)} ({error})")
            if time > before:
                yield time, *values
            before = max(before, time)


def write(path, head, lines):
    with path.open("w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(head)
        out.writerows([f"{value:.9g}" for value in line] for line in lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkout", type=Path, help="a clone of dfki-ric-underactuated-lab/double_pendulum")
    parser.add_argument("out", type=Path, help="folder for the data sets")
    arguments = parser.parse_args()
    records = arguments.checkout / RECORDS
    if not records.is_dir():
        parser.error(f"{arguments.checkout}: there is no {RECORDS} in it; a clone of double_pendulum has one")
    for name, (arm, pattern) in SETS.items():
        runs = []
        for path in sorted(records.glob(pattern)):
            log = list(rows(path))
            if not log:
                print(f"{path}: none of the known columns, skipped")
                continue
            folder = arguments.out / name / f"run-{len(runs):02}"
            folder.mkdir(parents=True, exist_ok=True)
            # relative angles from hanging become absolute ones from the upright
            motion = ((t, math.pi + p1, math.pi + p1 + p2, v1, v1 + v2) for t, p1, p2, v1, v2, _, _ in log)
            write(folder / "plant.csv", ["time", "q1", "q2", "dq1", "dq2"], motion)
            torques = ((t, tau2, tau1) for t, _, _, _, _, tau1, tau2 in log)
            write(folder / "controller.csv", ["time", "tau", "tau_1"], torques)
            runs.append(folder.name)
        if runs:
            (arguments.out / name / "dataset.toml").write_text(manifest(arm, runs))
            print(f"{arguments.out / name}: {len(runs)} runs")


if __name__ == "__main__":
    main()
