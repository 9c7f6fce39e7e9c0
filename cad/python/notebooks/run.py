"""Runs every notebook from its folder; writes the results with outputs into a folder if one is given.

``python notebooks/run.py [FOLDER]``
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).parent
#: The readers have no annotations.
FORMAT: Any = nbformat
#: Longest time of a cell in seconds.
TIMEOUT_S = 600


def main() -> None:
    """Run the notebooks."""
    for path in sorted(HERE.glob("*.ipynb")):
        notebook = FORMAT.read(path, as_version=4)
        assert all(not cell.get("outputs") for cell in notebook.cells), f"{path.name} has outputs"
        client = NotebookClient(notebook, timeout=TIMEOUT_S, resources={"metadata": {"path": str(HERE)}})
        client.execute()
        print(path.name)
        if len(sys.argv) > 1:
            Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
            FORMAT.write(notebook, Path(sys.argv[1]) / path.name)


if __name__ == "__main__":
    main()
