#!/usr/bin/python3
"""Opens what `design` left in OUT/spec with the programs that others use: admesh, ezdxf, poppler, sha256sum.

    tests/browser/check_spec.py OUT

Exit code 0 when spec.json follows its schema, the mesh is closed, the DXF passes its audit, each PDF renders with ink on every page, and the manifest holds.
Needs admesh, python3-ezdxf, python3-jsonschema and poppler-utils.
"""
import glob
import json
import os
import re
import subprocess
import sys
import tempfile


def run(*words, **more):
    return subprocess.run(words, check=True, capture_output=True, text=True, timeout=120, **more).stdout


def check_mesh(path):
    text = run("admesh", path)
    for name in ("Total disconnected facets", "Degenerate facets", "Edges fixed", "Facets removed", "Facets added",
                 "Facets reversed", "Backwards edges", "Normals fixed"):
        found = re.search(rf"{name}\s*:\s*(\d+)", text)
        assert found and found[1] == "0", f"{path}: {name}: {found and found[1]}"
    return float(re.search(r"Volume\s*:\s*([-\d.]+)", text)[1])


def check_dxf(path):
    import ezdxf

    document = ezdxf.readfile(path)
    audit = document.audit()
    assert document.dxfversion == "AC1009" and not audit.errors, f"{path}: {[e.message for e in audit.errors]}"
    layers = {entity.dxf.layer for entity in document.modelspace()}
    assert {"CUT", "ETCH", "DIM"} <= layers <= {"CUT", "BEND", "ETCH", "DIM"}, layers
    return len(document.modelspace())


def check_pdf(path):
    with tempfile.TemporaryDirectory() as folder:
        run("pdftoppm", "-r", "60", "-gray", path, os.path.join(folder, "page"))
        pages = glob.glob(os.path.join(folder, "page*.pgm"))
        assert pages, f"{path}: no page"
        for page in pages:
            with open(page, "rb") as file:
                pixels = file.read().split(b"\n", 3)[3]
            ink = sum(value < 128 for value in pixels)
            assert ink > 100, f"{path}: an empty page"
    return len(pages)


def check_schema(spec):
    import jsonschema

    path = os.path.join(os.path.dirname(__file__), "..", "..", "docs", "schema", "spec.schema.json")
    with open(path, encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    problems = [f"{list(e.path)}: {e.message}" for e in jsonschema.Draft202012Validator(schema).iter_errors(spec)]
    assert not problems, f"spec.json: {problems}"
    print("spec.json follows its schema")


def main(out):
    folder = os.path.join(out, "spec")
    with open(os.path.join(folder, "spec.json"), encoding="utf-8") as file:
        spec = json.load(file)
    check_schema(spec)
    run("sha256sum", "--check", "--strict", "manifest.sha256", cwd=folder)
    volume = check_mesh(os.path.join(folder, "partition.stl"))
    expected = sum(plate["volume_m3"] for plate in spec["plates"]) * 1e9
    assert abs(volume - expected) < 1e-3 * expected, f"mesh of {volume} mm3, plates of {expected} mm3"
    print("partition.stl closed,", volume, "mm3")
    print("flat_pattern.dxf clean,", check_dxf(os.path.join(folder, "flat_pattern.dxf")), "entities")
    for name in ("drawing.pdf", "fill_sheet.pdf"):
        text = run("pdftotext", os.path.join(folder, name), "-")
        assert spec["first_line"] in re.sub(r"\s+", " ", text), f"{name} does not open with '{spec['first_line']}'"
        print(name, "renders,", check_pdf(os.path.join(folder, name)), "pages")


if __name__ == "__main__":
    main(sys.argv[1])
