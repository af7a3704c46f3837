"""How ParaView draws each output at the first Apply.

ParaView's hints choose a kind of representation but not the width of its lines. So the plugin declares representations
of its own, which are ParaView's for geometry under another name, and ParaView's settings give these names defaults.
What a user saves as default settings comes before ours.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field

PRIORITY = 0.1  # below a site's and a user's settings


@dataclass(frozen=True)
class Look:
    """A way of drawing.

    Attributes
    ----------
    kind : str
        ParaView's word for it: Surface, Points, ...; empty for nothing to be seen.
    representation : str
        Name of the representation that has `settings`; empty for ParaView's own.
    settings : dict
        Its defaults where they are not ParaView's.
    """

    kind: str = "Surface"
    representation: str = ""
    settings: dict[str, float] = field(default_factory=dict)


TUBES = {"RenderLinesAsTubes": 1, "RenderPointsAsSpheres": 1}
LOOKS = {
    "lines": Look("Surface", "SkeletonLines", {**TUBES, "LineWidth": 6.0, "PointSize": 6.0}),
    "thin lines": Look("Surface", "SkeletonThinLines", {**TUBES, "LineWidth": 3.0, "PointSize": 5.0}),
    "cloud": Look("Points", "SkeletonCloud", {"PointSize": 2.0, "Opacity": 0.35}),
    "surface": Look("Surface"),
    "mesh": Look("Surface With Edges"),
    "hidden": Look(""),
}
REPRESENTATIONS = tuple(look.representation for look in LOOKS.values() if look.representation)


def display_hints(cls) -> str:
    """The hints for a filter's outputs."""
    return "".join(_hints_of(LOOKS[word], port) for port, word in enumerate(cls.drawn_as))


def _hints_of(look: Look, port: int) -> str:
    if not look.kind:
        return f'<View type="None" port="{port}"/>'
    chosen = f'<RepresentationType view="RenderView" type="{look.kind}" port="{port}"/>'
    if look.representation:
        chosen += f'<Representation view="RenderView" type="{look.representation}" port="{port}"/>'
    return chosen


def representation(name: str) -> dict[str, str | bool]:
    """What `smproxy.source` takes to declare one of `REPRESENTATIONS`."""
    return {
        "name": name,
        "label": "Geometry Representation",
        "type": "PVRepresentationProxy",
        "group": "representations",
        "base_proxygroup": "representations",
        "base_proxyname": "GeometryRepresentation",
        "class": "vtkPVCompositeRepresentation",
        "si_class": "vtkSIPVRepresentationProxy",
        "processes": "client|renderserver|dataserver",
        "support_reload": False,
    }


def give_defaults() -> None:
    """Put the defaults of our representations into the settings of this process; without them lines are thin."""
    try:
        from paraview.modules.vtkRemotingServerManager import vtkSMSettings
    except ImportError:  # a server without them
        return
    known = {look.representation: look.settings for look in LOOKS.values() if look.representation}
    vtkSMSettings.GetInstance().AddCollectionFromString(json.dumps({"representations": known}), PRIORITY)
