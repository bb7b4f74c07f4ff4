"""An adapter as a program: ``cohaul compare SCENE --engine "python -m cohaul.engines Pymunk"``."""

from __future__ import annotations

import sys

from cohaul import engines

if len(sys.argv) != 2 or sys.argv[1] not in engines.ADAPTERS:
    sys.exit(f"usage: python -m cohaul.engines ENGINE, where ENGINE is one of {', '.join(engines.ADAPTERS)}")
engines.serve(getattr(engines, sys.argv[1]))
