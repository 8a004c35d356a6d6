#!/usr/bin/env python3
"""Starts the script of share/sidestep/tools that the name of this program says."""
import runpy
import sys
from pathlib import Path

name = Path(sys.argv[0]).name
sys.dont_write_bytecode = True  # nothing that was not installed
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "share/sidestep/tools"))
try:
    import lcm
except ImportError:
    sys.exit(f"{name}: {sys.executable} has no package lcm. It comes from PyPI (pip install lcm); "
             f"from a virtual environment: VENV/bin/python {sys.argv[0]}")
runpy.run_module(name.removeprefix("sidestep-").replace("-", "_"), run_name="__main__")
