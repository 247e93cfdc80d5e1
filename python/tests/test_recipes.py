"""Recipes run as they stand, where what they are for is installed."""

import runpy
from pathlib import Path

import pytest

RECIPES = Path(__file__).parents[1] / "recipes"


@pytest.mark.parametrize("recipe, package", [("jax_gradient", "jax"), ("casadi_callback", "casadi")])
def test_recipe(recipe, package, capsys):
    pytest.importorskip(package)
    runpy.run_path(str(RECIPES / f"{recipe}.py"), run_name="__main__")
    assert "misfit" in capsys.readouterr().out
