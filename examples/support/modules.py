# SPDX-License-Identifier: MIT
"""Ends a script with a message, not a traceback, if this Python lacks a module.

    need("matplotlib")        # before it is imported
"""

import importlib
import os
import pathlib
import shlex
import sys

NOTHING_DRAWN = 3
SYSTEM_PYTHON = "/usr/bin/python3"  # Debian's packages of modules are for this interpreter alone
NAMES = {"numpy": "NumPy", "scipy": "SciPy", "matplotlib": "Matplotlib"}


def has(name):
    try:
        importlib.import_module(name)
        return True
    except ImportError:
        return False


def need(*modules):
    """Ends the program with exit code NOTHING_DRAWN if any of these modules cannot be imported."""
    missing = [name for name in modules if not has(name)]
    if not missing:
        return
    names = " and ".join(NAMES.get(name, name) for name in missing)
    packages = " ".join(f"python3-{name}" for name in missing)
    advice = f"pip install {' '.join(missing)}"
    if sys.executable == SYSTEM_PYTHON or not os.access(SYSTEM_PYTHON, os.X_OK):
        advice += f", or on Debian apt-get install {packages}"
    else:
        advice += (f", or use another interpreter, e.g. with Debian's {packages}: "
                   f"{shlex.join([SYSTEM_PYTHON, *sys.argv])}")
    print(f"{pathlib.Path(sys.argv[0]).name}: needs {names}, which {sys.executable} lacks; "
          f"install: {advice}", file=sys.stderr)
    sys.exit(NOTHING_DRAWN)
