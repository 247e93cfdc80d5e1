#!/usr/bin/env python3
"""Follows the section "A characteristic" of CONTRIBUTING.md in a copy of the repository: adds a dummy quantity of an axle.

The quantity reads a slot that does not exist yet: the lower end of the spring. The script adds the slot to the three files
that the section names. It adds the quantity as a formula and a line of the catalogue. No other file changes. Then the
quantity must be available everywhere: in `solve`, in a sweep in SIMD lanes, and in a tuning with derivatives.
"""

import csv
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
COPY = ROOT / "target" / "walkthrough"
STUDY = "studies/double_wishbone_axle.toml"
# For each file, pairs of two texts: a text of the file, and the text that the script inserts after it.
SLOT = {
    "engine/src/characteristics/wheel.rs": [
        ("        strut_upper: StrutUpper [StrutUpper];\n",
         "        /// Lower end of the spring.\n        spring_lower: SpringLower [SpringLower];\n"),
        ("    StrutUpper: vector now.strut_upper;\n", "    SpringLower: vector now.spring_lower;\n"),
    ],
    "engine/src/characteristics/reading.rs": [
        ("            point.put(&mut now.strut_upper, &mut rate.strut_upper);\n        }\n",
         "        if slots.contains(Slot::SpringLower)\n            && let Some(spring) = mechanism.spring\n        {\n"
         "            let point = pose.point(spring.lower);\n"
         "            point.put(&mut now.spring_lower, &mut rate.spring_lower);\n        }\n"),
    ],
    "engine/src/characteristics/seeds.rs": [
        ("                if let Some(upper) = mechanism.strut_upper() {\n                    seeds.point(upper, seed);\n"
         "                }\n            }\n",
         "            Slot::SpringLower => {\n                if let Some(spring) = mechanism.spring {\n"
         "                    seeds.point(spring.lower, seed);\n                }\n            }\n"),
    ],
}
QUANTITY = {
    "engine/src/axle/formulas/roll.rs": [
        ("use crate::axle::state::{AxleState, Motion, WheelState};\n", "use crate::characteristics::VectorPart;\n"),
        ("    state.track()\n}\n",
         "\n/// Lateral distance between the lower ends of both springs.\n#[inline(always)]\n"
         "pub(crate) fn springs_apart<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {\n"
         "    let end = |side| state.wheel(side).reading.vector(VectorPart::SpringLower, [0, 0]).y;\n"
         "    end(Side::Left) + end(Side::Right)\n}\n"),
    ],
    "engine/src/axle/catalogue.rs": [
        ("roll::track, None;\n",
         '        SpringsApart, "springs_apart", LENGTH, "always", "y_l + y_r of the springs\' lower ends", ISO, '
         "[], [SpringLower], 0, false, lanes, roll::springs_apart, None;\n"),
    ],
}
# Half the lateral distance between the lower spring ends, in mm. The first value is for the design position of the study, the
# second for the tuned design.
DESIGN, WANTED = 210.0, 216.0


def insert(file: str, pieces: list[tuple[str, str]]) -> None:
    path = COPY / file
    text = path.read_text()
    for anchor, piece in pieces:
        if text.count(anchor) != 1:
            sys.exit(f"error: {file} contains this text {text.count(anchor)} times instead of once: {anchor.strip()}")
        text = text.replace(anchor, anchor + piece)
    path.write_text(text)


def run(*arguments: str) -> None:
    command = ["cargo", *arguments]
    environment = {**os.environ, "CARGO_TARGET_DIR": str(ROOT / "target" / "walkthrough-target")}
    if subprocess.run(command, cwd=COPY, env=environment, stdout=subprocess.DEVNULL).returncode:
        sys.exit(f"error: {' '.join(command)}")


def hardpoint(*arguments: str) -> None:
    run("run", "--release", "--locked", "--quiet", "--", *arguments, "--quiet")


def column(path: Path, name: str) -> list[float]:
    with path.open() as file:
        return [float(row[name]) for row in csv.DictReader(file)]


def close(found: float, wanted: float, of: str) -> None:
    print(f"1 {of}: {found!r}, wanted {wanted!r}", flush=True)
    if not abs(found - wanted) < 1e-9 * abs(wanted):
        sys.exit(f"error: {of}")


def study(name: str, extra: str) -> str:
    """Writes the sample study with the dummy quantity as its only output, one motion, and the tables `extra`."""
    text = (COPY / STUDY).read_text()
    text = text[: text.index("[motion]")]
    text += '[motion]\nheave = [-10.0, 0.0, 10.0]\n\n[outputs]\ncharacteristics = ["springs_apart"]\n' + extra
    (COPY / name).write_text(text)
    return name


def main() -> None:
    if COPY.exists():
        shutil.rmtree(COPY)
    files = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    for file in files:
        if (ROOT / file).is_file():
            (COPY / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / file, COPY / file)
    for file, pieces in {**SLOT, **QUANTITY}.items():
        insert(file, pieces)
    print(f"1 slot in {len(SLOT)} files, 1 quantity in {len(QUANTITY)} more", flush=True)

    hardpoint("solve", study("dummy.toml", ""), "--out", "out/solve")
    at = COPY / "out/solve/curves.csv"
    apart = column(at, "springs_apart_mm")
    close(apart[column(at, "heave_mm").index(0.0)], 2 * DESIGN, "value in the design position")

    variables = '{ hardpoint = "spring_lower", axis = "y", range = [-20.0, 20.0]'
    sweep = f'\n[sweep]\nmethod = "grid"\nvariables = [{variables}, steps = 17 }}]\n'
    hardpoint("sweep", study("dummy_sweep.toml", sweep), "--out", "out/sweep")
    table = COPY / "out/sweep/designs.csv"
    for moved, found in zip(column(table, "spring_lower_dy_mm"), column(table, "springs_apart_design_mm"), strict=True):
        close(found, 2 * (DESIGN + moved), "design of a sweep in lanes")

    target = f'{{ characteristic = "springs_apart", at = 0.0, value = {2 * WANTED}, tolerance = 0.01 }}'
    tuning = f"\n[optimise]\ngood_enough = 0.001\nvariables = [{variables} }}]\ntargets = [{target}]\n"
    hardpoint("optimise", study("dummy_tuning.toml", tuning), "--out", "out/tuning")
    at = COPY / "out/tuning/curves.csv"
    tuned = column(at, "springs_apart_mm")[column(at, "heave_mm").index(0.0)]
    print(f"1 tuning: {tuned!r}, wanted {2 * WANTED!r}", flush=True)
    if not abs(tuned - 2 * WANTED) < 1e-3:
        sys.exit("error: the tuning does not use the new slot")
    shutil.rmtree(COPY)


if __name__ == "__main__":
    main()
