#!/usr/bin/env python3
"""Inserts single faults into a copy of the source, and lists the faults that no test finds.

The script chooses `MUTANTS_COUNT` (default 20) random faults with the seed `MUTANTS_SEED` (default 1), equally many from
each folder of FOLDERS. It compiles all faults at once, each behind a switch, so twenty faults need one build. The
environment variable HARDPOINT_FAULT activates one of the faults. For each fault, the tests of its folder run until the
first failure, but at most LIMIT seconds of processor time (so the load of the machine does not matter). Faults that do
not compile are omitted and counted.

If a constant only controls an iteration, its doc comment says "It changes the path, not the result." Examples are a damping,
a fraction of a step, and a bracket of a search. Small and moderate factors on such a constant change no result, because
equations and thresholds determine the end of the iteration. So the script uses FACTORS_OF_STRATEGY, which break the
convergence.

We considered cargo-mutants (27.0). It accepts no seed, does not change constants (here the thresholds of checks), runs the
same tests for every file, and compiles once for each fault.
"""

import json
import os
import random
import re
import resource
import subprocess
import sys
import time
from pathlib import Path

# Limit of processor time for the tests of one fault, in seconds: two minutes on two cores. A fault can make a test wait
# without end and without processor time. So a run also ends after ten minutes of elapsed time.
LIMIT = 240
LONGEST_WAIT = 600
ENGINE = "hardpoint-engine"
# For each folder: its files, the integration tests that cover it, its crate, and the unit tests of this crate.
FOLDERS = {
    "tracker": (["engine/src/solve/tracker/**/*.rs", "engine/src/solve/closed_form/mod.rs", "engine/src/solve/closed_form/carried.rs"], ["lanes::"], ENGINE, ["solve::"]),
    "certificates": (["engine/src/analyse/certificate/*.rs"], ["certificate::"], ENGINE, ["analyse::"]),
    "tuning": (["engine/src/optimise/*.rs", "engine/src/optimise/constrained/**/*.rs"], ["tuning::"], ENGINE, ["optimise::"]),
    "standard errors": (
        [f"engine/src/optimise/{name}.rs" for name in
         ["standard_errors", "covariance", "student", "profile_interval", "simulated_fits", "profile"]],
        ["tuning::intervals"], ENGINE, ["optimise::"],
    ),
    "exchange": (["src/exchange/**/*.rs"], ["exchange::"], "hardpoint", ["exchange::"]),
    "set-up": (["engine/src/assembly/set_up/*.rs"], ["builds::set_up"], ENGINE, ["assembly::"]),
    "axle": (
        [f"engine/src/axle/{name}.rs" for name in ["formulas/*", "state", "spring", "frames", "axle_motion", "certificate"]],
        ["axle::", "solid::"], ENGINE, ["axle::"],
    ),
}
# Operators and their replacements. The spaces on both sides exclude generics and references.
OPERATORS = {
    " + ": " - ", " - ": " + ", " < ": " > ", " > ": " < ", " <= ": " > ", " >= ": " < ", " && ": " || ", " || ": " && ",
    " & ": " | ", ".max(": ".min(", ".min(": ".max(", "Side::Left": "Side::Right", "Side::Right": "Side::Left",
    ".sin()": ".cos()", ".cos()": ".sin()",
}
NUMBER = re.compile(r"(?<![\w.\"])(\d[\d_]*\.\d[\d_]*(?:e-?\d+)?|\d+e-?\d+)(?![\w.])")
THRESHOLD = re.compile(r"^(?:pub(?:\([^)]*\))? )?const (\w+): f64 = [^;]+;")
GUARD = re.compile(r"^(\s*)(accepted\.require\(.*\);)$")
CONDITION = re.compile(r"^(\s*)(\} else )?if ((?!let\b)[^{]+) \{$")
VALUE = re.compile(r"^(\s*let (?:mut )?\w+ = )([^&|\"?][^|\"?]*);$")
# Lines that contain no computation: comments, attributes, imports, signatures, constants, messages.
SKIPPED = re.compile(r"^\s*(//|#|use |pub use |mod |pub mod |impl|where|type |assert|debug_assert|fn |pub fn|pub\(\w+\) fn)"
                     r"|format!|panic!|const |static |&mut |'[a-z]+")
FACTORS = ["100.0", "0.01"]
STRATEGY = "It changes the path, not the result."
FACTORS_OF_STRATEGY = ["1e9", "-1e9"]
SWITCH = '''//! Chooses the planted fault.

/// Whether this fault is planted.
#[inline]
pub fn is(number: u32) -> bool {
    static CHOSEN: std::sync::LazyLock<u32> = std::sync::LazyLock::new(|| {
        let chosen = std::env::var("HARDPOINT_FAULT").ok();
        chosen.and_then(|text| text.parse().ok()).unwrap_or(0)
    });
    *CHOSEN == number
}

/// The number, or the wrong one where this fault is planted.
#[inline]
pub fn number(fault: u32, right: f64, wrong: f64) -> f64 {
    if is(fault) { wrong } else { right }
}
'''


