#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes the seeds that the corpora began with, as files named seed_*: small valid inputs of each kind, and some that
# are nearly so. All of them are made here. Run it when a format has changed; minimise.sh then adds what fuzzing finds.
# Usage: tests/fuzz/make_seeds.sh [FOLDER]     (by default tests/fuzz/corpus)
# TESSERA names the executable that renders the images; by default that of the release build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
corpus=$(realpath -m "${1:-tests/fuzz/corpus}")
tessera=${TESSERA:-$PWD/build/release/bin/tessera}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

seed() { mkdir -p "$corpus/$1"; cat >"$corpus/$1/seed_$2"; }
part() { printf '\n==== %s\n' "$1"; }
# message TYPE < TEXT: its bytes.
message() {
  protoc --proto_path=proto --encode="tessera.v1.$1" \
    tessera/v1/types.proto tessera/v1/render_service.proto tessera/v1/worker_service.proto
}

# ---- Scenes, meshes, materials ----
cat >"$work/x.obj" <<'EOF'
mtllib x.mtl
v 0 0 0
v 2 0 0
v 2 2 0
v 0 2 0
v 1 1 1.5
vt 0 0
vt 1 0
vt 1 1
vn 0 0 1
usemtl tiles
s 1
f 1/1/1 2/2/1 5/3/1
f 2/1/1 3/2/1 -1/-1/-1
g side
usemtl wood
s off
f 3//1 4//1 5//1
f 4 3 2 1 # floor
f 1 \
 5 2
EOF
cat >"$work/x.mtl" <<'EOF'
newmtl tiles
Kd 0.6 0.2 0.1
Ks 0.3 0.3 0.3
Ns 40
Ke 1 1 1
illum 2
newmtl wood
Kd 0.5 0.4 0.3
map_Kd -s 2 2 1 -o .5 -mm 0 1 -clamp on x.png # old
newmtl glass
Ni 1.45
d 0.2
illum 7
Tf 0.9 0.9 0.9
EOF
cat >"$work/box.json" <<'EOF'
{"render": {"width": 4, "height": 3, "spp": 1},
 "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]},
 "materials": {"m": {"type": "lambert", "albedo": [0.9, 0.5, 0.1]}},
 "shapes": [{"type": "sphere", "radius": 1, "material": "m"}],
 "environment": {"radiance": [1, 2, 3]}}
EOF
for ending in png exr hdr pfm; do
  "$tessera" render "$work/box.json" -o "$work/x.$ending" --scene-cache "$work/cache" >/dev/null 2>&1
done
for i in obj mtl; do seed $i all <"$work/x.$i"; done
printf '# Exported\r\nv 1 2 3 1 0.5 0.5 0.5\rv 4 5 6\rv 7 8 10\rvp 0.1\rl 1 2\rp 1\rfo 1// 2// 3//\r' | seed obj old
printf '\xef\xbb\xbfv -1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ns off\nf 1 2 3 4\nf 4 3 2 1\nf 1 1 2\nf 1 2 3\n' | seed obj odd_faces
printf 'v 0 0 0\nv 3 0 0\nv 3 3 0\nv 1.5 1 0\nv 0 3 0\nf 1 2 3 4 5\nvn 0 0 0\nvn 1e38 1e38 1e38\nf 1//1 2//2 3//1\n' | seed obj concave
printf 'v 0 0 0 1 0 0\nv 1 0 0 nan 0 0\nv 0 1 0 1 255 0 0\nv nan 0 0\nvn nan 0 0\nvt -inf\nf 1/0/1 2/1/9 3// 0/1\nf 1/1/0 2// 3/9\nf 1 2\ns -1\nusemtl\nmtllib\ncstype b\ncall x\nodd\nf 1 2 4\n\x1a\0\0' | seed obj odd_lines
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl \303\244\nf 1 2 3\n' | iconv -f UTF-8 -t UTF-16 | seed obj utf16
printf 'newmtl gold\nNs 0\nKa 1 1 1\nKd 0.9 0.6 0.2\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 0.5\nillum 3\nPr 0.6\nPm 1\nPs 0.1\nPc 0\nPcr 0.03\naniso 0\nmap_Bump -bm 0.5 n.png\nmap_d a.png\nmap_Ke -uvset 1 e.png\nmap_Pr r.png\nNEWMTL b\nillum 4\nNi 1\nTf 2 1 1\nkd 1.1 -1 0.5 7\nmap_Kd -clamp t.png\nmap_Ks .\nNs\nNi -1\n' | seed mtl programs
printf 'newmtl coat\nKd 0.5\nKs 1\nNi 9\nTf 0.5 0 0\nPc 0.5\nPcr 0.1\nPs 0 0.2 0.1\naniso 0.5\nanisor 0.25\nmap_Pm -imfchan b p.png\nmap_Pc p.png\nmap_Pcr p.png\nmap_Ps p.png\n' | seed mtl coat
printf 'newmtl a b # c\nTr 0.5\nPr 0.3\nPm 1\nnorm -bm 2 n.png\nmap_Ks s.png\nKd spectral x.rfl 1\nKa xyz 1 1 1\n' | seed mtl other
scene() { { cat; part x.obj; cat "$work/x.obj"; part x.mtl; cat "$work/x.mtl"; part x.png; cat "$work/x.png"; part x.hdr
  cat "$work/x.hdr"; } | seed scene "$1"; }
