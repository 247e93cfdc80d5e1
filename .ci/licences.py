"""Checks the dependencies of `cargo metadata`: their licences against a list, and the oldest version of Rust that each needs.

A licence expression passes if all licences of one alternative (separated by OR) are in the list. Development tools are
checked, too.
"""
import json
import re
import subprocess
import sys

ALLOWED = {
    "0BSD", "Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSD-2-Clause", "BSD-3-Clause", "BSL-1.0", "CC0-1.0", "ISC", "MIT",
    "MIT-0", "Unicode-3.0", "Unlicense", "Zlib", "zlib-acknowledgement",
}

# Packages that state a licence file instead of an expression. A person has read the file of this version.
READ = {"slsqp 1.0.2": "MIT"}


def passes(expression):
    """Returns true if an SPDX licence expression passes. AND has priority over OR."""
    tokens = re.findall(r"\(|\)|[^\s()/]+(?:\s+WITH\s+[^\s()/]+)?|/", expression)
    tokens = ["OR" if token == "/" else token for token in tokens]

    def alternatives():
        found = together()
        while tokens and tokens[0] == "OR":
            tokens.pop(0)
            found = together() or found
        return found

    def together():
        found = one()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            found = one() and found
        return found

    def one():
        token = tokens.pop(0)
        if token != "(":
            return " ".join(token.split()) in ALLOWED
        found = alternatives()
        assert tokens.pop(0) == ")", expression
        return found

    result = alternatives()
    assert not tokens, expression
    return result


def version(text):
    return tuple(int(part) for part in (text.split(".") + ["0", "0"])[:3])


for text, expected in [("MIT OR GPL-3.0", True), ("MIT AND GPL-3.0", False), ("(MIT OR GPL-3.0) AND Zlib", True), ("MIT/Apache-2.0", True),
                       ("GPL-3.0", False), ("Apache-2.0 WITH LLVM-exception", True), ("GPL-2.0 OR (MIT AND ISC)", True)]:
    assert passes(text) is expected, text

metadata = json.loads(subprocess.run(["cargo", "metadata", "--locked", "--format-version=1"], check=True, capture_output=True).stdout)
members = set(metadata["workspace_members"])
ours = [package for package in metadata["packages"] if package["id"] in members]
oldest = version(ours[0]["rust_version"])
faults = []
for package in metadata["packages"]:
    name = f"{package['name']} {package['version']}"
    licence = package["license"] or READ.get(name)
    if not licence:
        faults.append(f"{name}: no licence is stated")
    elif not passes(licence):
        faults.append(f"{name}: {licence} is not in the list of .ci/licences.py")
    if package["rust_version"] and version(package["rust_version"]) > oldest:
        faults.append(f"{name}: needs Rust {package['rust_version']}, the workspace states {ours[0]['rust_version']}")
if any(package["rust_version"] != ours[0]["rust_version"] for package in ours):
    faults.append("the crates of the workspace state different versions of Rust")
print("\n".join(faults) or f"{len(metadata['packages'])} packages: all licences are in the list, none needs a newer Rust")
sys.exit(bool(faults))