def code_lines(text):
    """Yields number and content of each line of code before the unit tests. Omits constants that have several lines."""
    in_constant = False
    lines = text.split("\n")
    for number, line in enumerate(lines):
        # The script skips the rest of a file only after a block of unit tests. After `mod tests;`, code may follow.
        if line.strip() == "#[cfg(test)]" and lines[number + 1].rstrip().endswith("{"):
            return
        if re.match(r"^\s*(pub(\([^)]*\))? )?(const|static) ", line) and not line.rstrip().endswith(("{", ";")):
            in_constant = True
        if not in_constant:
            yield number, line
        in_constant = in_constant and not line.rstrip().endswith(";")


def faults_of(line):
    """Yields each fault of a line: a description, and the changed line, in which `{n}` is the number of the fault's switch."""
    if SKIPPED.search(line):
        return
    escaped = line.replace("{", "{{").replace("}", "}}")
    if match := GUARD.match(line):
        yield "left out", f"{match[1]}if !crate::planted::is({{n}}) {{{{ {match[2]} }}}}"
        return
    if match := CONDITION.match(line):
        indent, otherwise, condition = match.groups()
        condition = condition.replace("{", "{{").replace("}", "}}")
        yield f"!({condition})", f"{indent}{otherwise or ''}if crate::planted::is({{n}}) != ({condition}) {{{{".replace("} else", "}} else")
    if match := VALUE.match(line):
        head, value = match.groups()
        for operator, other in OPERATORS.items():
            for found in re.finditer(re.escape(operator), value):
                wrong = value[:found.start()] + other + value[found.end():]
                choice = f"{head}if crate::planted::is(@) {{ {wrong} }} else {{ {value} }};"
                yield wrong, choice.replace("{", "{{").replace("}", "}}").replace("@", "{n}")
    if "=>" in line:
        return
    for match in NUMBER.finditer(escaped):
        for factor in ["1.001", "2.0"]:
            if float(match[1].replace("_", "")) != 0.0:
                planted = f"crate::planted::number({{n}}, {match[1]}, {match[1]} * {factor})"
                yield f"{match[1]} * {factor}", escaped[:match.start()] + planted + escaped[match.end():]


def candidates(root, patterns):
    """Lists every fault in files that match the patterns: file, changed lines by number, first line number, description."""
    found = []
    paths = sorted({path for pattern in patterns for path in root.glob(pattern)})
    # Files that are compiled only for tests.
    tests = {name for path in paths for name in re.findall(r"#\[cfg\(test\)\]\nmod (\w+);", path.read_text())}
    for path in [path for path in paths if path.stem not in tests]:
        lines = path.read_text().split("\n")
        code = list(code_lines(path.read_text()))
        for number, line in code:
            for said, fault in faults_of(line):
                found.append((path.relative_to(root), {number: fault}, number, f"`{line.strip()}` -> `{said}`"))
            if match := THRESHOLD.match(line):
                # Changes a constant where the code uses it, not at its definition.
                name = match[1]
                uses = [(n, l) for n, l in code if re.search(rf"\b{name}\b", l) and not SKIPPED.search(l)]
                comment = []
                while lines[number - len(comment) - 1].startswith("///"):
                    comment.insert(0, lines[number - len(comment) - 1][3:].strip())
                factors = FACTORS_OF_STRATEGY if STRATEGY in " ".join(comment) else FACTORS
                for factor in factors if uses else []:
                    planted = f"crate::planted::number({{n}}, {name}, {name} * {factor})"
                    changed = {n: re.sub(rf"\b{name}\b", lambda _: planted, l.replace("{", "{{").replace("}", "}}"))
                               for n, l in uses}
                    found.append((path.relative_to(root), changed, number, f"`{line.strip()}` -> `* {factor}`"))
    return found


def copy_tree(root, tree):
    """Copies the files that git lists. An unchanged file keeps its time, so cargo does not compile it again."""
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


def plant(root, tree, faults):
    """Writes the faults into the copy, each behind a switch. Returns the changed lines by file."""
    copy_tree(root, tree)
    for crate in ["engine/src", "src"]:
        (tree / crate / "planted.rs").write_text(SWITCH)
        library = tree / crate / "lib.rs"
        text = library.read_text()
        at = re.search(r"^(pub )?mod ", text, re.MULTILINE).start()
        library.write_text(text[:at] + "#[doc(hidden)]\npub mod planted;\n" + text[at:])
    changed = {}
    for number, (_, path, lines, *_) in faults.items():
        for line, text in lines.items():
            changed.setdefault(str(path), {})[line] = (number, text.format(n=number))
    for path, lines in changed.items():
        old = (tree / path).read_text().split("\n")
        for line, (_, text) in lines.items():
            old[line] = text
        (tree / path).write_text("\n".join(old))
    return changed