seed scene box <"$work/box.json"
scene meshes <<'EOF'
{"camera": {"position": [1, 1, 5], "look_at": [1, 1, 0], "aperture_radius": 0.1, "aperture_blades": 5},
 "output": {"exposure": 1.5, "tone_curve": "agx"},
 "objects": {"o": {"shapes": [{"type": "mesh", "file": "x.obj"}]}},
 "shapes": [{"type": "mesh", "file": "x.obj", "normals": "smooth",
             "transform": [{"scale": [1, -2, 1]}, {"rotate": {"axis": [0, 1, 0], "degrees": 30}}, {"translate": [1, 2, 3]}]},
            {"type": "instance", "object": "o", "transform": [{"matrix": [[1, 0, 0, 5], [0, 2, 0, 0], [0, 0, 1, 0]]}]}],
 "lights": [{"type": "point", "position": [1, 2, 3], "intensity": [4, 5, 6]}]}
EOF
scene textures <<'EOF'
{"camera": {"position": [0.5, 0.5, 2], "look_at": [0.5, 0.5, 0]},
 "textures": {"t": {"file": "x.png", "wrap": "clamp", "scale": [2, 2], "offset": [0.5, 0]}, "sky": {"file": "x.hdr"}},
 "materials": {
  "a": {"type": "lambert", "albedo": {"texture": "t", "tint": 0.5}, "emission": {"texture": "t", "tint": 5}}, // comment
  "g": {"type": "glass", "ior": 1.5, "transmittance": [1, 0.9, 0.8], "roughness": {"texture": "t", "scale": 0.4}},
  "p": {"type": "phong", "diffuse": 0.4, "specular": 0.5, "exponent": 9, "lobe": "n+2", "sampling": "uniform"},
  "c": {"type": "cook_torrance", "conductor": "gold", "roughness": 0.2, "sampling": "half_vector",
        "normal_map": {"texture": "t", "strength": 2}},
  "r": {"type": "mirror", "reflectance": 0.9}},
 "shapes": [{"type": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0], "material": "c"},
            {"type": "sphere", "center": [0.5, 0.5, 0.5], "radius": 0.4, "material": "g"},
            {"type": "sphere", "center": [3, 0, 0], "radius": 0.4, "material": "a"},
            {"type": "sphere", "center": [-3, 0, 0], "radius": 0.4, "material": "p"},
            {"type": "quad", "corner": [0, 0, -9], "edge_u": [9, 0, 0], "edge_v": [0, 9, 0], "material": "r"}],
 "environment": {"texture": "sky", "rotation_degrees": 45}}
EOF
cat >"$work/c.ply" <<'EOF'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property float radius
element curve 1
property uint points
end_header
0 0 0 1
0 1 0 1
1 1 0 1
2 1 0 0
4
EOF
seed mesh curves <"$work/c.ply"
{ cat <<'EOF'
{"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
 "materials": {"m": {"type": "hair", "reflectance": [0.9, 0.5, 0.1], "beta_m": 0.2, "tilt_degrees": 3},
               "n": {"type": "hair", "eumelanin": 1, "pheomelanin": 2}},
 "shapes": [{"type": "curves", "material": "m", "points": [[[0, 0, 0, 0.1], [0, 1, 0, 0.2], [1, 1, 0, 0.1], [1, 2, 0, 0]]]},
            {"type": "curves", "material": "n", "basis": "linear", "shape": "ribbon", "radius": 0.1,
             "points": [[[0, 0, 0], [0, 1, 1]]], "normals": [[[0, 0, 1], [0, 1, 0]]], "transform": [{"scale": 2}]},
            {"type": "curves", "material": "m", "basis": "bezier", "shape": "flat", "file": "c.ply"}],
 "environment": {"radiance": 1}}
EOF
part c.ply; cat "$work/c.ply"; } | seed scene curves
for integrator in naive nee whitted; do
  sed "s/\"spp\": 1/\"spp\": 1, \"integrator\": \"$integrator\", \"filter\": \"gaussian\", \"max_depth\": 5/" \
    "$work/box.json" | seed scene $integrator
