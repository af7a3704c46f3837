"""Write the sample clouds and the answers known about them.

    python sample_data/make_samples.py [FOLDER]

Every shape is defined by a few numbers, and every answer follows from them: an axis by how the tube is swept, a count
by trying all candidates. Seeds are fixed, so a second run with the same NumPy and VTK rewrites every file byte for
byte. Lengths have no unit.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from answers import Floats, Sample, write_answers
from small_clouds import box8, cloud20, polygon, rectangle8
from tubes import bent_tube, limbs, torus, tree_of_tubes, y_tube

SAMPLES: dict[str, Callable[[], Sample]] = {
    "rectangle8.csv": rectangle8,
    "polygon.csv": polygon,
    "cloud20.csv": cloud20,
    "box8.vtp": box8,
    "y_tube.vtp": y_tube,
    "torus.vtp": torus,
    "bent_tube.vtp": bent_tube,
    "tree_of_tubes.vtp": tree_of_tubes,
    "limbs.vtp": limbs,
}


def write_csv(path: Path, points: Floats) -> None:
    """Points (n, 3) as a table with the columns x, y and z."""
    rows = [",".join(f"{value:g}" for value in point) for point in points]
    path.write_text("\n".join(["x,y,z", *rows, ""]), encoding="utf-8", newline="\n")


def write_vtp(path: Path, points: Floats) -> None:
    """Points (n, 3) in single precision, each with a vertex cell so that ParaView shows it."""
    locations, vertices, cloud = vtkPoints(), vtkCellArray(), vtkPolyData()
    vertices.Use32BitStorage()
    locations.SetData(numpy_to_vtk(points.astype(np.float32), deep=True))
    for point in range(len(points)):
        vertices.InsertNextCell(1, [point])
    cloud.SetPoints(locations)
    cloud.SetVerts(vertices)
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(cloud)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()
    if not writer.Write():
        raise OSError(f"expected to write {path}, VTK could not; is the folder writable?")


def main(folder: Path) -> None:
    """Write every sample and `answers.json` to a folder, made if it is not there."""
    folder.mkdir(parents=True, exist_ok=True)
    answers = {}
    for name, make in SAMPLES.items():
        points, known = make()
        write = write_csv if name.endswith(".csv") else write_vtp
        write(folder / name, points)
        answers[Path(name).stem] = {"file": name, "n_points": len(points), **known}
    write_answers(folder / "answers.json", answers)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
