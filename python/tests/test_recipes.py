"""Recipes are notebooks. Each one runs unchanged, cell after cell, if its packages are installed. One also runs by nbclient."""

import json
import subprocess
import sys
from pathlib import Path

import pytest


RECIPES = Path(__file__).parents[1] / "recipes"
PACKAGES = {
    "axle": ["pandas", "matplotlib"],
    "bad_input": [],
    "casadi": ["casadi"],
    "curves": ["pandas", "matplotlib"],
    "dask": ["distributed"],
    "from_numbers": [],
    "gradients": [],
    "jax": ["jax"],
    "least_squares": ["scipy", "matplotlib"],
    "million_designs": ["pandas"],
    "optuna": ["optuna"],
    "pymoo": ["pymoo"],
    "tolerances": ["pandas", "matplotlib"],
}
# The tests use a module compiled without optimisation, so the recipes run with few designs, builds and trials.
SMALL = {"HARDPOINT_DESIGNS": "5000", "HARDPOINT_BUILDS": "300", "HARDPOINT_TRIALS": "10", "HARDPOINT_GENERATIONS": "6"}


def sources(recipe):
    """Source texts of the code cells."""
    notebook = json.loads((RECIPES / f"{recipe}.ipynb").read_text(encoding="utf-8"))
    return ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]


def by_nbclient(recipe):
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(RECIPES / f"{recipe}.ipynb", as_version=4)
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(RECIPES)}}).execute()


def cell_after_cell(recipe):
    """Runs all cells in one process. Starting a kernel for each recipe would take longer than most recipes run."""
    code = "\n\n".join(sources(recipe))
    command = [sys.executable, "-P", "-c", code]
    done = subprocess.run(command, cwd=RECIPES, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr


def test_every_recipe_is_run_and_holds_no_output():
    assert set(PACKAGES) == {path.stem for path in RECIPES.iterdir() if path.suffix == ".ipynb"}
    for path in RECIPES.glob("*.ipynb"):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells), path.name


@pytest.mark.parametrize("recipe", PACKAGES)
def test_recipe(recipe, monkeypatch):
    for package in PACKAGES[recipe]:
        pytest.importorskip(package)
    for name, value in SMALL.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    cell_after_cell(recipe)


def test_a_recipe_runs_as_a_notebook():
    pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    by_nbclient("gradients")


def test_a_failing_cell_fails(monkeypatch, tmp_path):
    """A failed assertion in a cell makes the test of its recipe fail."""
    cell = {"cell_type": "code", "source": ["assert False, 'planted'"]}
    (tmp_path / "planted.ipynb").write_text(json.dumps({"cells": [cell]}))
    monkeypatch.setattr(sys.modules[__name__], "RECIPES", tmp_path)
    with pytest.raises(AssertionError, match="planted"):
        cell_after_cell("planted")