def cargo(tree, arguments):
    """Runs cargo. Returns true if it succeeds, and the messages of the compiler."""
    environment = dict(os.environ, CARGO_TARGET_DIR=str(tree.parent / "target"))
    command = ["cargo", *arguments, "--message-format=json"]
    ran = subprocess.run(command, cwd=tree, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    return ran.returncode == 0, [json.loads(line) for line in ran.stdout.decode().splitlines() if line.startswith("{")]


def broken(messages, changed):
    """Returns the numbers of the faults in whose lines the compiler reports errors."""
    found = set()
    for message in messages:
        if message.get("reason") == "compiler-message" and message["message"]["level"] == "error":
            for span in message["message"]["spans"]:
                lines = changed.get(span["file_name"], {})
                found |= {lines[n - 1][0] for n in range(span["line_start"], span["line_end"] + 1) if n - 1 in lines}
    return found


def processor_time():
    """Returns the processor time in seconds of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def first_failure(binary, directory, filters, seconds, fault):
    """Runs tests until one fails. Returns the name of this test (or None, or `out of time`), and the time that is left."""
    before = processor_time()
    limit = max(round(seconds), 1)
    process = subprocess.Popen(
        ["timeout", "--signal=KILL", str(LONGEST_WAIT), binary, *filters], cwd=directory,
        env=dict(os.environ, HARDPOINT_FAULT=str(fault)), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)),
    )
    failed = None
    start = time.monotonic()
    for line in process.stdout:
        if match := re.match(r"test (.*) \.\.\. FAILED", line):
            failed = match[1]
            process.terminate()
            break
    code = process.wait()
    used = processor_time() - before
    if failed is None and code:
        is_late = used >= limit - 1 or time.monotonic() - start >= LONGEST_WAIT - 1
        failed = "out of time" if is_late else f"a crash, status {code}"
    return failed, seconds - used


def draw(root, count, seed):
    """Chooses random faults, at most one in each line. Returns them by number, starting from 1."""
    chance = random.Random(seed)
    pools = {folder: candidates(root, patterns) for folder, (patterns, *_) in FOLDERS.items()}
    order = list(FOLDERS)
    chance.shuffle(order)
    for pool in pools.values():
        chance.shuffle(pool)
    faults, taken = {}, set()
    while len(faults) < count:
        folder = order[len(faults) % len(order)]
        if not pools[folder]:
            sys.exit(f"error: MUTANTS_COUNT={count} is too large: after {len(faults)} faults, the sources of "
                     f"\"{folder}\" have no further fault")
        path, lines, *said = pools[folder].pop()
        if taken.isdisjoint((path, line) for line in lines):
            taken.update((path, line) for line in lines)
            faults[len(faults) + 1] = (folder, path, lines, *said)
    return faults


def compiled(root, tree, faults):
    """Builds the tests with all faults that compile. Returns the test binaries and these faults."""
    unit = {ENGINE: ["test", "--locked", "--no-run", "-p", ENGINE, "--lib"],
            "hardpoint": ["test", "--locked", "--no-run", "--lib", "--test", "it"]}
    while True:
        changed = plant(root, tree, faults)
        binaries, out = {}, set()
        for crate, arguments in unit.items():
            works, messages = cargo(tree, arguments)
            if not works:
                out |= broken(messages, changed)
                if not out:
                    sys.exit(f"error: the tree does not compile: cargo {' '.join(arguments)}")
                break
            for message in messages:
                if message.get("executable") and message["profile"]["test"]:
                    is_it = message["target"]["name"] == "it"
                    binaries["it" if is_it else crate] = message["executable"]
        if not out:
            return binaries, faults
        faults = {number: fault for number, fault in faults.items() if number not in out}


def run(root, tree, faults):
    """Activates one fault after another, and prints the result of the tests."""
    binaries, left = compiled(root, tree, faults)
    counts = {"killed": 0, "survived": 0, "out of time": 0}
    for number, (folder, path, _, line, said) in left.items():
        _, modules, crate, units = FOLDERS[folder]
        directory = tree / "engine" if crate == ENGINE else tree
        found, seconds = first_failure(binaries[crate], directory, units, LIMIT, number)
        if found is None:
            found, _ = first_failure(binaries["it"], tree, modules, seconds, number)
        kind = "survived" if found is None else found if found == "out of time" else "killed"
        counts[kind] += 1
        word = "SURVIVED" if found is None else f"ran {found}" if kind == "out of time" else f"killed by {found}"
        print(f"mutant {number} {word}: {path}:{line + 1}: {said}", flush=True)
    said = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    print(f"{len(faults)} mutants: {said}, {len(faults) - len(left)} do not compile", flush=True)


def main():
    root = Path(__file__).resolve().parent.parent
    tree = root / "target" / "mutants" / "tree"
    tree.mkdir(parents=True, exist_ok=True)
    count, seed = (int(os.environ.get(f"MUTANTS_{name}", default)) for name, default in [("COUNT", 20), ("SEED", 1)])
    run(root, tree, draw(root, count, seed))


if __name__ == "__main__":
    main()
