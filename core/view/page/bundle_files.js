// SPDX-License-Identifier: Apache-2.0
// The files of a scene: collects what was dropped or chosen, and finds what the scene names. A file is {path,
// size, blob()}; paths have slashes and no leading one.
import {readZip} from './zip.js';

const kIgnored = /(^|\/)(\.|__MACOSX\/|Thumbs\.db$)/;
const kMaxTextBytes = 1 << 26;
const kScene = /\.(json|gltf|glb|pbrt|xml)$/i;
const kMesh = /\.(obj|ply|stl)$/i; // rendered by itself if there is no scene

const folderOf = (path) => path.slice(0, path.lastIndexOf('/') + 1);
const baseOf = (path) => path.slice(path.lastIndexOf('/') + 1);

const toFile = (file, path) => ({path, size: file.size, blob: async () => file});

// Of an <input type="file">, with folders or without.
export function fromInput(list) {
  return unpackSingle([...list].map((file) => toFile(file, file.webkitRelativePath || file.name)));
}

// Of a drop. The entries must be taken before the event is over, so this begins synchronously.
export async function fromDrop(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (entries.length === 0) return fromInput(transfer.files);
  return unpackSingle((await Promise.all(entries.map(walk))).flat());
}

async function walk(entry) {
  const path = entry.fullPath.replace(/^\//, '');
  if (kIgnored.test(path)) return [];
  if (entry.isFile)
    return [
      toFile(
        await new Promise((resolve, reject) => {
          entry.file(resolve, reject);
        }),
        path,
      ),
    ];
  const reader = entry.createReader();
  const files = [];
  while (true) {
    const some = await new Promise((resolve, reject) => {
      reader.readEntries(resolve, reject);
    });
    if (some.length === 0) return files;
    files.push(...(await Promise.all(some.map(walk))).flat());
  }
}

async function unpackSingle(files) {
  const all = [];
  for (const file of files) {
    if (/\.zip$/i.test(file.path)) all.push(...(await readZip(await file.blob())));
    else all.push(file);
  }
  return all.filter(({path}) => !kIgnored.test(path));
}

// What a scene is called: its file's name without the ending, or its folder's if the file is just "scene". As
// the command line has it.
export function sceneName(path) {
  const name = baseOf(path).replace(/\.[^.]*$/, '');
  return (name === 'scene' && baseOf(folderOf(path).slice(0, -1))) || name;
}

// The scene files among them, the likeliest first.
export function findScenes(files) {
  const rank = ({path}) =>
    (kMesh.test(path) ? 1000 : 0) + path.split('/').length * 2 + (/^scene\./i.test(baseOf(path)) ? 0 : 1);
  return files
    .filter(({path}) => (kScene.test(path) || kMesh.test(path)) && !/\.schema\.json$/i.test(path))
    .sort((a, b) => rank(a) - rank(b) || (a.path < b.path ? -1 : 1));
}

// Without "." and "..", as far as they can be resolved.
export function normalise(path) {
  const parts = [];
  for (const part of path.split('/')) {
    if (part === '' || part === '.') continue;
    if (part === '..' && parts.length > 0 && parts.at(-1) !== '..') parts.pop();
    else parts.push(part);
  }
  return parts.join('/');
}

// `path` as seen from `folder` ("a/b/").
export function relativeTo(folder, path) {
  const from = folder.split('/').filter(Boolean),
    to = path.split('/');
  let same = 0;
  while (same < from.length && same < to.length - 1 && from[same] === to[same]) same += 1;
  return [...from.slice(same).map(() => '..'), ...to.slice(same)].join('/');
}

async function textOf(file) {
  return file.size > kMaxTextBytes ? '' : (await file.blob()).text();
}

// The strings of a scene file, which may have comments: in JSON, pbrt and XML they are in the same quotes. URIs of glTF
// also as they are without escapes.
function stringsOf(text) {
  const found = new Set();
  for (const [literal] of text.matchAll(/"(?:[^"\\\n]|\\.)*"/g)) {
    try {
      const string = JSON.parse(literal);
      found.add(string).add(decodeURIComponent(string));
    } catch {
      // No string of JSON, or no URI: the coordinator reports what is missing.
    }
  }
  return found;
}

// The bundle of a scene: [{path, file}], each path as the scene names the file. What the scene does not
// mention is left out unless `isAll`. Files that are missing are reported by the coordinator's validation.
export async function bundleOf(scene, files, isAll) {
  const folder = folderOf(scene.path);
  const byPath = new Map(files.map((file) => [file.path, file]));
  const byLowerPath = new Map(files.map((file) => [file.path.toLowerCase(), file]));
  const bundle = new Map([[baseOf(scene.path), scene]]);
  const add = (file) => bundle.set(relativeTo(folder, file.path), file);
  if (isAll) files.forEach(add);
  const read = new Set(kMesh.test(scene.path) ? [] : [scene]); // grows while it is walked: scene files include others
  for (const some of read) {
    for (const name of stringsOf(await textOf(some))) {
      const path = normalise(folder + name.replaceAll('\\', '/'));
      const file = byPath.get(path) ?? byLowerPath.get(path.toLowerCase());
      if (!file || file === scene) continue;
      add(file);
      if (byPath.has(path)) bundle.set(name, file);
      if (kScene.test(file.path)) read.add(file);
    }
  }
  if (!isAll) await addOfMeshes(bundle, files, add);
  return [...bundle].map(([path, file]) => ({path, file})).sort((a, b) => (a.path < b.path ? -1 : 1));
}

// Material libraries beside the meshes, and the textures that they mention.
async function addOfMeshes(bundle, files, add) {
  const folders = new Set(
    [...bundle.values()].filter(({path}) => /\.obj$/i.test(path)).map(({path}) => folderOf(path)),
  );
  const libraries = files.filter(
    ({path}) => /\.mtl$/i.test(path) && [...folders].some((f) => path.startsWith(f)),
  );
  for (const library of libraries) {
    add(library);
    const text = (await textOf(library)).toLowerCase();
    files.filter(({path}) => text.includes(baseOf(path).toLowerCase())).forEach(add);
  }
}
