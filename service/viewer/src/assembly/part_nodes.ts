// The tree of an assembly's parts: files, then the nodes of their paths. A node is named by its file and
// path, as a scene's `part` takes it.
import type {Assembly, Box} from '../server/protocol.js';
import {joined} from './units.js';

export interface PartNode {
  key: string;  // file and path
  file: number;
  path: string;
  name: string;
  parts: number[];  // places in Assembly.parts, of this node and all below
  children: PartNode[];
  triangles: number;
  box: Box|null;  // file units
}

export const key_of = (file: number, path: string): string => `${file}:${path}`;

/**
 * One root a mesh file. A part that has others below it (a mesh with child meshes) is a node with a part of
 * its own.
 */
export function part_tree(assembly: Assembly): PartNode[] {
  const roots: PartNode[] = [];
  const nodes = new Map<string, PartNode>();
  const node = (file: number, path: string): PartNode => {
    const key = key_of(file, path);
    const known = nodes.get(key);
    if (known) return known;
    const cut = path.lastIndexOf('/');
    const made: PartNode = {
      key,
      file,
      path,
      name: path === '' ? assembly.files[file].name : path.slice(cut + 1),
      parts: [],
      children: [],
      triangles: 0,
      box: null
    };
    nodes.set(key, made);
    if (path === '')
      roots.push(made);
    else
      node(file, cut < 0 ? '' : path.slice(0, cut)).children.push(made);
    return made;
  };
  assembly.parts.forEach((part, i) => {
    node(part.file, part.path);
    for (let path: string|null = part.path; path !== null; path = path === '' ? null :
             path.includes('/') ? path.slice(0, path.lastIndexOf('/')) :
                                  '')
      node(part.file, path).parts.push(i);
  });
  for (const each of nodes.values()) {
    each.triangles = each.parts.reduce((sum, i) => sum + assembly.parts[i].triangles, 0);
    each.box = joined(each.parts.map((i) => assembly.parts[i].box));
  }
  return roots.sort((a, b) => a.file - b.file);
}

export function find_node(roots: readonly PartNode[], key: string): PartNode|null {
  for (const root of roots) {
    if (root.key === key) return root;
    const below = find_node(root.children, key);
    if (below) return below;
  }
  return null;
}
