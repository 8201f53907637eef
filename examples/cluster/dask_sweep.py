"""A sweep on a Dask cluster: `python examples/cluster/dask_sweep.py STUDY FOLDER [SCHEDULER]`.

FOLDER lies on a file system that all workers see, and the wheel is installed where they run. Without SCHEDULER (such as
tcp://head:8786) it starts a cluster of this machine's cores. From a Slurm queue take dask_jobqueue.SLURMCluster.
"""

import sys

from dask.distributed import Client

import acroscope as ac


def main(study: str, folder: str, scheduler: str | None = None) -> None:
    with Client(scheduler) if scheduler else Client(threads_per_worker=1) as client:
        print(ac.sweep(study, client=client, out=folder))


if __name__ == "__main__":
    main(*sys.argv[1:])
