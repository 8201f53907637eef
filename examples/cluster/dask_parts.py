"""Any command that can be cut by `--partition k/n`, on a Dask cluster:

    python examples/cluster/dask_parts.py 8 acroscope --quiet reproduce --out /shared/reproduce
    python examples/cluster/dask_parts.py --scheduler tcp://head:8786 16 acroscope --quiet reproduce --out /shared/reproduce

What the command writes lies on a file system that all workers see. Without a scheduler it starts a cluster of this machine: one
worker, since a part uses all its cores. A part whose worker is lost, or which fails, is made again, up to three times.
"""

import argparse
import subprocess

from dask.distributed import Client


def part(task: tuple[list[str], int, int]) -> str | None:
    """Makes a part, on a worker. What is wrong with the input (exit status 2) is answered: trying again would not mend it."""
    command, number, parts = task
    done = subprocess.run([*command, "--partition", f"{number}/{parts}"], capture_output=True, text=True)
    if done.returncode not in (0, 2):
        raise RuntimeError(f"part {number}: exit status {done.returncode}: {done.stderr.strip()}")
    return done.stderr.strip() if done.returncode == 2 else None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scheduler", help="address of the cluster")
    parser.add_argument("parts", type=int, help="how many parts")
    parser.add_argument("command", nargs=argparse.REMAINDER, help="what to run, with its arguments")
    given = parser.parse_args()
    tasks = [(given.command, number, given.parts) for number in range(1, given.parts + 1)]
    with Client(given.scheduler) if given.scheduler else Client(n_workers=1, threads_per_worker=1) as client:
        refused = [said for said in client.gather(client.map(part, tasks, retries=3, pure=False)) if said]
    if refused:
        raise SystemExit(refused[0])


if __name__ == "__main__":
    main()
