#!/usr/bin/env python3
"""Plants single faults in a copy of the tree and says which of them no test sees.

`MUTANTS_COUNT` (20) faults are drawn with the seed `MUTANTS_SEED` (1), equally many from each folder of FOLDERS. Each is
built in a copy of the tree with a target directory of its own (`target/mutants`). The integration tests of its folder
run first. If they pass, the folder's unit tests run. Both together get LIMIT seconds. A fault that does not compile is
replaced by another one.

cargo-mutants (27.0) was considered: it takes no seed, leaves constants as they are, which here are the thresholds of
guards, and runs the same tests for every file.
"""

import json
import os
import random
import re
import subprocess
import sys
import time
from pathlib import Path

# Time for the tests of one fault, in seconds. Compilation does not count.
LIMIT = 120
# Folder: its files, the integration tests that see it, its crate, and the unit tests of that crate.
FOLDERS = {
    "tracker": (
        ["engine/src/solve/tracker/*.rs", "engine/src/solve/closed_form/mod.rs"],
        ["lanes::"], "hardpoint-engine", ["solve::"],
    ),
    "certificates": (
        ["engine/src/analyse/certificate/*.rs", "engine/src/axle/certificate.rs"],
        ["certificate::"], "hardpoint-engine", ["analyse::"],
    ),
    "tuning": (
        ["engine/src/optimise/*.rs", "engine/src/optimise/constrained/*.rs"],
        ["tuning::"], "hardpoint-engine", ["optimise::"],
    ),
    "standard errors": (
        [f"engine/src/optimise/{name}.rs" for name in
         ["standard_errors", "covariance", "student", "profile_interval", "simulated_fits", "profile"]],
        ["tuning::intervals"], "hardpoint-engine", ["optimise::"],
    ),
    "exchange": (["src/exchange/**/*.rs"], ["exchange::"], "hardpoint", ["exchange::"]),
    "set-up": (["engine/src/assembly/set_up/*.rs"], ["builds::set_up"], "hardpoint-engine", ["assembly::"]),
    "axle": (
        [f"engine/src/axle/{name}" for name in ["formulas/*.rs", "state.rs", "spring.rs", "frames.rs", "axle_motion.rs"]],
        ["axle::"], "hardpoint-engine", ["axle::"],
    ),
}
# Operators with what takes their place. Spaces on both sides keep generics and references out.
OPERATORS = {
    " + ": " - ", " - ": " + ", " * ": " + ", " / ": " * ", " < ": " > ", " > ": " < ", " <= ": " > ", " >= ": " < ",
    " == ": " != ", " != ": " == ", " && ": " || ", " || ": " && ", " & ": " | ", ".max(": ".min(", ".min(": ".max(",
    "Side::Left": "Side::Right", "Side::Right": "Side::Left", ".sin()": ".cos()", ".cos()": ".sin()",
    "is_some()": "is_none()", "is_none()": "is_some()",
}
NUMBER = re.compile(r"(?<![\w.\"])(\d[\d_]*\.\d[\d_]*(?:e-?\d+)?|\d+e-?\d+)(?![\w.])")
THRESHOLD = re.compile(r"^\s*(?:pub(?:\([^)]*\))? )?const \w+: (f64|usize) = ([^;]+);")
GUARD = re.compile(r"^\s*accepted\.require\(.*\);$")
CONDITION = re.compile(r"^(\s*)if ((?!let\b)[^{]+) \{$")
# Lines without a computation: comments, attributes, imports, signatures, bounds, messages.
SKIPPED = re.compile(r"^\s*(//|#|use |pub use |mod |pub mod |impl|where|type |assert|debug_assert|pub fn|fn |pub\(\w+\) fn)|format!|panic!|const \{|'[a-z]+")


def code_lines(text):
    """Numbers and contents of the lines of code before the unit tests."""
    for number, line in enumerate(text.split("\n")):
        if line.strip() == "#[cfg(test)]":
            return
        if not SKIPPED.search(line):
            yield number, line


def faults_of(line):
    """The lines that may stand in place of a line."""
    if match := THRESHOLD.match(line):
        kind, value = match.groups()
        for factor in ["100.0", "0.01"] if kind == "f64" else ["2", "0"]:
            yield line.replace(f"= {value};", f"= ({value}) * {factor};")
        return
    if GUARD.match(line):
        yield ""
        return
    if match := CONDITION.match(line):
        indent, condition = match.groups()
        yield f"{indent}if !({condition}) {{"
    code = line.split(" // ")[0]
    for operator, other in OPERATORS.items():
        start = code.find(operator)
        while start >= 0:
            yield line[:start] + other + line[start + len(operator):]
            start = code.find(operator, start + 1)
    for match in NUMBER.finditer(code):
        for factor in ["1.001", "2.0"]:
            if float(match[1].replace("_", "")) != 0.0:
                yield f"{line[:match.start()]}({match[1]} * {factor}){line[match.end():]}"


