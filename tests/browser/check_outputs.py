#!/usr/bin/python3
"""Opens what `design --out OUT` wrote with the readers that users have: h5py, VTK's vtkHDFReader, headless Chromium.

    tests/browser/check_outputs.py OUT [--pictures FOLDER | --no-browser]

Exit code 0 when everything opens, every dataset carries its unit, and the report shows its figures without a console error;
`--pictures` keeps screenshots at desk and phone width. Needs python3-h5py, python3-vtk9 and chromium.
"""
import argparse
import glob
import os
import pathlib
import re
import subprocess
import sys
import tempfile


def check_hdf5(path):
    import h5py

    datasets = []
    with h5py.File(path) as file:
        file.visititems(lambda name, node: datasets.append(name) if isinstance(node, h5py.Dataset) else None)
        for name in datasets:
            for attribute in ("units", "long_name"):
                assert isinstance(file[name].attrs.get(attribute), str), f"{path}: {name} lacks {attribute}"
        assert "y" in file["evaluations/profile"].dims[1].keys(), "bins are no dimension scale"
        assert "variable" in file["evaluations/x"].dims[1].keys(), "variables are no dimension scale"
        assert file["config/verbatim"][()], "the study is not stored"
    return len(datasets)


def check_vtk(path):
    import vtk

    errors = []
    reader = vtk.vtkHDFReader()
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(path))
    assert reader.CanReadFile(path), f"{path}: not VTKHDF to VTK"
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutputDataObject(0)
    assert not errors, f"{path}: the reader complains"
    arrays = data.GetPointData()
    names = [arrays.GetArrayName(i) for i in range(arrays.GetNumberOfArrays())]
    wanted = {"gi", "mass"} if data.GetClassName() == "vtkImageData" else {"radius"}
    assert wanted <= set(names), f"{path}: arrays {names}"
    assert arrays.GetArray(names[0]).GetNumberOfTuples() == data.GetNumberOfPoints()
    return f"{data.GetClassName()} with {data.GetNumberOfPoints()} points"


def chromium(page, *options):
    with tempfile.TemporaryDirectory() as profile:
        return subprocess.run(
            ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--enable-logging=stderr", "--v=0",
             f"--user-data-dir={profile}", *options, pathlib.Path(page).absolute().as_uri()],
            capture_output=True, text=True, timeout=120)


def check_report(page, pictures):
    run = chromium(page, "--window-size=1280,2400", "--dump-dom")
    complaints = [line for line in run.stderr.splitlines() if "CONSOLE" in line]
    assert not complaints, "console: " + "; ".join(complaints)
    figures = re.findall(r"<figure[^>]*><h3>(.*?)</h3><div class=\"plot\">(.*?)</div><figcaption", run.stdout, re.S)
    titles = [title for title, drawing in figures if "<svg" in drawing or "<canvas" in drawing]
    # a machine extrapolated from strips has no grains of its own
    own = ("Order of the dispenser",) if (page.parent / "heap_order.svg").exists() else ("Before: the dispenser from above", "After: the layer from above")
    for wanted in ("From the partition to the layer", "Target, predicted and confirmed GI", "x drift of each bin", "GI over the platform",
                   "Where the powder comes from", "Convergence of the misfit", *own):
        assert any(title.startswith(wanted) for title in titles), f"the page lacks the figure '{wanted}'; it has {titles}"
    if pictures:
        os.makedirs(pictures, exist_ok=True)
        for name, size in (("desk", "1280,6200"), ("phone", "390,11000")):
            chromium(page, f"--window-size={size}", f"--screenshot={os.path.abspath(pictures)}/report_{name}.png")
    return len(titles)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("out")
    options.add_argument("--pictures")
    options.add_argument("--no-browser", action="store_true", help="files only, not the report")
    given = options.parse_args()
    print("results.h5:", check_hdf5(f"{given.out}/results.h5"), "datasets, all with units and long_name")
    for path in sorted(glob.glob(f"{given.out}/*.vtkhdf")):
        print(f"{os.path.basename(path)}:", check_vtk(path))
    if given.no_browser:
        return
    print("report.html:", check_report(pathlib.Path(given.out) / "report.html", given.pictures), "figures, no console error")


if __name__ == "__main__":
    try:
        main()
    except AssertionError as error:
        sys.exit(f"check_outputs: {error}")
