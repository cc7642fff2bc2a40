"""One piece of work by another library on two threads, timed; prints
{"seconds": s, "peak_bytes": b, "size": what it made}.

    peer.py TASK FILES(.npz meshes or .npy samples, comma-separated) CELLS

Only the work itself is timed: no imports, no reading but where the task is "files to file".
"""

import json
import resource
import sys
import tempfile
import time

import numpy as np


def load(name):
    data = np.load(name)
    return data["points"], data["faces"]


def lattice(meshes, cells):
    points = np.vstack([p for p, _ in meshes])
    low, high = points.min(0), points.max(0)
    step = (high - low).max() / cells
    counts = np.ceil((high - low) / step).astype(int) + 9
    return low - 4 * step, step, counts


def grid_points(low, step, counts):
    axes = [low[i] + step * np.arange(counts[i]) for i in range(3)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), -1)


def write_stl(points, faces):
    record = np.zeros(len(faces), dtype=[("n", "<3f4"), ("p", "<9f4"), ("a", "<u2")])
    record["p"] = points[faces].reshape(-1, 9)
    with tempfile.TemporaryFile(suffix=".stl") as out:
        out.write(b"\0" * 80 + np.uint32(len(faces)).tobytes() + record.tobytes())
    return len(faces)


def openvdb_level_set(mesh, step, band):
    import pyopenvdb as vdb

    points, faces = mesh
    transform = vdb.createLinearTransform(voxelSize=step)
    return vdb.FloatGrid.createLevelSetFromPolygons(
        points.astype(np.float32), triangles=faces.astype(np.uint32), transform=transform, halfWidth=band
    )


def openvdb_band(meshes, cells):
    _, step, _ = lattice(meshes, cells)
    return openvdb_level_set(meshes[0], step, 3.0).activeVoxelCount()


def openvdb_mesh(samples):
    """Samples beyond the band are its background, as in any level set."""
    import pyopenvdb as vdb

    grid = vdb.FloatGrid(float(samples.max()))
    grid.copyFromArray(samples)
    grid.prune()
    start = time.perf_counter()
    points, quads = grid.convertToQuads(0.0)
    return time.perf_counter() - start, len(quads)


def vtk_mesh(samples):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    vtk.vtkSMPTools.Initialize(2)
    image = vtk.vtkImageData()
    image.SetDimensions(samples.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(samples.ravel(), deep=True))
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.0)
    edges.ComputeNormalsOff()
    start = time.perf_counter()
    edges.Update()
    return time.perf_counter() - start, edges.GetOutput().GetNumberOfCells()


def skimage_mesh(samples):
    from skimage.measure import marching_cubes

    start = time.perf_counter()
    faces = marching_cubes(samples, 0.0)[1]
    return time.perf_counter() - start, len(faces)


def open3d_distances(mesh, at):
    import open3d as o3d

    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(mesh[0].astype(np.float32), mesh[1].astype(np.uint32))
    return scene.compute_signed_distance(at.astype(np.float32)).numpy()


def igl_distances(mesh, at):
    import igl

    return igl.signed_distance(at.reshape(-1, 3), mesh[0], mesh[1].astype(np.int64), 4)[0]


def pair_openvdb(meshes, cells):
    import pyopenvdb as vdb

    low, step, counts = lattice(meshes, cells)
    sums = np.zeros(counts, np.float32)
    for mesh in meshes:
        grid = openvdb_level_set((mesh[0] - low, mesh[1]), step, 16.0)
        dense = np.zeros(counts, np.float32)
        grid.copyToArray(dense)
        sums += 0.5 * dense
    grid = vdb.FloatGrid(float(16 * step))
    grid.copyFromArray(sums)
    points, quads = grid.convertToQuads(0.0)
    faces = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return write_stl(points, faces)


def pair_open3d(meshes, cells):
    from skimage.measure import marching_cubes

    low, step, counts = lattice(meshes, cells)
    at = grid_points(low, step, counts)
    mean = sum(0.5 * open3d_distances(mesh, at) for mesh in meshes)
    points, faces, _, _ = marching_cubes(mean, 0.0)
    return write_stl(points.astype(np.float32), faces)


MESHERS = {"openvdb-mesh": openvdb_mesh, "vtk-mesh": vtk_mesh, "skimage-mesh": skimage_mesh}
WORK = {
    "openvdb-band": openvdb_band,
    "open3d-all": lambda meshes, _: open3d_distances(meshes[0], at).size,
    "igl-all": lambda meshes, _: igl_distances(meshes[0], at).size,
    "openvdb-pair": pair_openvdb,
    "open3d-pair": pair_open3d,
}


def main():
    global at
    task, names, cells = sys.argv[1], sys.argv[2].split(","), int(sys.argv[3])
    if task in MESHERS:
        seconds, size = MESHERS[task](np.load(names[0]))
    else:
        if task.endswith("-all"):
            meshes = [load(n) for n in names]
            at = grid_points(*lattice(meshes, cells))
        if task.startswith("openvdb"):
            import pyopenvdb  # noqa: F401
        if task.startswith("open3d"):
            import open3d  # noqa: F401
        if task.startswith("open3d-pair"):
            import skimage.measure  # noqa: F401
        if task.startswith("igl"):
            import igl  # noqa: F401
        if not task.endswith("-pair"):
            meshes = [load(n) for n in names]
        start = time.perf_counter()
        if task.endswith("-pair"):
            meshes = [load(n) for n in names]
        size = WORK[task](meshes, cells)
        seconds = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(json.dumps({"seconds": seconds, "peak_bytes": peak, "size": int(size)}))


main()
