"""One piece of work by another library, timed; prints {"seconds": s, "peak_bytes": b}.

    peer.py TASK MESHES(.npz, comma-separated) CELLS

Only the work itself is timed: no imports, no reading but where the task is "files to file".
"""

import json
import resource
import sys
import time

import numpy as np


def gyroid(cells):
    """As examples/stages.rs has it."""
    step = 100.0 / cells
    x = np.arange(-50 - 4 * step, 50 + 4 * step, step)
    x, y, z = np.meshgrid(x, x, x, indexing="ij")
    k = 2 * np.pi / 20
    f = np.sin(k * x) * np.cos(k * y) + np.sin(k * y) * np.cos(k * z) + np.sin(k * z) * np.cos(k * x)
    field = np.maximum(f / (k * np.sqrt(3)), np.sqrt(x * x + y * y + z * z) - 50)
    return field.astype(np.float32), step


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


def write_stl(path, points, faces):
    record = np.zeros(len(faces), dtype=[("n", "<3f4"), ("p", "<9f4"), ("a", "<u2")])
    record["p"] = points[faces].reshape(-1, 9)
    with open(path, "wb") as out:
        out.write(b"\0" * 80 + np.uint32(len(faces)).tobytes() + record.tobytes())


def openvdb_level_set(mesh, step, band):
    import pyopenvdb as vdb

    points, faces = mesh
    transform = vdb.createLinearTransform(voxelSize=step)
    return vdb.FloatGrid.createLevelSetFromPolygons(
        points.astype(np.float32), triangles=faces.astype(np.uint32), transform=transform, halfWidth=band
    )


def openvdb_band(meshes, cells, band):
    _, step, _ = lattice(meshes, cells)
    openvdb_level_set(meshes[0], step, 3.0)


def openvdb_mesh(field):
    import pyopenvdb as vdb

    grid = vdb.FloatGrid(1.0)
    grid.copyFromArray(field)
    start = time.perf_counter()
    points, quads = grid.convertToQuads(0.0)
    return time.perf_counter() - start, len(points), len(quads)


def vtk_mesh(field):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    image = vtk.vtkImageData()
    image.SetDimensions(field.shape)
    image.GetPointData().SetScalars(numpy_to_vtk(field.ravel(order="F"), deep=True))
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.0)
    edges.ComputeNormalsOff()
    start = time.perf_counter()
    edges.Update()
    return time.perf_counter() - start


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
    write_stl("/tmp/peer.stl", points, faces)


def pair_open3d(meshes, cells):
    from skimage.measure import marching_cubes

    low, step, counts = lattice(meshes, cells)
    at = grid_points(low, step, counts)
    mean = sum(0.5 * open3d_distances(mesh, at) for mesh in meshes)
    points, faces, _, _ = marching_cubes(mean, 0.0)
    write_stl("/tmp/peer.stl", points.astype(np.float32), faces)


def main():
    task, names, cells = sys.argv[1], sys.argv[2], int(sys.argv[3])
    meshes = [load(n) for n in names.split(",") if n != "-"]
    if task in ("openvdb-mesh", "vtk-mesh"):
        field, _ = gyroid(cells)
        seconds = openvdb_mesh(field)[0] if task == "openvdb-mesh" else vtk_mesh(field)
    else:
        if task.startswith(("open3d", "igl")):
            at = grid_points(*lattice(meshes, cells))
        if "openvdb" in task:
            import pyopenvdb  # noqa: F401
        if "open3d" in task:
            import open3d  # noqa: F401
        if "igl" in task:
            import igl  # noqa: F401
        start = time.perf_counter()
        match task:
            case "openvdb-band":
                openvdb_band(meshes, cells, 3.0)
            case "open3d-all":
                open3d_distances(meshes[0], at)
            case "igl-all":
                igl_distances(meshes[0], at)
            case "openvdb-pair":
                pair_openvdb(meshes, cells)
            case "open3d-pair":
                pair_open3d(meshes, cells)
        seconds = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(json.dumps({"seconds": seconds, "peak_bytes": peak}))


main()