done
lights='"lights": [{"type": "spot", "position": [0, 4, 0], "look_at": [0, 0, 0], "intensity": 9, "angle_degrees": 60,
  "softness": 0.5}, {"type": "directional", "direction": [0, -1, 0], "irradiance": 2}]}'
{ grep -v environment "$work/box.json"; echo "$lights"; } | seed scene lights
sed 's/"radius": 1,/"radius": -1, "radios": 2,/' "$work/box.json" | seed scene mistakes
{ cat tests/twins/patterns.json; part tiles.obj; cat tests/twins/tiles.obj; } | seed scene patterns
seed pbrt patterns <tests/twins/patterns.pbrt

# ---- Mitsuba ----
cat >"$work/a.ply" <<'EOF'
ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
property float heat_0
element face 1
property list uchar int vertex_indices
property float weight_0
end_header
0 0 0 0
1 0 0 1
0 1 0 0.5
3 0 1 2 0.7
EOF
mitsuba() { { cat; for i in x.obj x.png a.ply; do part $i; cat "$work/$i"; done; } | seed mitsuba "$1"; }
film='<film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="3"/></film>'
mitsuba shapes <<EOF
<scene version="3.0.0"><default name="r" value="0.5"/>
<integrator type="volpath"><integer name="max_depth" value="4"/></integrator>
<sensor type="thinlens"><float name="fov" value="40"/><float name="aperture_radius" value="0.1"/>
<float name="focus_distance" value="3"/><transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/>
</transform>$film</sensor>
<emitter type="envmap"><string name="filename" value="x.png"/></emitter>
<emitter type="spot"/><emitter type="point"><spectrum name="intensity" value="400:1, 600:2"/></emitter>
<bsdf type="twosided" id="b"><bsdf type="normalmap"><texture name="normalmap" type="bitmap">
<string name="filename" value="x.png"/><transform name="to_uv"><rotate z="1" angle="30"/></transform></texture>
<bsdf type="roughplastic"><float name="alpha" value="\$r"/></bsdf></bsdf></bsdf>
<shape type="obj"><string name="filename" value="x.obj"/><ref id="b"/></shape>
<shape type="sphere"><float name="radius" value="\$r"/><boolean name="flip_normals" value="true"/>
<bsdf type="dielectric"/></shape>
<shape type="shapegroup" id="g"><shape type="cube"/><shape type="disk"/></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><scale x="-1" y="2"/></transform></shape>
<shape type="cylinder"><bsdf type="null"/><medium name="interior" type="homogeneous"><phase type="hg"/></medium>
</shape></scene>
EOF
mitsuba attributes <<EOF
<scene version="0.6.0"><sensor type="orthographic">$film</sensor><emitter type="constant"/>
<shape type="ply"><string name="filename" value="a.ply"/><bsdf type="blendbsdf">
<texture name="weight" type="mesh_attribute"><string name="name" value="face_weight"/></texture>
<bsdf type="principled"><float name="specTrans" value="0.5"/></bsdf>
<bsdf type="roughconductor"><string name="material" value="Au"/><float name="alphaU" value="0.3"/></bsdf></bsdf></shape>
<shape type="rectangle"><emitter type="area"/><bsdf type="mask"><texture name="opacity" type="checkerboard"/>
<bsdf type="diffuse"/></bsdf></shape></scene>
EOF

{ cat <<'EOF'
<scene version="3.0.0"><sensor type="perspective"><float name="shutter_close" value="1"/></sensor>
<shape type="cube"><bsdf type="roughplastic"><texture name="alpha" type="volume">
<volume name="volume" type="gridvolume"><string name="filename" value="g.vol"/><string name="wrap_mode" value="mirror"/>
<transform name="to_world"><scale value="2"/></transform></volume></texture></bsdf></shape>
<shape type="shapegroup" id="g"><shape type="sphere"><bsdf type="diffuse"><srgb name="reflectance" value="#ff8000"/></bsdf></shape></shape>
<shape type="instance"><ref id="g"/><animation name="animation"><transform time="0"/><transform time="1">
<translate x="2"/></transform></animation></shape><emitter type="constant"/></scene>
EOF
part g.vol; printf 'VOL\3\1\0\0\0\2\0\0\0\1\0\0\0\1\0\0\0\1\0\0\0'
head -c 24 /dev/zero
printf '\0\0\0\77\0\0\0\76'
} | seed mitsuba grids

