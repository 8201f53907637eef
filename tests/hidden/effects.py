"""Every effect that can be hidden: names as in NOTATION.md, with neutral values, typical sizes and limits. Those of `BESIDE` are hidden by
`one` alone.

Unknown effects carry the prefix `unknown.`; the product has no parameter for them.
"""

import math
from dataclasses import dataclass

THETA = {
    "theta_1": 0.20386,
    "theta_2": 0.05867,
    "theta_5": 0.11,
    "theta_7": 0.01437,
    "theta_8": 0.0989,
    "theta_9": 4.779,
    "theta_10": 1.880,
}  # Table 2


@dataclass(frozen=True)
class Effect:
    """One hidden effect.

    probe: size at which its signature is taken (linear range); signs: signs it may have;
    shape: "linear" (signature grows with the size), "limit" (smaller = stronger, 0 = off), "integer", "switch".
    big: a size a lab would call large (part `large`).
    """

    name: str
    off: float
    probe: float
    big: float
    signs: tuple = (1.0, -1.0)
    shape: str = "linear"

    @property
    def side(self):
        return self.name.split(".")[0]

    @property
    def key(self):
        return self.name.split(".")[1]


BOTH = (1.0, -1.0)
UP = (1.0,)

LISTED = [
    Effect("plant.b_roll", 0.0, 0.01, 0.05, UP),
    Effect("plant.b_joint", 0.0, 0.01, 0.02, UP),
    Effect("plant.fc_roll", 0.0, 0.003, 0.02, UP),
    Effect("plant.fc_joint", 0.0, 0.003, 0.02, UP),
    Effect("plant.I_rotor", 0.0, 0.002, 0.005, UP),
    Effect("plant.tau_max", 0.0, 1.0, 1.5, UP, "limit"),
    Effect("plant.dtau_max", 0.0, 20.0, 15.0, UP, "limit"),
    Effect("plant.T_act", 0.0, 0.002, 0.008, UP),
    Effect("plant.tau_delay", 0.0, 0.002, 0.01, UP),
    Effect("plant.tau_bias", 0.0, 0.01, 0.05),
    Effect("plant.k_tau", 1.0, 0.01, 0.1),
    Effect("plant.slope", 0.0, 0.01, 0.03),
    Effect("plant.velocity_terms", 1.0, 1.0, 1.0, UP, "switch"),
    *[Effect(f"plant.{k}", v, 0.01 * v, 0.06 * v) for k, v in THETA.items()],
    Effect("camera.k1", 0.0, 0.02, 0.05),
    Effect("camera.p1", 0.0, 0.01, 0.015),
    Effect("camera.p2", 0.0, 0.01, 0.015),
    Effect("camera.s1", 0.0, 0.01, 0.015),
    Effect("camera.s2", 0.0, 0.01, 0.015),
    Effect("camera.k2", 0.0, 0.02, 0.05),
    Effect("camera.beta", 0.0, 1.0, 3.0, UP, "integer"),
    Effect("camera.N", 0.0, 1.0, 2.0, UP, "integer"),
    Effect("camera.sigma", 0.0, 1.0, 15.0, UP, "noise"),
    Effect("camera.roll", 0.0, 0.01, 0.02),
    Effect("camera.pan", 0.0, 0.005, 0.01),
    Effect("camera.tilt", 0.0, 0.005, 0.01),
    Effect("camera.u0", 0.0, 0.004, 0.02),
    Effect("camera.v0", 0.0, 0.004, 0.02),
    Effect("camera.scale", 1.0, 0.01, 0.03),
    Effect("camera.drop_rate", 0.0, 0.05, 0.1, UP, "rate"),
    Effect("camera.E_t", 0.01, 0.1, 0.5, UP),
    Effect("camera.T_delay", 0.0, 0.002, 0.02, UP),
]
# Effects that no part draws: a line more in LISTED would change what every seed hides, and with it the fixed slice and its gates.
BESIDE = [
    Effect("plant.incline", 0.0, 0.01, 0.03),
]
BY_NAME = {e.name: e for e in LISTED + BESIDE}

# Unknown effects: option keys of the simulation with a weak and a strong size (both well above the noise).
UNKNOWN = {
    "unknown.backlash": ("backlash", 0.004, 0.02),  # half gap, rad at the joint
    "unknown.stribeck": ("stribeck", 0.03, 0.08),  # breakaway torque above none, N·m, decays over 0.15 rad/s
    "unknown.cable": ("cable", 0.03, 0.15),  # spring between the links, N·m/rad
    "unknown.gust": ("gust", 0.05, 0.3),  # peak torque of pulses, N·m
    "unknown.rolling_shutter": ("rolling_shutter", 0.3, 0.95),  # share of the frame period
    "unknown.clock_drift": ("clock_drift", 2e-4, 2e-3),  # relative drift of the plant's clock
    "unknown.bent_target": ("bent_target", 0.02, 0.15),  # world units across the link, circle 3
    "unknown.k2": ("k2", 0.02, 0.08),  # camera.k2 while withheld from the list
}

CAMERA_NOMINAL = {
    "R": 1.0, "l1": 6.19, "l2": 6.9, "radius": 0.2, "ground": -8.0, "field_of_view": 20.0,
    "foreground": 255.0, "background": 0.0, "f": 2.0, "omega_cam": 30.0, "E_t": 0.01, "T_delay": 0.0,
    "threshold": 191.0, "N_min": 40.0, "N_max": 130.0,
    "k1": 0.0, "p1": 0.0, "p2": 0.0, "s1": 0.0, "s2": 0.0, "k2": 0.0, "beta": 0.0, "N": 0.0, "sigma": 0.0,
    "roll": 0.0, "pan": 0.0, "tilt": 0.0, "u0": 0.0, "v0": 0.0, "scale": 1.0, "drop_rate": 0.0,
    "rolling_shutter": 0.0, "bent_target": 0.0,
}
PLANT_NOMINAL = {
    **THETA, "velocity_terms": 1.0, "q2_max": 2.35, "theta_slope": 0.956,
    "b_roll": 0.0, "b_joint": 0.0, "fc_roll": 0.0, "fc_joint": 0.0, "I_rotor": 0.0,
    "tau_max": 0.0, "dtau_max": 0.0, "T_act": 0.0, "tau_delay": 0.0, "tau_bias": 0.0, "k_tau": 1.0, "slope": 0.0, "incline": 0.0,
    "backlash": 0.0, "stribeck": 0.0, "cable": 0.0, "gust": 0.0,
}
POLES = (6.11, 0.84, 3.52, 0.54)
HALF_TURN = math.pi
