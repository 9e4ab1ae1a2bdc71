// Colours of contact, told apart with any colour vision (Okabe and Ito): the mock-up's kinds are warm, the
// tool's cool. theme.css repeats the kinds for the legend.
import type {Kind} from '../server/protocol.js';

export const KIND_COLOUR: Record<Kind, number> = {
  cst: 0xd55e00,
  bst: 0xe69f00,
  est: 0xf0e442,
  cmt: 0x0072b2,
  bmt: 0x56b4e9,
  imt: 0xcc79a7
};
/** For areas and zones, by turns. */
export const CYCLE = [0xd55e00, 0x0072b2, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0xf0e442];

export const KIND_TEXT: Record<Kind, string> = {
  cst: 'mock-up, intersecting',
  bst: 'mock-up, in a boundary voxel',
  est: 'mock-up, enclosed by the tool',
  cmt: 'tool, intersecting',
  bmt: 'tool, in a boundary voxel',
  imt: 'tool, inside the mock-up',
};

export interface Theme {
  page: number;
  mockup: number;
  tool: number;
  grid: number;
  normal: number;
  force: number;
  torque: number;
  height: number;
  point: number;
  voxel: number;
  ghost: number
}
export const LIGHT: Theme = {
  page: 0xf7f7f5,
  mockup: 0xc9cdd0,
  tool: 0x9db4c6,
  grid: 0xdcdfdd,
  normal: 0x009e73,
  force: 0x1c2126,
  torque: 0x7a5ea8,
  height: 0x009e73,
  point: 0x1c2126,
  voxel: 0xb7821a,
  ghost: 0x5d6670,
};
export const DARK: Theme = {
  page: 0x14171a,
  mockup: 0x6f777e,
  tool: 0x6f8fa8,
  grid: 0x2a3036,
  normal: 0x2fcf9c,
  force: 0xf2f4f5,
  torque: 0xc3a5f5,
  height: 0x2fcf9c,
  point: 0xf2f4f5,
  voxel: 0xe0b050,
  ghost: 0x9aa4ad,
};