# ---- glTF ----
# Four corners, four texture coordinates, indices, two matrices, weights and joints.
cat >"$work/b.b64" <<'EOF'
AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAA/AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AACA
PwAAgD8AAAEAAgACAAEAAwAAAIA/AAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAA
AAAAAIA/AACAPwAAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAAAAAACAPwAAgD8A
AAAAAAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAPwAAAD8AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAQAAAAEAAAABAAAAAQAA
AAAAAAAAgD8=
EOF
gltf() { { cat; part b.bin; base64 -d "$work/b.b64"; part x.png; cat "$work/x.png"; } | seed gltf "$1"; }
gltf mesh <<'EOF'
{"asset": {"version": "2.0"},
 "buffers": [{"byteLength": 308, "uri": "b.bin"}],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32}, {"buffer": 0, "byteOffset": 80, "byteLength": 12}, {"buffer": 0, "byteOffset": 92, "byteLength": 128}, {"buffer": 0, "byteOffset": 220, "byteLength": 64}, {"buffer": 0, "byteOffset": 284, "byteLength": 16}, {"buffer": 0, "byteOffset": 300, "byteLength": 8}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4}, {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 4}, {"bufferView": 2, "componentType": 5123, "type": "SCALAR", "count": 6}, {"bufferView": 3, "componentType": 5126, "type": "MAT4", "count": 2}, {"bufferView": 4, "componentType": 5126, "type": "VEC4", "count": 4}, {"bufferView": 5, "componentType": 5121, "type": "VEC4", "count": 4}, {"bufferView": 6, "componentType": 5126, "type": "SCALAR", "count": 2}, {"componentType": 5126, "type": "VEC3", "count": 4, "sparse": {"count": 2, "indices": {"bufferView": 5, "componentType": 5121}, "values": {"bufferView": 0, "byteOffset": 12}}}],
 "scene": 0,
 "scenes": [{"nodes": [0, 1, 2]}],
 "nodes": [{"mesh": 0, "children": [3], "rotation": [0, 0.3, 0, 0.9], "scale": [1, -2, 1]}, {"camera": 0, "translation": [0.5, 0.5, 3]}, {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [1, 2, 3]}, {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}}],
 "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 1.5, "znear": 0.1}}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "NORMAL": 7}, "indices": 2, "material": 0}, {"attributes": {"POSITION": 7}, "mode": 5, "material": 1}]}],
 "images": [{"uri": "x.png"}],
 "samplers": [{"wrapS": 33648, "wrapT": 33071}],
 "textures": [{"source": 0, "sampler": 0}],
 "materials": [{"alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": true, "normalTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 0.3, "scale": [2, 1]}}}, "emissiveFactor": [1, 0.5, 0], "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.2, 0.9], "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 0.3, "scale": [2, 1]}}}, "metallicRoughnessTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 0.3, "scale": [2, 1]}}}}}, {"extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.8}, "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.7, 1]}, "KHR_materials_clearcoat": {"clearcoatFactor": 0.5}, "KHR_materials_sheen": {"sheenColorFactor": [0.5, 0.2, 0.1]}, "KHR_materials_iridescence": {"iridescenceFactor": 0.5, "iridescenceThicknessTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 0.3, "scale": [2, 1]}}}}, "KHR_materials_anisotropy": {"anisotropyStrength": 0.4}, "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.2}}}],
 "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 5, "spot": {"outerConeAngle": 0.6}}]}},
 "extensionsUsed": ["KHR_lights_punctual", "KHR_draco_mesh_compression"]}
