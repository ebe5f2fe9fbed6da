# SPDX-License-Identifier: Apache-2.0
"""A Tessera shape of the type `curves` as hair of Blender (3.4), for Cycles."""

import array
import os
import sys

import bpy

from cycles_materials import CannotConvert, refuse_unknown

PLY_TYPES = {"float": "f", "uint": "I"}


def read_ply(path):
    """Of a binary PLY file's elements, their properties by name: every property is a float or a uint."""
    elements, words = {}, array.array("I")
    with open(path, "rb") as file:
        lines = iter(file.readline, b"end_header\n")
        layout = []
        for line in (raw.decode("ascii").split() for raw in lines):
            if line[0] == "format" and line[1] != "binary_little_endian":
                raise CannotConvert(f"{path}: only binary PLY files of curves are converted for Cycles")
            if line[0] == "element":
                layout.append((line[1], int(line[2]), []))
            if line[0] == "property":
                layout[-1][2].append((line[2], PLY_TYPES[line[1]]))
        words.frombytes(file.read())
    if sys.byteorder == "big":
        words.byteswap()
    begin = 0
    for name, count, properties in layout:
        end = begin + count * len(properties)
        elements[name] = {key: array.array(kind, words[begin + i : end : len(properties)].tobytes())
                          for i, (key, kind) in enumerate(properties)}
        begin = end
    return elements


def strands_of(d, folder):
    """A list of control points (x, y, z, radius) for each curve."""
    radius = d.get("radius", 0)
    if "file" not in d:
        return [[(*point[:3], point[3] if len(point) > 3 else radius) for point in strand] for strand in d["points"]]
    elements = read_ply(os.path.join(folder, d["file"]))
    vertex = elements["vertex"]
    radii = vertex.get("radius", [radius] * len(vertex["x"]))
    points = iter(zip(vertex["x"], vertex["y"], vertex["z"], radii))
    return [[next(points) for _ in range(count)] for count in elements["curve"]["points"]]


def ends_of_segments(points, basis):
    """Where the cubic segments of a curve begin and end: Cycles' splines, Catmull and Rom's, pass through there."""
    if basis == "catmull_rom":
        return points[1:-1]
    if basis == "b_spline":
        return [tuple((a + 4 * b + c) / 6 for a, b, c in zip(*three)) for three in zip(points, points[1:], points[2:])]
    raise CannotConvert(f"curves of the basis '{basis}' are not converted for Cycles")


def curves_parts(d, folder, material):
    """(data, modify): an empty hair object's data, and what adds the modifier to its object that fills it. Blender's
    scripts cannot make hair themselves; its geometry nodes make it of the edges of a mesh."""
    refuse_unknown("a shape of the type 'curves'", d, {"type", "file", "points", "basis", "shape", "radius", "material",
                                                       "transform"})
    if d.get("shape", "round") != "round":
        raise CannotConvert("only round curves are converted for Cycles")
    strands = [ends_of_segments(strand, d.get("basis", "b_spline")) for strand in strands_of(d, folder)]
    group = nodes_from_edges(edges_object(strands), material)

    def modify(placed):
        placed.modifiers.new("hair", "NODES").node_group = group

    return bpy.data.hair_curves.new("curves"), modify


def edges_object(strands):
    """An object of edges along the strands, which is not part of the image. Its vertices know the radius."""
    points = [point for strand in strands for point in strand]
    edges, first = [], 0
    for strand in strands:
        edges += [(first + i, first + i + 1) for i in range(len(strand) - 1)]
        first += len(strand)
    mesh = bpy.data.meshes.new("edges")
    mesh.from_pydata([point[:3] for point in points], edges, [])
    radii = mesh.attributes.new("width", "FLOAT", "POINT")
    radii.data.foreach_set("value", [point[3] for point in points])
    edges_of_strands = bpy.data.objects.new("edges", mesh)
    edges_of_strands.hide_render = True
    bpy.context.collection.objects.link(edges_of_strands)
    return edges_of_strands


def nodes_from_edges(edges_of_strands, material):
    group = bpy.data.node_groups.new("hair", "GeometryNodeTree")
    group.outputs.new("NodeSocketGeometry", "Geometry")
    source = group.nodes.new("GeometryNodeObjectInfo")
    source.inputs["Object"].default_value = edges_of_strands
    curves = group.nodes.new("GeometryNodeMeshToCurve")
    width = group.nodes.new("GeometryNodeInputNamedAttribute")
    width.data_type = "FLOAT"
    width.inputs["Name"].default_value = "width"
    radius = group.nodes.new("GeometryNodeSetCurveRadius")
    painted = group.nodes.new("GeometryNodeSetMaterial")
    painted.inputs["Material"].default_value = material
    output = group.nodes.new("NodeGroupOutput")
    group.links.new(source.outputs["Geometry"], curves.inputs["Mesh"])
    group.links.new(curves.outputs["Curve"], radius.inputs["Curve"])
    group.links.new(next(o for o in width.outputs if o.enabled), radius.inputs["Radius"])
    group.links.new(radius.outputs["Curve"], painted.inputs["Geometry"])
    group.links.new(painted.outputs["Geometry"], output.inputs["Geometry"])
    return group
