"""A picture for each measure: its median over the objects (of loops the mean), by program and number of points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista

MEASURES = {"loops_off": "loops too many or too few (mean)", "inside": "share inside", "centredness": "centredness",
            "reconstruction": "reconstruction, % of the diagonal", "stability": "turned: distance, % of the diagonal",
            "seconds": "seconds", "peak": "memory, MB"}  # fmt: skip
LOGARITHMIC = ("seconds", "peak", "reconstruction")
COLOURS = ("black", "tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple", "tab:brown", "tab:pink")


def draw_all(rows: list[dict], folder: Path) -> None:
    """One chart per measure, all in one picture; ours is the black line."""
    programs = list(dict.fromkeys(row["program"] for row in rows))
    plotter = pyvista.Plotter(off_screen=True, window_size=(1500, 1300))
    plotter.close()
    charts = pyvista.Plotter(shape=(4, 2), off_screen=True, window_size=(1500, 1700), border=False)
    for number, (name, title) in enumerate(MEASURES.items()):
        charts.subplot(*divmod(number, 2))
        chart = pyvista.Chart2D()
        chart.title, chart.x_label, chart.y_label = title, "points", ""
        chart.x_axis.log_scale = True
        chart.y_axis.log_scale = name in LOGARITHMIC
        chart.legend_visible = number == 0
        for program, colour in zip(programs, COLOURS, strict=False):
            sizes, values = medians(rows, program, name)
            if len(sizes):
                chart.line(sizes, values, color=colour, width=4.0 if program == "tetraskel" else 2.0, label=program)
        charts.add_chart(chart)
    folder.mkdir(parents=True, exist_ok=True)
    charts.screenshot(folder / "peers.png")
    charts.close()


def medians(rows: list[dict], program: str, name: str) -> tuple[list[int], list[float]]:
    """Sizes, and the median of a measure over the objects that the program could take (of loops the mean)."""
    mine = [row for row in rows if row["program"] == program and row.get(name) is not None]
    sizes = sorted({row["points"] for row in mine})
    middle = np.mean if name == "loops_off" else np.median
    return sizes, [float(middle([row[name] for row in mine if row["points"] == size])) for size in sizes]
