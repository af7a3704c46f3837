"""What a filter found, for the read-only fields of a panel: counts and facts of its first output.

Composite data come block by block: counts are added up, other facts are named once each.
"""

from __future__ import annotations

from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet, vtkDataSet, vtkPolyData

from tetraskel.vtkfilters.convert import single_facts

DIGITS = 6


def whole_input(algorithm):
    """What is at the first input: while a block is executed the block, before it the composite."""
    connection = algorithm.GetInputConnection(0, 0)
    if connection is None:
        return None
    return connection.GetProducer().GetOutputDataObject(connection.GetIndex())


def count_blocks(data) -> int:
    """The blocks of a composite that hold data; 1 for any other data set."""
    if not isinstance(data, vtkCompositeDataSet):
        return 1
    leaves = data.NewIterator()
    leaves.InitTraversal()
    n = 0
    while not leaves.IsDoneWithTraversal():
        n += 1
        leaves.GoToNextItem()
    return n


def facts_of(data: vtkDataSet) -> dict[str, int | float | str]:
    """Numbers of points and cells, and the single facts of the field data.

    Polygonal data have `Lines` and `Polygons`, other data `Cells`.
    """
    if isinstance(data, vtkPolyData):
        counts = {"Lines": data.GetNumberOfLines(), "Polygons": data.GetNumberOfPolys()}
    else:
        counts = {"Cells": data.GetNumberOfCells()}
    return {"Points": data.GetNumberOfPoints(), **counts, **single_facts(data)}


def gathered(blocks: list[dict[str, int | float | str]], fact: str) -> str:
    """A fact of all blocks as text; empty where none has it."""
    values = [facts[fact] for facts in blocks if fact in facts]
    if values and all(isinstance(value, int) for value in values):
        return str(sum(values))
    return ", ".join(dict.fromkeys(_text(value) for value in values))


def _text(value: int | float | str) -> str:
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)
