"""Recipes run as they stand, where what they are for is installed, each in a process of its own."""

import subprocess
import sys
from pathlib import Path

import pytest

RECIPES = Path(__file__).parents[1] / "recipes"
PACKAGES = {
    "scipy_least_squares": "scipy",
    "jax_gradient": "jax",
    "casadi_callback": "casadi",
    "optuna_sampler": "optuna",
    "tables": "pandas",
    "plot_curves": "matplotlib",
    "dask_sweep": "distributed",
}


def test_every_recipe_is_run():
    assert set(PACKAGES) == {path.stem for path in RECIPES.glob("*.py")}


@pytest.mark.parametrize("recipe, package", PACKAGES.items())
def test_recipe(recipe, package):
    pytest.importorskip(package)
    command = [sys.executable, "-P", str(RECIPES / f"{recipe}.py")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert "misfit" in done.stdout
