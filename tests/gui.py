"""The events that drive ParaView's window by its own widgets (QtTesting)."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

WINDOW = "pqClientMainWindow"
PANEL = f"{WINDOW}/propertiesDock/propertiesPanel"
PROPERTIES = f"{PANEL}/scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/PropertiesFrame/ProxyPanel"
MENU = "Skeleton Tree"


def event(target, command, arguments=""):
    return f'<pqevent object="{target}" command="{command}" arguments={quoteattr(arguments)} />'


def check(widget, value, what="text"):
    return f'<pqcheck object="{widget}" property="{what}" arguments={quoteattr(value)} />'


APPLY = event(f"{PANEL}/Accept", "activate")


def menu(name, *entries):
    """Choose an entry of the menu bar, through its sub-menus."""
    place, events = f"{WINDOW}/menubar", []
    for entry in (name, *entries):
        events.append(event(place, "activate", entry))
        place += f"/{entry}"
    return "\n".join(events)


def choose_filter(name):
    return menu("menuFilters", MENU, name)


def chain(*names):
    return "\n".join(f"{choose_filter(name)}\n{APPLY}" for name in names)


def playlist(events):
    """The file of events."""
    return '<?xml version="1.0" ?>\n<pqevents>\n' + "\n".join(events) + "\n</pqevents>\n"
