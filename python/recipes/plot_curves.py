"""Curves before and after a tuning with matplotlib, targets and their tolerance bands beside them."""

import sys
import tempfile
import tomllib
from pathlib import Path

import matplotlib

import hardpoint as hp

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

STUDY = Path(__file__).resolve().parents[2] / "studies" / "macpherson_front.toml"


def plot(study: hp.Study, path: Path) -> None:
    """Draws every curve that has a target."""
    before, after = hp.solve(study), hp.solve(hp.optimise(study).study)
    targets = [t for t in tomllib.loads(study.text)["optimise"]["targets"] if "points" in t]
    figure, axes = plt.subplots(1, len(targets), figsize=(5 * len(targets), 4), squeeze=False, layout="constrained")
    for axis, target in zip(axes[0], targets):
        column = next(c for c in after.info.values() if c.output == target["characteristic"])
        travel, wanted = zip(*target["points"])
        band = [[w + sign * target["tolerance"] for w in wanted] for sign in (-1, 1)]
        axis.fill_between(travel, *band, alpha=0.3, label="target and tolerance")
        axis.plot(before.drive, before[column.name], "--", label="before")
        axis.plot(after.drive, after[column.name], label="tuned")
        axis.set(xlabel=f"travel, {study.length_unit}", ylabel=f"{column.output}, {column.unit}")
        axis.legend()
    figure.savefig(path)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        to = Path(sys.argv[1] if len(sys.argv) > 1 else f"{folder}/curves.png")
        plot(hp.load(STUDY), to)
        print(f"misfit drawn: {to.name}, {to.stat().st_size} bytes")
