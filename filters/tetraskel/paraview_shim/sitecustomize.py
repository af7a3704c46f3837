"""Lets ParaView 5.11 built with Python 3.11 or later (Debian 12, Ubuntu 24.04) load Python plugins.

ParaView 5.11 imports `inspect.getargspec`, which Python 3.11 removed, before it opens a plugin. Start it with this
folder on PYTHONPATH. ParaView 5.12 and later, and the binaries from its own site, need nothing of this.
"""

import inspect

if not hasattr(inspect, "getargspec"):
    inspect.getargspec = inspect.getfullargspec