EOF
gltf skin <<'EOF'
{"asset": {"version": "2.0"},
 "buffers": [{"byteLength": 308, "uri": "b.bin"}],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32}, {"buffer": 0, "byteOffset": 80, "byteLength": 12}, {"buffer": 0, "byteOffset": 92, "byteLength": 128}, {"buffer": 0, "byteOffset": 220, "byteLength": 64}, {"buffer": 0, "byteOffset": 284, "byteLength": 16}, {"buffer": 0, "byteOffset": 300, "byteLength": 8}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4}, {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 4}, {"bufferView": 2, "componentType": 5123, "type": "SCALAR", "count": 6}, {"bufferView": 3, "componentType": 5126, "type": "MAT4", "count": 2}, {"bufferView": 4, "componentType": 5126, "type": "VEC4", "count": 4}, {"bufferView": 5, "componentType": 5121, "type": "VEC4", "count": 4}, {"bufferView": 6, "componentType": 5126, "type": "SCALAR", "count": 2}, {"componentType": 5126, "type": "VEC3", "count": 4, "sparse": {"count": 2, "indices": {"bufferView": 5, "componentType": 5121}, "values": {"bufferView": 0, "byteOffset": 12}}}],
 "nodes": [{"mesh": 0, "skin": 0}, {"children": [2]}, {"translation": [0, 1, 0]}],
 "meshes": [{"weights": [0.5], "primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 5, "WEIGHTS_0": 4, "COLOR_0": 4}, "targets": [{"POSITION": 7}], "material": 0}]}],
 "skins": [{"joints": [1, 2], "inverseBindMatrices": 3}],
 "animations": [{"samplers": [{"input": 6, "output": 4, "interpolation": "CUBICSPLINE"}, {"input": 6, "output": 6}], "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}, {"sampler": 1, "target": {"node": 0, "path": "weights"}}, {"sampler": 1, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/materials/0/alphaCutoff"}}}}]}],
 "materials": [{"extensions": {"KHR_materials_unlit": {}}}]}
EOF

{ cat <<'EOF'
<scene version="3.0.0">
<shape type="bsplinecurve"><string name="filename" value="hair.txt"/><bsdf type="hair"/></shape>
<shape type="linearcurve"><string name="filename" value="hair.txt"/><bsdf type="hair"><rgb name="sigma_a" value="1"/></bsdf></shape>
<emitter type="constant"/></scene>
EOF
part hair.txt; cat <<'EOF'
0 0 0 0.1
0 1 0 0.1
0 2 0 0.1
0 3 1 0

1 0 0 .2
1 1 0 .2
1 2 0 .2
1 3 0 .2
EOF
} | seed mitsuba curves

# ---- pbrt ----
pbrt() { { cat; part parts/a.pbrt; printf 'Translate 0 0 1\nMakeNamedMaterial "m" "string type" "conductor" "float roughness" 0.1\n'; part x.png; cat "$work/x.png"; } | seed pbrt "$1"; }
pbrt shapes <<'EOF'
Option "integer seed" 3
Film "rgb" "integer xresolution" 8 "integer yresolution" 6 "float iso" 200
Sampler "zsobol" "integer pixelsamples" 2
Integrator "volpath" "integer maxdepth" 3
PixelFilter "gaussian"
LookAt 0 0 -5 0 0 0 0 1 0
Camera "perspective" "float fov" 60 "float lensradius" 0.1
WorldBegin
Include "parts/a.pbrt"
LightSource "infinite" "string filename" "x.png" "float scale" 2
LightSource "spot" "blackbody I" 3000 "point3 from" [0 3 0]
Texture "i" "spectrum" "imagemap" "string filename" "x.png" "bool invert" true
Texture "t" "spectrum" "checkerboard" "texture tex1" "i" "rgb tex2" [0.5 0.2 0.1] "float uscale" 2
AttributeBegin
  Material "coateddiffuse" "texture reflectance" "t" "float roughness" 0.2
  Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "normal N" [0 0 1 0 0 1 0 0 1] "integer indices" [0 1 2] "float alpha" 0.5
AttributeEnd
NamedMaterial "m"
Shape "sphere" "float radius" 0.5 "float zmax" 0.25
Shape "loopsubdiv" "point3 P" [0 0 0 1 0 0 0 1 0 0 0 1] "integer indices" [0 1 2 0 3 1] "integer levels" 1
Shape "bilinearmesh" "point3 P" [0 0 0 1 0 1 0 1 1 1 1 0]
ObjectBegin "o" Scale 1 2 1 Shape "sphere" Shape "cylinder" Shape "disk" ObjectEnd
ReverseOrientation ObjectInstance "o"
EOF
pbrt media <<'EOF'
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [1 2 3] "float g" 0.3
MediumInterface "" "fog"
Camera "orthographic"
WorldBegin
MakeNamedMedium "grid" "string type" "uniformgrid" "integer nx" 2 "integer ny" 1 "integer nz" 1 "float density" [1 2]
AttributeBegin
  MediumInterface "grid" "fog" Material "interface" Shape "sphere" "float radius" 2
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "spectrum L" [400 1 600 2] "float power" 5 Translate 0 1 3 Shape "disk"
AttributeEnd
MakeNamedMaterial "a" "string type" "dielectric" "spectrum eta" "glass-BK7"
MakeNamedMaterial "b" "string type" "diffusetransmission"
Attribute "material" "string materials" ["a" "b"]
Material "mix" "float amount" 0.3 Shape "cylinder" "float phimax" 90
EOF

