"""Continues a script with the Python of build/venv, which has its packages, where the one that started it lacks them."""
import importlib.util
import os
import sys
from pathlib import Path

PYTHON = Path(__file__).resolve().parents[2] / "build/venv/bin/python"

if importlib.util.find_spec("lcm") is None:
    if not PYTHON.is_file() or Path(sys.prefix) == PYTHON.parents[1]:
        sys.exit(f"{Path(sys.argv[0]).name}: the Python package lcm is missing: run make, which installs it in "
                 "build/venv, or install it yourself")
    os.execv(PYTHON, [str(PYTHON), *sys.argv])