def candidates(root, patterns):
    """Every fault in the files of some patterns: file, line number, the line, and the line in its place."""
    found = []
    paths = sorted({path for pattern in patterns for path in root.glob(pattern)})
    # Files that only tests compile.
    tests = {name for path in paths for name in re.findall(r"#\[cfg\(test\)\]\n(?:pub(?:\([^)]*\))? )?mod (\w+);", path.read_text())}
    for path in [path for path in paths if path.stem not in tests]:
        for number, line in code_lines(path.read_text()):
            found += [(path.relative_to(root), number, line, fault) for fault in faults_of(line)]
    return found


def copy_tree(root, tree):
    """Copies the files that git knows. A file that did not change keeps its time, so that cargo leaves it."""
    listed = subprocess.run(["git", "ls-files", "-z", "-co", "--exclude-standard"], cwd=root, capture_output=True, check=True)
    names = {name for name in listed.stdout.decode().split("\0") if name and (root / name).is_file()}
    for name in names:
        source, target = root / name, tree / name
        content = source.read_bytes()
        if not target.exists() or target.read_bytes() != content:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
            target.chmod(source.stat().st_mode)
    for path in tree.rglob("*"):
        if path.is_file() and str(path.relative_to(tree)) not in names:
            path.unlink()


def build(tree, arguments):
    """The test binary that cargo builds, or None if the tree does not compile."""
    environment = dict(os.environ, CARGO_TARGET_DIR=str(tree.parent / "target"))
    command = ["cargo", "test", "--locked", "--no-run", "--message-format=json", *arguments]
    ran = subprocess.run(command, cwd=tree, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    if ran.returncode:
        return None
    binaries = [json.loads(line).get("executable") for line in ran.stdout.decode().splitlines() if line.startswith("{")]
    return [binary for binary in binaries if binary][-1]


def first_failure(binary, directory, filters, seconds):
    """Runs tests until one fails. Returns its name, None if all pass, or `out of time`; and the time left."""
    end = time.monotonic() + seconds
    process = subprocess.Popen(
        ["timeout", "--signal=KILL", f"{max(seconds, 1):.0f}", binary, *filters],
        cwd=directory, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
    )
    failed = None
    for line in process.stdout:
        if match := re.match(r"test (.*) \.\.\. FAILED", line):
            failed = match[1]
            process.terminate()
            break
    code = process.wait()
    if failed is None and code:
        failed = "out of time" if time.monotonic() >= end - 1 else f"a crash, status {code}"
    return failed, end - time.monotonic()


def verdict(tree, folder):
    """The test that a fault fails, None if it fails none, or `does not compile`."""
    _, modules, crate, units = FOLDERS[folder]
    directory = tree / "engine" if crate == "hardpoint-engine" else tree
    left = LIMIT
    for arguments, filters, place in [(["--test", "it"], modules, tree), (["-p", crate, "--lib"], units, directory)]:
        binary = build(tree, arguments)
        if binary is None:
            return "does not compile"
        failed, left = first_failure(binary, place, filters, left)
        if failed:
            return failed
    return None


def main():
    root = Path(__file__).resolve().parent.parent
    count, seed = int(os.environ.get("MUTANTS_COUNT", 20)), int(os.environ.get("MUTANTS_SEED", 1))
    tree = root / "target" / "mutants" / "tree"
    tree.mkdir(parents=True, exist_ok=True)
    copy_tree(root, tree)
    draw = random.Random(seed)
    pools = {folder: candidates(tree, patterns) for folder, (patterns, *_) in FOLDERS.items()}
    for pool in pools.values():
        draw.shuffle(pool)
    order = list(FOLDERS)
    draw.shuffle(order)
    if os.environ.get("MUTANTS_LIST"):
        for folder in order:
            print(folder, len(pools[folder]))
        return 0
    killed = survived = late = number = 0
    while number < count:
        folder = order[number % len(order)]
        path, line_number, line, fault = pools[folder].pop()
        original = (tree / path).read_text()
        lines = original.split("\n")
        lines[line_number] = fault
        (tree / path).write_text("\n".join(lines))
        try:
            found = verdict(tree, folder)
        finally:
            (tree / path).write_text(original)
        if found == "does not compile":
            continue
        number += 1
        if found is None:
            survived += 1
            word = "SURVIVED"
        elif found == "out of time":
            late += 1
            word = "ran out of time"
        else:
            killed += 1
            word = f"killed by {found}"
        print(f"mutant {number} {word}: {path}:{line_number + 1}: `{line.strip()}` -> `{fault.strip()}`", flush=True)
    print(f"{count} mutants of seed {seed}: {killed} killed, {survived} survived, {late} out of time")
    return 0


if __name__ == "__main__":
    sys.exit(main())
