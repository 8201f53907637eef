"""The README's moving picture: the acrobot of a run, and the tracking along the manifold, as one SVG that plays by itself.

    cargo acroscope run visual-servo
    python scripts/loop_svg.py out/visual-servo/results.csv docs/figures/loop.svg
"""

import argparse
import csv
import math
from pathlib import Path

L1, L2, RADIUS, GROUND = 6.19, 6.9, 1.0, -8.0  # world units, docs/claims.md
PACE = 10  # poses a second of the run
SPEED = 2.0  # times real time
SCALE = 12.0  # px per world unit
WIDTH, HEIGHT = 640, 256
GRAPH = (330, 40, 280, 170)  # left, top, width, height, px
NAMES = ("plant.q1", "plant.q2", "plant.z", "controller.z_desired")


def poses(file):
    """[time, q1, q2, z, z_desired], PACE a second."""
    found, due = [], 0.0
    with open(file) as rows:
        for row in csv.DictReader(rows):
            if float(row["time"]) >= due - 1e-9:
                found.append([float(row["time"]), *(float(row[n]) for n in NAMES)])
                due += 1.0 / PACE
    return found


def animate(attribute, values, seconds, kind="animate", more=""):
    return (f'<{kind} attributeName="{attribute}" {more} dur="{seconds:g}s" repeatCount="indefinite" calcMode="linear" '
            f'values="{";".join(values)}"/>')


def arm(found, seconds):
    """Drum, links and tip; each link turns in the frame of what carries it."""
    x = lambda q1: f"{SCALE * RADIUS * q1:.2f} 0"
    degrees = lambda q: f"{math.degrees(q):.2f}"
    rolls = animate("transform", [x(p[1]) for p in found], seconds, "animateTransform", 'type="translate"')
    first = animate("transform", [degrees(p[1]) for p in found], seconds, "animateTransform", 'type="rotate"')
    second = animate("transform", [degrees(p[2] - p[1]) for p in found], seconds, "animateTransform", 'type="rotate"')
    ground = -SCALE * RADIUS  # of the drum's centre above the ground, downwards in SVG
    return f"""<g transform="translate(160 {HEIGHT - 40 + ground:.1f})">
<line x1="-140" y1="{-ground:.1f}" x2="140" y2="{-ground:.1f}" class="ground"/>
<g>{rolls}<circle r="{SCALE * RADIUS:.1f}" class="drum"/>
<g>{first}<line y2="{-SCALE * L1:.1f}" class="link"/><line y2="{-SCALE * RADIUS:.1f}" class="spoke"/>
<g transform="translate(0 {-SCALE * L1:.1f})"><g>{second}<line y2="{-SCALE * L2:.1f}" class="link"/>
<circle cy="{-SCALE * L2:.1f}" r="4" class="mark"/></g><circle r="4" class="mark"/></g></g><circle r="4" class="mark"/></g></g>"""


def graph(found, seconds):
    left, top, width, height = GRAPH
    end = found[-1][0]
    low, high = min(min(p[3:]) for p in found) - 0.05, max(max(p[3:]) for p in found) + 0.05
    at = lambda t, z: f"{left + width * t / end:.1f},{top + height * (high - z) / (high - low):.1f}"
    lines = "".join(f'<polyline class="{c}" points="{" ".join(at(p[0], p[k]) for p in found)}"/>' for k, c in ((4, "wanted"), (3, "is")))
    cursor = animate("x1", [f"{left + width * p[0] / end:.1f}" for p in (found[0], found[-1])], seconds)
    cursor += animate("x2", [f"{left + width * p[0] / end:.1f}" for p in (found[0], found[-1])], seconds)
    ticks = "".join(f'<text x="{at(0, z).split(",")[0]}" dx="-8" y="{at(0, z).split(",")[1]}" dy="4" text-anchor="end">{z:g}</text>'
                    for z in (0.0, 0.25, 0.5))
    ticks += "".join(f'<text x="{at(t, low).split(",")[0]}" y="{top + height + 18}" text-anchor="middle">{t:g}</text>' for t in (0, 10, 20, 30) if t <= end)
    return f"""<rect x="{left}" y="{top}" width="{width}" height="{height}" class="frame"/>{lines}
<line y1="{top}" y2="{top + height}" class="cursor">{cursor}</line>{ticks}
<text x="{left + width / 2}" y="{top + height + 38}" text-anchor="middle">time in s</text>
<text x="{left}" y="{top - 12}">place z: <tspan class="key">desired</tspan>, and the arm</text>"""


STYLE = """text{font:13px sans-serif;fill:#444}.ground{stroke:#888;stroke-width:2}.drum{fill:none;stroke:#888;stroke-width:2}
.link{stroke:#2a6f97;stroke-width:6;stroke-linecap:round}.spoke{stroke:#888}.mark{fill:#fff;stroke:#2a6f97;stroke-width:2}
.frame{fill:none;stroke:#bbb}.wanted{fill:none;stroke:#e07a00;stroke-width:4;opacity:.55}.is{fill:none;stroke:#2a6f97;stroke-width:1.5}
.key{fill:#b05f00}.cursor{stroke:#888}"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    parser.add_argument("svg", type=Path)
    arguments = parser.parse_args()
    found = poses(arguments.results)
    seconds = found[-1][0] / SPEED
    arguments.svg.parent.mkdir(parents=True, exist_ok=True)
    arguments.svg.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" role="img">\n'
        f"<title>The acrobot, balanced by what its camera sees, at {SPEED:g} times real time</title>\n<style>{STYLE}</style>\n"
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>\n{arm(found, seconds)}\n{graph(found, seconds)}\n</svg>\n')


if __name__ == "__main__":
    main()
