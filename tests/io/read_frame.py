# SPDX-License-Identifier: MIT
"""Reads a frame with VTK's own reader or with meshio and prints its contents, for tests.

    read_frame.py vtk|meshio FILE

One line per array: name, number of components, and the sums over the particles; for a frame in
pieces (.pvtu), only the number of particles and that of different ids. Exits with 77 if the module
is not installed.
"""

import sys


def read_with_vtk(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPUnstructuredGridReader, vtkXMLUnstructuredGridReader

    pieces = path.endswith(".pvtu")
    reader = vtkXMLPUnstructuredGridReader() if pieces else vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    data = grid.GetPointData()
    arrays = {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k))
              for k in range(data.GetNumberOfArrays())}
    return grid.GetNumberOfCells(), vtk_to_numpy(grid.GetPoints().GetData()), arrays


def read_with_meshio(path):
    import meshio

    mesh = meshio.read(path)
    return sum(len(block.data) for block in mesh.cells), mesh.points, mesh.point_data


def main(tool, path):
    try:
        cells, points, arrays = {"vtk": read_with_vtk, "meshio": read_with_meshio}[tool](path)
    except ImportError:
        sys.exit(77)
    if path.endswith(".pvtu"):
        print(cells, len(set(arrays["id"])))
        return
    print("cells", cells)
    for name, values in sorted({"position": points, **arrays}.items()):
        values = values.reshape(len(points), -1)
        sums = " ".join(f"{value:.12g}" for value in values.sum(axis=0).astype(float))
        print(name, values.shape[1], sums)


main(*sys.argv[1:])
