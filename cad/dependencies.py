#!/usr/bin/env python3
"""Describe the crates in what is released: cad/dependencies.py TARGET sbom|licences|wheel-licences > FILE

`sbom` prints a software bill of materials, CycloneDX 1.5 in JSON; `licences` prints the licence texts of all linked
crates, which their licences require with every copy, and `wheel-licences` those of the Python package. The crates are those that `cargo tree` lists for the command line
with the feature `cloud` and the compilation target TARGET. A crate that runs only during compilation (build script or
procedural macro) has the scope `excluded`. The same commit gives the same bytes, with SOURCE_DATE_EPOCH as the time.
"""
import json
import os
import pathlib
import subprocess
import sys
import time
import tomllib
import uuid

ROOT = pathlib.Path(__file__).resolve().parent.parent
PACKAGE = "pinswitch-cli"
# Folder of a Cargo.lock, package and features, by output.
BINARY = (ROOT, PACKAGE, ["--features", "cloud"])
WHEEL = (ROOT / "cad" / "python", "pinswitch-python", [])
# File names of licence texts in the crates, without case.
LICENCE_FILES = ("licen", "copying", "copyright", "notice", "unlicense")


def cargo(folder: pathlib.Path, *arguments: str) -> str:
    return subprocess.run(
        ["cargo", *arguments], cwd=folder, check=True, stdout=subprocess.PIPE, text=True
    ).stdout


def crates(released: tuple, target: str, edges: str) -> set[tuple[str, str]]:
    """Return name and version of every crate on these edges of the dependency graph."""
    folder, package, features = released
    lines = cargo(
        folder, "tree", "--locked", "-p", package, *features, "--target", target, "-e", edges,
        "--prefix", "none", "-f", "{p}",
    ).splitlines()  # fmt: skip
    return {(name, version[1:]) for name, version, *_ in (line.split() for line in lines if line)}


def reference(package: dict) -> str:
    return f"pkg:cargo/{package['name']}@{package['version']}"


def component(package: dict, checksums: dict, linked: set) -> dict:
    name, version = package["name"], package["version"]
    if not package["license"]:
        sys.exit(f"{name} {version} declares no licence")
    entry = {
        "type": "library",
        "bom-ref": reference(package),
        "name": name,
        "version": version,
        "description": " ".join((package["description"] or "").split()),
        "scope": "required" if (name, version) in linked else "excluded",
        "licenses": [{"expression": " ".join(package["license"].replace("/", " OR ").split())}],
        "purl": reference(package),
    }
    if checksum := checksums.get((name, version)):
        entry["hashes"] = [{"alg": "SHA-256", "content": checksum}]
    if package["repository"]:
        entry["externalReferences"] = [{"type": "vcs", "url": package["repository"]}]
    return entry


def sbom(packages: list[dict], nodes: dict, linked: set) -> str:
    lock = tomllib.loads((ROOT / "Cargo.lock").read_text())
    checksums = {(p["name"], p["version"]): p["checksum"] for p in lock["package"] if "checksum" in p}
    components = [component(package, checksums, linked) for package in packages]
    program = next(c for c in components if c["name"] == PACKAGE)
    components.remove(program)
    program |= {"type": "application", "name": "pinswitch"}
    references = {package["id"]: reference(package) for package in packages}
    used = {
        references[i]: sorted({references[d["pkg"]] for d in nodes[i] if d["pkg"] in references}) for i in references
    }
    document = {
        "$schema": "http://cyclonedx.org/schema/bom-1.5.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "timestamp": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", 0)))),
            "component": program,
        },
        "components": components,
        "dependencies": [{"ref": ref, "dependsOn": uses} for ref, uses in sorted(used.items())],
    }
    # A name that depends on the content only.
    serial = uuid.uuid5(uuid.NAMESPACE_URL, json.dumps(document, sort_keys=True))
    return json.dumps(document | {"serialNumber": f"urn:uuid:{serial}"}, indent=2, ensure_ascii=False)


def licences(packages: list[dict], linked: set) -> str:
    """Return each distinct text once, after the crates that it applies to."""
    texts: dict[str, list[str]] = {}
    for package in packages:
        if (package["name"], package["version"]) not in linked:
            continue
        folder = pathlib.Path(package["manifest_path"]).parent
        files = sorted(f for f in folder.iterdir() if f.name.lower().startswith(LICENCE_FILES) and f.is_file())
        title = f"{package['name']} {package['version']} ({package['license']})"
        for file in files:
            text = "\n".join(line.rstrip() for line in file.read_text(errors="replace").splitlines()).strip()
            texts.setdefault(text, []).append(f"{title}: {file.name}")
        if not files:
            texts.setdefault("The crate contains no licence text; its licence is that in parentheses.", []).append(title)
    rule = "=" * 80
    return "\n".join(
        f"{rule}\n" + "\n".join(titles) + f"\n{rule}\n\n{text}\n" for text, titles in sorted(texts.items())
    )


def main() -> None:
    if len(sys.argv) != 3 or sys.argv[2] not in ("sbom", "licences", "wheel-licences"):
        sys.exit(__doc__)
    target, output = sys.argv[1:]
    released = WHEEL if output == "wheel-licences" else BINARY
    folder, _, features = released
    linked = crates(released, target, "normal,no-proc-macro")
    compiled = crates(released, target, "normal,build")
    options = ["--features", f"{PACKAGE}/cloud"] if features else []
    metadata = json.loads(
        cargo(folder, "metadata", "--locked", "--format-version", "1", "--filter-platform", target, *options)
    )
    packages = [p for p in metadata["packages"] if (p["name"], p["version"]) in compiled]
    packages.sort(key=lambda p: (p["name"], p["version"]))
    if output != "sbom":
        print(licences(packages, linked), end="")
    else:
        nodes = {node["id"]: node["deps"] for node in metadata["resolve"]["nodes"]}
        print(sbom(packages, nodes, linked))


main()