pbrt curves <<'EOF'
WorldBegin
Material "hair" "float eumelanin" 1 "float beta_n" 0.4
Shape "curve" "string type" "cylinder" "point3 P" [0 0 0 1 0 0 1 1 0 1 1 1] "float width0" 0.2 "float width1" 0
Shape "curve" "string basis" "bspline" "integer degree" 2 "point3 P" [0 0 0 1 0 0 1 1 0 1 1 1] "float width" 0.2
Shape "curve" "string type" "ribbon" "point3 P" [0 0 0 1 0 0 1 1 0 1 1 1] "normal N" [0 0 1 1 0 0]
EOF

# ---- Images ----
for ending in png exr hdr pfm; do seed image $ending <"$work/x.$ending"; done
gm convert "$work/x.png" -depth 16 "$work/deep.png" && seed image png16 <"$work/deep.png"
gm convert "$work/x.png" -colorspace Gray "$work/gray.png" && seed image png_gray <"$work/gray.png"
gm convert "$work/x.png" -type Palette -interlace Line "$work/palette.png" && seed image png_palette <"$work/palette.png"
gm convert "$work/x.png" -quality 60 "$work/x.jpg" && seed image jpg <"$work/x.jpg"
gm convert "$work/x.png" -resize '40x9!' -interlace Line "$work/progressive.jpg"
seed image jpg_progressive <"$work/progressive.jpg"
sed 's/"width": 4/"width": 16/' "$work/box.json" >"$work/wide.json"
"$tessera" render "$work/wide.json" -o "$work/wide.hdr" >/dev/null 2>&1 && seed image hdr_packed <"$work/wide.hdr"
{ printf 'Pf\n2 2\n1.0\n'; printf '0123456789abcdef'; } | seed image pfm_gray
for ending in tga bmp tif webp; do
  gm convert "$work/x.png" "$work/x.$ending" && seed image "$ending" <"$work/x.$ending"
done
printf '\0\0\12\0\0\0\0\0\0\0\0\0\4\0\2\0\40\10\202abcd\0efgh\203ijkl' | seed image tga_packed
printf 'qoif\0\0\0\3\0\0\0\2\4\0\376\200@ k\301\25\377\1\2\3\4\0\0\0\0\0\0\0\1' | seed image qoi
gm convert "$work/deep.png" -compress LZW "$work/deep.tif" && seed image tif16_lzw <"$work/deep.tif"
gm convert "$work/x.png" -colorspace CMYK "$work/cmyk.jpg" && seed image jpg_cmyk <"$work/cmyk.jpg"
gm convert "$work/x.png" -colorspace CMYK "$work/cmyk.tif" && seed image tif_cmyk <"$work/cmyk.tif"
printf '#?RGBE\r\nEXPOSURE=2\r\n\r\n+X 2 -Y 3\r\nabc\200\1\1\1\2def\201\1\1\1\2' | seed image hdr_old_runs
printf '#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 2\nabc\200def\201' | seed image hdr_xyz

# ---- Games ----
cat <<'EOF' | seed sgf game
(;FF[4]GM[1]SZ[9]PB[Black]PW[White \] 9p]RE[B+R]DT[2016-03-13]AB[aa:bb][cc]AW[ii]AE[aa]
;B[dd];W[]C[a pass];B[ee](;W[ed];B[fd])(;W[tt]))
EOF
printf '(;SZ[3];B[aa];W[ba];W[ab];B[cc])' | seed sgf capture

# ---- Tokens and certificates ----
printf '# the farm\nsubmit anna 0123456789abcdef0\nwork shed ABCDEFGHIJKLMNOP-._~+/=\nadmin me aaaaaaaaaaaaaaaaaaaa\n' | seed tokens roles
printf '0123456789abcdef\r\nmore' | seed tokens one
printf '[::1]:7420' | seed tokens loopback
printf '127.0.0.1:0' | seed tokens address
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 36500 -subj /CN=fuzz \
  -keyout "$work/key.pem" -out "$work/certificate.pem" 2>/dev/null
openssl genpkey -algorithm ed25519 -out "$work/other.pem"
openssl pkey -in "$work/key.pem" -aes128 -passout pass:secret -out "$work/locked.pem"
pem() { { cat "$work/certificate.pem"; part key; cat "$work/$2.pem"; } | seed pem "$1"; }
pem pair key
pem other_key other
pem locked_key locked
{ cat "$work/key.pem"; part key; cat "$work/certificate.pem"; } | seed pem swapped

