"""In the kernel of a notebook: what a cell shows, and Ctrl-C. Run by scripts/test-wheel.sh."""

import time

import pytest

manager = pytest.importorskip("jupyter_client.manager")


@pytest.fixture(scope="module")
def kernel():
    kernels, client = manager.start_new_kernel(kernel_name="python3")
    yield kernels, client
    client.stop_channels()
    kernels.shutdown_kernel(now=True)


def cell(kernel, source, interrupt_after=None):
    """Runs a cell, and interrupts it some seconds after it said "begun"; answers what it shows by type, or its error's name."""
    kernels, client = kernel
    shown = {}

    def take(message):
        content = message["content"]
        if message["msg_type"] == "stream":
            shown["stream"] = shown.get("stream", "") + content["text"]
            if "begun" in content["text"] and interrupt_after is not None:
                time.sleep(interrupt_after)
                kernels.interrupt_kernel()
        elif message["msg_type"] == "error":
            shown["error"] = content["ename"]
        else:
            shown.update(content.get("data", {}))

    client.execute_interactive(source, timeout=120, output_hook=take, store_history=False)
    return shown


def test_cells_show_graphs_and_pages(kernel):
    assert cell(kernel, "import acroscope as ac; r = ac.run('full-state', stop=0.2)") == {}
    assert "image/png" in cell(kernel, "r.plot()"), "a picture, and not a figure's name"
    page = cell(kernel, "r")["text/html"]
    assert page.startswith("<iframe srcdoc=") and "&lt;svg" in page
    assert "text/html" in cell(kernel, "ac.reproduce('table-3')")


def test_a_sweep_on_a_cluster_shows_how_far_it_is(kernel, tmp_path):
    pytest.importorskip("distributed")
    sweep = f"""
from pathlib import Path
from distributed import Client
study = Path({str(tmp_path)!r}) / "study.toml"
study.write_text('format = 1\\nscenario = "full-state"\\nstop = 1\\n[grid]\\n"plant.b_joint" = [0.1, 0.2, 0.3]\\n'
                 '[scalars]\\nlast = {{ signal = "plant.q1", reduce = "last" }}')
with Client(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as client:
    done = ac.sweep(study, client=client, out=study.parent / "out", partitions=3)
done
"""
    shown = cell(kernel, sweep)
    assert "100% Completed" in shown["stream"] and "<iframe" in shown["text/html"]


@pytest.mark.parametrize(
    "long",
    [
        "ac.run('visual-servo', stop=1000000)",
        "ac.Simulation('full-state', stop=1000000).step(until=1000000)",
        "ac.reproduce()",
    ],
)
def test_interrupting_a_cell_leaves_the_kernel(kernel, long):
    said = cell(kernel, f"import acroscope as ac; print('begun', flush=True); {long}", interrupt_after=1.0)
    assert said["error"] == "KeyboardInterrupt" and said["stream"].startswith("begun")
    assert cell(kernel, "ac.run('full-state', stop=0.1).last('time')")["text/plain"] == "0.1"
