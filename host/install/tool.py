#!/usr/bin/env python3
"""Starts the script in share/sidestep/tools that has the name of this program, with the types in ../python."""
import runpy
import sys
from pathlib import Path

name = Path(sys.argv[0]).name
sys.dont_write_bytecode = True  # `make uninstall` would leave the bytecode behind
share = Path(__file__).resolve().parents[1] / "share/sidestep"
sys.path[:0] = [str(share / "tools"), str(share / "python")]
try:
    import lcm
except ImportError:
    sys.exit(f"{name}: {sys.executable} has no package lcm. Install it from PyPI (pip install lcm); "
             f"in a virtual environment start VENV/bin/python {sys.argv[0]}")
runpy.run_module(name.removeprefix("sidestep-").replace("-", "_"), run_name="__main__")