# ---- The cache of built scenes ----
scene_file=$(find "$work/cache" -name '*.scene' | head -n 1)
# Behind the header of 88 bytes: the key's length, the size of a letter, the key.
key_bytes=$(od -An -j 88 -N 8 -t u8 "$scene_file" | tr -d ' ')
{ part index; tail -c +$((88 + 8 + 4 + key_bytes + 1)) "$scene_file"; } | seed cache index
{ part patch; printf '\x60\x00\x00\x00\x01\x02'; } | seed cache patch
{ part cut; head -c 90 /dev/zero; part patch; printf '\x00\x00\x00\x00X'; } | seed cache cut
printf '' | seed cache nothing

# ---- Loaded scenes ----
printf '' | seed loaded nothing
{ printf paths; part index; printf '\x01\x00\x00\x00\x00\x02\x00\x00'; } | seed loaded paths
{ part index; printf '\x01\x00\x00\x00\x00\x02\x00\x00'; } | seed loaded width
{ part index; printf '\x20\x00\x00\x00\x04'; part index; printf '\x80\x00\x00\x00\x00\x00\x80\x7f'; } | seed loaded numbers
{ part block; printf '\x10\x00\x00\x00\x00\x00\xc0\x7f'; } | seed loaded texel
{ part cut; head -c 900 /dev/zero; } | seed loaded cut

# ---- Checkpoints ----
printf '' | seed checkpoint nothing
{ part index; printf '\x40\x00\x00\x00\xff\xff'; } | seed checkpoint settings
{ part tail; printf '\x01\x00\x00\x00\x09'; } | seed checkpoint bytes
{ part block; printf '\x10\x00\x00\x00\xff\xff\xff\xff'; } | seed checkpoint sums
{ part cut; head -c 90 /dev/zero; } | seed checkpoint cut
{ part file; printf '\x60\x00\x00\x00\x01\x02'; } | seed checkpoint file

# ---- The farm ----
rect_of_tile() { echo "rect { x0: $((64 * $1)) y0: 0 x1: $((64 * $1 + 64)) y1: 4 }"; }
greeting() {
  message SynchronizeRequest <<<"worker_id: \"$1\" name: \"host-$1\" version: \"1\" determinism_fingerprint: \"f00d\"
    threads: 4 wanted_leases: ${2:-2} known_job_ids: \"a\" ${3:-}"
}
delivery() {
  message SubmitResultRequest <<<"worker_id: \"1\" job_id: \"a\" lease_id: ${2:-1099511627777}
    items { item { $(rect_of_tile 1) sample_begin: $1 sample_end: $(($1 + 1)) } sums_zstd: \"a sample\" }
    render_time { nanos: 500000000 } ${3:-}"
}
delivery 2 | seed result one
{ delivery 3 1099511627777 'lease_finished: true'; part result; delivery 3; } | seed result twice
{ delivery 2 7; part raw; delivery 2; part result; delivery 40; } | seed result refused
{ part raw; message SubmitResultRequest <<<"worker_id: \"1\" job_id: \"a\" lease_id: 1099511627777
  items { item { $(rect_of_tile 1) sample_begin: 2 sample_end: 3 } planes_zstd: \"x\" sums_xxh3: 1 } held_lease_ids: 1099511627778
  held_lease_ids: 1099511627778 lease_finished: true"; } | seed result planes
delivery 2 1099511627777 'lease_finished: true held_lease_ids: 1099511627778' | seed result holding
delivery 2 1099511627777 'decline_reason: "the scene does not fit into memory" lease_finished: true version: "2"
  determinism_fingerprint: "other"' | seed result given_back
message SubmitResultRequest <<<"worker_id: \"1\" job_id: \"a\" items { item { $(rect_of_tile 0) sample_begin: 0
  sample_end: 6 } counters { samples: 1536 non_finite_samples: 1 first_non_finite { x: 3 y: 4 sample: 5 } } }" |
  seed result counters
{ part sync; greeting 1; part sync; greeting 2; part wait; printf '12345678'; part result; delivery 2; part checkpoint
  part restart; part sync; greeting 2 2 'held { id: 1099511627778 job_id: "a" items { rect { x1: 64 y1: 4 }
  sample_begin: 1 sample_end: 3 } }'; } | seed farm restart
{ part pause; printf a; part resume; printf b; part extend; message ExtendJobRequest <<<'job_id: "c" spp: 9'; part sync
  greeting 3 5; part cancel; printf b; part delete; printf a; part image; printf c; } | seed farm changes
{ part submit; message SubmitJobRequest <<<'request_id: "once" priority: 3 overrides { width_px: 70 spp: 3 }
  bundle { scene_path: "s" }'; part sync; greeting 1 1 'draining: true'; part wait
  printf '%100s' ''; part 'blob lost'; printf '{}'; } | seed farm submit
