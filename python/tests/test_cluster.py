"""A sweep on a Dask cluster of two worker processes, one of which is killed in the middle. Run by scripts/test-wheel.sh."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pyarrow.parquet
import pytest

import acroscope as ac

distributed = pytest.importorskip("distributed")

STUDY = """
format = 1
scenario = "visual-servo"
stop = 1
[latin-hypercube]
count = 96
seed = 5
"camera.T_delay" = { from = 0, to = 0.06 }
"plant.q2_0" = { from = 0.05, to = 0.2 }
[scalars]
rms = { signal = "controller.z_desired", minus = "plant.z", reduce = "rms" }
fell = { signal = "plant.contact", reduce = "first_true" }
"""


def test_a_killed_worker_costs_nothing(tmp_path):
    study = tmp_path / "study.toml"
    study.write_text(STUDY)
    alone = ac.sweep(study, out=tmp_path / "alone").table()
    assert alone["case"].to_pylist() == list(range(96)) and set(alone["status"].to_pylist()) == {"ok"}
    out = tmp_path / "spread"
    killed = []

    def kill(pids):
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline:
            if len(list(out.glob("cases/part-*.parquet"))) >= 2:
                os.kill(pids[0], signal.SIGKILL)
                killed.append(pids[0])
                return
            time.sleep(0.005)

    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        pids = list(client.run(os.getpid).values())
        killer = threading.Thread(target=kill, args=(pids,))
        killer.start()
        done = ac.sweep(study, client=client, out=out, partitions=24)
        killer.join()
    assert killed, "the sweep was over before a worker could be killed"
    assert len(done.files) == 24 and done.table().equals(alone)
    assert (out / "report.html").is_file()
    assert not list(out.glob("cases/.part-*")), "the last call clears away what the killed worker left"


def test_parts_are_read_by_others(tmp_path):
    study = tmp_path / "study.toml"
    study.write_text(STUDY.replace("count = 96", "count = 3"))
    done = ac.sweep(study, out=tmp_path / "out", jobs=1)
    assert pyarrow.parquet.ParquetFile(done.files[0]).schema_arrow.metadata[b"unit:camera.T_delay"] == b"s"
    with pytest.raises(ac.InputError, match="did you mean delay-and-rate"):
        ac.sweep("delay-and-rte")
    with pytest.raises(ac.InputError, match="all workers see"):
        ac.sweep(study, client=object())


def test_the_programs_for_dask_work(tmp_path):
    """Those of examples/cluster: a sweep, and any command that takes `--partition`."""
    folder = Path(ac.__file__).parent / "data" / "examples" / "cluster"
    study = tmp_path / "study.toml"
    study.write_text(STUDY.replace("count = 96", "count = 3"))
    subprocess.run([sys.executable, folder / "dask_sweep.py", study, tmp_path / "spread"], check=True)
    alone = ac.sweep(study, out=tmp_path / "alone").table()
    assert pyarrow.parquet.read_table(tmp_path / "spread" / "cases").equals(alone)
    command = [sys.executable, "-m", "acroscope", "--quiet", "reproduce", "tables-1-2", "table-3", "--out"]
    subprocess.run([sys.executable, folder / "dask_parts.py", "2", *command, tmp_path / "parts"], check=True)
    subprocess.run([*command, tmp_path / "whole"], check=True)
    assert (tmp_path / "parts" / "claims.json").read_bytes() == (tmp_path / "whole" / "claims.json").read_bytes()
    wrong = [sys.executable, folder / "dask_parts.py", "2", *command, tmp_path / "wrong", "table-99"]
    refused = subprocess.run(wrong, capture_output=True, text=True)
    assert refused.returncode == 1 and "table-99" in refused.stderr
