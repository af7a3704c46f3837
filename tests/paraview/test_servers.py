"""The plugin on servers: pvserver with a client, on one rank and on two, and pvbatch."""

from __future__ import annotations

import re
import subprocess
import time

import pytest
import pyvista

from paths import PLUGIN
from programs import SECONDS, environment, finished, program
from tetraskel import curve_skeleton, triangulate
from tubes import TUBES

CLIENT = """
import sys
from paraview.simple import *
if sys.argv[3:]:
    Connect("localhost", int(sys.argv[3]))
LoadPlugin(sys.argv[1], remote=False, ns=globals())
if sys.argv[3:]:
    LoadPlugin(sys.argv[1], remote=True, ns=globals())
cloud = XMLPolyDataReader(FileName=sys.argv[2])
curve = CurveSkeleton(Input=cloud, Detail=0.4)
tree = TreeBuilder(Input=DelaunayMesh(Input=cloud))
for proxy in (curve, tree):
    proxy.UpdatePipeline()
    proxy.UpdatePipelineInformation()
print(curve.GetDataInformation().GetNumberOfPoints(), curve.GetPropertyValue("Components"),
      curve.GetPropertyValue("Loops"), tree.GetDataInformation().GetNumberOfPoints(), sep=";")
wrong = FlatTetraRemoval(Input=tree, Threshold=2)
wrong.UpdatePipeline()
print(wrong.GetDataInformation().GetNumberOfPoints())
"""
RED = "FlatTetraRemoval: threshold must lie between 0 and 1; got 2."


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """What a ParaView without a server finds."""
    return found(tmp_path_factory.mktemp("alone"), "pvpython")


def found(folder, *command, port=None):
    """What the script prints, and what it says besides."""
    (folder / "client.py").write_text(CLIENT)
    pyvista.PolyData(TUBES["torus"]().sample(900)).save(folder / "torus.vtp")
    arguments = [str(PLUGIN), str(folder / "torus.vtp")]
    start = [program(command[0]), *command[1:], "client.py", *arguments, *([str(port)] if port else [])]
    done = finished(start, folder, {})
    assert done.returncode == 0, done.stderr
    return done.stdout.split(), done.stderr


@pytest.fixture
def server(tmp_path):
    """Start a pvserver on some ranks; gives its port."""
    started = []

    def start(ranks):
        idle = ["--mca", "mpi_yield_when_idle", "1"]  # waiting ranks leave the processor to those that work
        mpirun = [program("mpirun"), "--allow-run-as-root", "--oversubscribe", *idle, "-np", str(ranks)]
        log = tmp_path / "server.log"
        command = [*(mpirun if ranks > 1 else []), program("pvserver"), "--server-port=0"]
        with log.open("w") as said:
            started.append(subprocess.Popen(command, env=environment(), stdout=said, stderr=said, cwd=tmp_path))
        return port_of(log), log

    yield start
    for process in started:
        try:
            process.wait(10)  # it ends with its client
        except subprocess.TimeoutExpired:
            process.terminate()
            process.wait()


def port_of(log):
    """The port a server says it listens on."""
    begun = time.monotonic()
    while time.monotonic() - begun < SECONDS:
        told = re.search(r"Accepting connection\(s\): [^:]*:([1-9]\d*)", log.read_text())
        if told:
            return int(told[1])
        time.sleep(0.1)
    raise TimeoutError("pvserver does not say its port: " + log.read_text())


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_server_finds_the_same(ranks, server, alone, tmp_path):
    port, log = server(ranks)
    printed, said = found(tmp_path, "pvpython", port=port)
    assert printed == alone[0]
    (line,) = [line for line in said.splitlines() if re.search(r"\w", re.sub(r"\x1b\[\d*m", "", line))]
    assert line.endswith(f"ERR| {RED}")
    assert "Client connected." in log.read_text()


def test_alone_it_finds_what_there_is(alone):
    printed, said = alone
    n_points, components, loops, n_nodes = printed[0].split(";")
    points = TUBES["torus"]().sample(900)
    assert (components, loops) == ("1", "1")
    assert int(n_points) == len(curve_skeleton(points, detail=0.4))
    assert int(n_nodes) == len(triangulate(points))
    assert printed[1] == "0"
    assert said == RED + "\n"


def test_pvbatch_finds_the_same(alone, tmp_path):
    assert found(tmp_path, "pvbatch") == alone