item() { echo "items { item { $(rect_of_tile "$1") sample_begin: $2 sample_end: $3 } ${4:-} }"; }
{ part result; message SubmitResultRequest <<<"worker_id: \"1\" job_id: \"a\" $(item 1 2 4)"
  for worker in 2 3; do part sync; greeting $worker 5; done
  for worker in 2 3; do
    part result; message SubmitResultRequest <<<"worker_id: \"$worker\" job_id: \"a\" $(item 1 2 4 'sums_zstd: "x"')"
  done; part checkpoint; part restart; part sync; greeting 3; } | seed farm audits
{ for worker in 1 2 3; do part sync; greeting $worker 3; part wait; printf '%60s' ''; done; } | seed farm silent

# ---- Submissions ----
assets='bundle { scene_path: "scene.json" assets { path: "scene.json" } assets { path: "x.obj" } assets { path: "x.mtl" }
  assets { path: "x.png" } }'
submission() { message SubmitJobRequest <<<"$assets $1"; part blob; cat; for i in obj mtl png; do part blob; cat "$work/x.$i"; done; }
mesh_scene='{"camera": {"position": [1, 1, 5], "look_at": [1, 1, 0]}, "shapes": [{"type": "mesh", "file": "x.obj"}],
 "render": {"width": 8, "height": 8}}'
submission 'request_id: "1" name: "house" priority: -1' <<<"$mesh_scene" | seed bundle mesh
submission 'overrides { width_px: 9 height_px: 7 spp: 2 seed: 5 integrator: INTEGRATOR_NEE heuristic: HEURISTIC_POWER
  crop { x0: 1 y0: 1 x1: 4 y1: 5 } } display { exposure_stops: -2 tone_curve: TONE_CURVE_ACES }' \
  <"$work/box.json" | seed bundle overrides
submission 'overrides { width_px: 4000000000 }' <"$work/box.json" | seed bundle too_large
submission '' <<<'{"shapes": [}' | seed bundle broken
message SubmitJobRequest <<<'bundle { scene_path: "../etc/passwd" assets { path: "../etc/passwd" digest { sha256: "1" } } }' |
  seed bundle path

# ---- State ----
settings='settings { width_px: 130 height_px: 4 spp: 6 integrator: INTEGRATOR_MIS filter: PIXEL_FILTER_BOX
  filter_radius_px: 0.5 }'
job() { message Job <<<"id: \"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\" name: \"x\" $*"; }
{ part spec; job "$settings"; } | seed state spec
{ part spec; job "settings { width_px: 65536 height_px: 16384 spp: 16777216 integrator: INTEGRATOR_NEE }"; } |
  seed state large
{ part spec; job "$settings display { exposure_stops: 4 tone_curve: TONE_CURVE_AGX } created_at { seconds: 99 nanos: 1 }
  submitter: \"anna\" priority: 4"; part counters; message Counters <<<'samples: 7 shadow_rays: 9'; } | seed state all
{ part numbers; printf '\x03\x06\x00\x00\x00\x01\x00\x00\x00\x00\x01\x00\x00\x00\x00\x00\x00\x00\x02'; } | seed state numbers
{ part tile; printf '\x01'; message RenderedItem <<<"item { $(rect_of_tile 1) sample_end: 2 } sums_zstd: \"x\""
  part done; printf '\x01\x00\x00\x00\x00\x02\x00\x00\x00'; } | seed state tile
{ part done; printf '\x00\x00\x00\x00\x00\x09\x00\x00\x00\x05\x00\x00\x00\x04\x00\x00\x00'; } | seed state samples
{ part patch; printf '\x00\x40\x00\x00\x0d\x00\x00'; part patch; printf '\x1c\x00\x00\x00\x01'; } | seed state patch
{ part cut; head -c 3000 /dev/zero; } | seed state cut
{ part failure; printf 'no \xff text'; part request_id; printf 'request b'; } | seed state texts
{ part log; printf '\x37\x7f\x06\x82\x00\x2d\xe2\x18\x00\x00\x40\x00'; head -c 100 /dev/zero; } | seed state log
