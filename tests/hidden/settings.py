"""Settings: which rig, which logs, how noisy, how moved. Everything that a data set's visible side depends on."""

import math
from dataclasses import dataclass, field, replace

from .effects import BY_NAME, CAMERA_NOMINAL, LISTED, PLANT_NOMINAL

ENCODER = {"low": 5e-5, "mid": 2e-4, "high": 1e-3}  # rad
IMAGE = {"low": 1.0, "mid": 4.0, "high": 12.0}  # grey levels
TORQUE = {"low": 0.002, "mid": 0.01, "high": 0.03}  # N·m, where tau_applied is logged

MIXES = {
    "visual": {"mixed": ("steps", "ramp", "swing"), "lively": ("fast", "steps", "swing"),
               "slow": ("slow", "still", "slow")},
    "hang": {"mixed": ("drive", "elbow", "free"), "free": ("free", "free", "free"),
             "gentle": ("gentle", "gentle", "gentle")},
    "balance": {"mixed": ("drive", "swing", "drive"), "slow": ("slow", "still", "slow")},
}
# Mixes that only an experiment asks for
PROPOSED = {"visual": {"sweep": ("sweep",) * 3, "fast sweep": ("fast sweep",) * 3, "large": ("large",) * 3, "small": ("small",) * 3,
                       "ramps": ("ramp",) * 3}, "hang": {}, "balance": {}}
LOGS = {"visual": ("all", "plant", "image"), "hang": ("plant",), "balance": ("plant",)}
DURATION = {"visual": 20.0, "hang": 10.0, "balance": 10.0}
PLANT_RATE = {"visual": 30.0, "hang": 200.0, "balance": 200.0}
# Two pinned arms (R = 0): nominal theta_1, theta_5, theta_8, theta_9, theta_10
ARMS = (
    {"theta_1": 0.142, "theta_5": 0.031, "theta_8": 0.041, "theta_9": 4.05, "theta_10": 1.31},
    {"theta_1": 0.265, "theta_5": 0.094, "theta_8": 0.101, "theta_9": 6.9, "theta_10": 2.75},
)


@dataclass(frozen=True)
class Setting:
    rig: str = "visual"  # visual, hang, balance
    logs: str = "all"  # all, plant (with controller), image (camera with controller)
    noise: str = "mid"
    mix: str = "mixed"
    arm: int = 0
    applied: bool = False  # tau_applied logged
    velocity_nominal: bool = True
    turned: bool = False  # camera mounted turned by 90 degrees (nominal, in [set])
    exposure: float = 0.01  # nominal E_t
    often: bool = False  # the plant is logged 200 times a second whatever the rig; the table of MDEs knows no difference
    # no part of a set's name: what experiments ask for does not make other sets of those before
    slanted: bool = field(default=False, repr=False)  # camera mounted turned by 0.7 rad (nominal, in [set])
    longer: int = field(default=1, repr=False)  # times as many runs

    @property
    def key(self):
        extra = "".join([f"-arm{self.arm}" if self.rig != "visual" else "", "-applied" if self.applied else "",
                         "" if self.velocity_nominal else "-novel", "-turned" if self.turned else "", "-slanted" if self.slanted else "",
                         "" if self.exposure == 0.01 else f"-exposure{self.exposure:g}"])
        return f"{self.rig}-{self.logs}-{self.noise}-{self.mix}{extra}"

    @property
    def excitations(self):
        return self.longer * {**MIXES[self.rig], **PROPOSED[self.rig]}[self.mix]

    @property
    def duration(self):
        return DURATION[self.rig]

    @property
    def plant_rate(self):
        return 200.0 if self.often else PLANT_RATE[self.rig]

    def nominal(self):
        """(plant, camera) as the data set's [set] declares them."""
        plant = dict(PLANT_NOMINAL, velocity_terms=float(self.velocity_nominal))
        camera = dict(CAMERA_NOMINAL, sigma=IMAGE[self.noise], E_t=self.exposure)
        if self.rig != "visual":
            plant.update(ARMS[self.arm], theta_2=0.0, theta_7=0.0, q2_max=1e9, theta_slope=0.0)
        if self.turned or self.slanted:
            camera["roll"] = math.pi / 2 if self.turned else 0.7
        return plant, camera

    def declared(self):
        """The [set] table."""
        plant, camera = self.nominal()
        table = {}
        if self.rig != "visual":
            for k in ("theta_1", "theta_2", "theta_5", "theta_7", "theta_8", "theta_9", "theta_10", "q2_max"):
                table[f"plant.{k}"] = plant[k]
        else:
            table["camera.sigma"] = camera["sigma"]
        if not self.velocity_nominal:
            table["plant.velocity_terms"] = False
        if self.turned or self.slanted:
            table["camera.roll"] = camera["roll"]
        if self.exposure != 0.01:
            table["camera.E_t"] = self.exposure
        return table

    def candidates(self):
        """Listed effects that can matter in this setting."""
        chosen = []
        for e in LISTED:
            if self.rig != "visual" and (e.side == "camera" or e.key in ("slope", "theta_2", "theta_7")):
                continue
            if self.logs == "plant" and e.side == "camera":
                continue
            chosen.append(e)
        return chosen

    def with_(self, **changes):
        return replace(self, **changes)


def off_value(effect, setting):
    plant, camera = setting.nominal()
    return (plant if effect.side == "plant" else camera)[effect.key]


def value_at(effect, setting, magnitude, sign=1.0):
    """Parameter value for a magnitude counted from the neutral value (for limits: the limit itself)."""
    if effect.shape == "limit":
        return magnitude
    if effect.shape == "switch":
        return 1.0 - off_value(effect, setting)
    if effect.shape == "noise":
        return off_value(effect, setting) + magnitude
    return off_value(effect, setting) + sign * magnitude


def apply(name, value, plant, camera):
    """Sets a listed effect in the true machine."""
    e = BY_NAME[name]
    (plant if e.side == "plant" else camera)[e.key] = float(value)
