from pathlib import Path

import pytest

import hardpoint as hp

ROOT = Path(__file__).parents[2]
STUDIES = ROOT / "studies"


@pytest.fixture
def front() -> hp.Study:
    return hp.load(STUDIES / "macpherson_front.toml")


@pytest.fixture
def sweep_study() -> hp.Study:
    return hp.load(STUDIES / "macpherson_sweep.toml", {"sweep.samples": 300})
