"""Names in the manual exist, the Python code in it runs, and help() is complete."""

import builtins
import importlib.util
import inspect
import os
import re
import subprocess
import sys

import pytest

import hardpoint as hp
from conftest import ROOT
from hardpoint import distributed

PAGES = [ROOT / "docs" / "python.md", ROOT / "python" / "README.md"]
BLOCKS = [
    (path.name, number, block)
    for path in PAGES
    for number, block in enumerate(re.findall(r"```python\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL))
]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_names_of_the_manual_exist(path):
    text = path.read_text(encoding="utf-8")
    names = set(re.findall(r"\bhp\.([A-Za-z_]+)", text))
    assert names and names <= {*hp.__all__, "distributed"}, names - set(hp.__all__)
    assert set(re.findall(r"\bdistributed\.([a-z_]+)\(", text)) <= set(distributed.__all__)


def test_every_name_of_the_module_is_in_the_manual():
    text = PAGES[0].read_text(encoding="utf-8")
    hidden = {"Column", "Function", "HardpointError", "Residuals", "Run", "__version__"}
    missing = [name for name in hp.__all__ if f"hp.{name}" not in text and f"`{name}`" not in text and name not in hidden]
    assert not missing


@pytest.mark.parametrize("name, number, block", BLOCKS, ids=[f"{name}-{number}" for name, number, _ in BLOCKS])
def test_python_of_the_manual_runs(name, number, block, tmp_path):
    compile(block, f"{name} {number}", "exec")
    for package in re.findall(r"^(?:import|from) ([a-z_]+)", block, re.MULTILINE):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{package} is not installed")
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    # A process pool imports its main module again, so the code block must be in a file.
    (tmp_path / "block.py").write_text(block, encoding="utf-8")
    command = [sys.executable, "-P", "block.py"]
    done = subprocess.run(command, cwd=tmp_path, env={**os.environ}, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr


def public(owner):
    return [(name, value) for name, value in vars(owner).items() if not name.startswith("_")]


def test_help_is_complete():
    missing = []
    for name in hp.__all__:
        value = getattr(hp, name)
        if not callable(value):
            continue
        if not (inspect.getdoc(value) or "").strip():
            missing.append(name)
        if inspect.isclass(value) and value.__module__.startswith("hardpoint"):
            for member, inner in public(value):
                is_code = callable(inner) or isinstance(inner, (property, classmethod, staticmethod))
                if is_code and not (inspect.getdoc(getattr(value, member)) or "").strip():
                    missing.append(f"{name}.{member}")
    assert not missing


def test_no_name_shadows_a_builtin():
    assert not set(hp.__all__) & (set(dir(builtins)) - set(dir(object)))
    assert not set(distributed.__all__) & set(dir(builtins))
