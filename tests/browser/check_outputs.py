#!/usr/bin/python3
"""Opens what `design --out OUT` wrote with the readers that users have: h5py, VTK's vtkHDFReader, and by check_report.py Chromium.

    tests/browser/check_outputs.py OUT [--pictures FOLDER | --no-browser]

Exit code 0 when everything opens, every dataset carries its unit, and the report passes check_report.py; `--pictures` keeps
screenshots at desk and phone width and the paper version. Needs python3-h5py, python3-vtk9 and what check_report.py needs.
"""
import argparse
import glob
import os
import subprocess
import sys


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
    report = os.path.join(os.path.dirname(os.path.abspath(__file__)), "check_report.py")
    sys.exit(subprocess.run([sys.executable, report, given.out, *(["--pictures", given.pictures] if given.pictures else [])]).returncode)


if __name__ == "__main__":
    try:
        main()
    except AssertionError as error:
        sys.exit(f"check_outputs: {error}")
