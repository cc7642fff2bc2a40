#!/usr/bin/env python3
"""Asks independent libraries whether mesh files print: one line a file, exit 1 if any does not.

trimesh welds identical positions and finds open edges and turned triangles, manifold3d decides
whether it is an oriented 2-manifold, pymeshlab counts self-intersecting triangles and non-manifold
vertices, and with --slice PrusaSlicer must read it as manifold without a repair.
"""
import argparse
import re
import subprocess
import sys

import manifold3d
import numpy as np
import pymeshlab
import trimesh


def faults(path, slice_too):
    loaded = trimesh.load(path, process=False, force="mesh")
    mesh = trimesh.Trimesh(loaded.vertices, loaded.faces, process=False)
    mesh.merge_vertices(digits_vertex=12)
    found = []
    if not mesh.is_watertight:
        found.append("open or branching edges")
    if not mesh.is_winding_consistent:
        found.append("turned triangles")
    if not mesh.volume > 0:
        found.append(f"volume {mesh.volume:.6g}")
    if (mesh.area_faces <= 0).any():
        found.append("triangles without area")
    status = manifold3d.Manifold(
        manifold3d.Mesh(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32))
    ).status()
    if status != manifold3d.Error.NoError:
        found.append(f"manifold3d: {status}")
    lab = pymeshlab.MeshSet(verbose=False)
    lab.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.faces))
    lab.compute_selection_by_self_intersections_per_face()
    if crossing := lab.current_mesh().selected_face_number():
        found.append(f"{crossing} self-intersecting triangles")
    lab.compute_selection_by_non_manifold_per_vertex()
    if pinched := lab.current_mesh().selected_vertex_number():
        found.append(f"{pinched} non-manifold vertices")
    if slice_too:
        said = subprocess.run(
            ["prusa-slicer", "--info", path], capture_output=True, text=True, check=False
        ).stdout
        if not re.search(r"^manifold = yes$", said, re.M):
            found.append("PrusaSlicer: not manifold")
        if repairs := re.findall(
            r"^(?:open_edges|degenerate_facets|edges_fixed|facets_\w+|backwards_edges) = .*", said, re.M
        ):
            found.append("PrusaSlicer: " + ", ".join(repairs))
    return len(mesh.faces), found


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--slice", action="store_true", help="ask PrusaSlicer too")
    parser.add_argument("files", nargs="+")
    options = parser.parse_args()
    bad = 0
    for path in options.files:
        triangles, found = faults(path, options.slice)
        bad += bool(found)
        print(f"{'BAD ' if found else 'ok  '} {path}: {triangles} triangles {'; '.join(found)}")
    print(f"{len(options.files) - bad} passed, {bad} failed")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
