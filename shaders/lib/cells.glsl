// Cells of a regular grid: bricks, groups of 8³ bricks and so on, or voxels.
#ifndef PALPATE_LIB_CELLS
#define PALPATE_LIB_CELLS
#include "shaders/shared/base.h"

uint32_t cell_number(ivec3 cell, ivec3 cells) {
  return uint32_t(cell.x) + uint32_t(cells.x) * (uint32_t(cell.y) + uint32_t(cells.y) * uint32_t(cell.z));
}

ivec3 cell_of_number(uint32_t number, ivec3 cells) {
  uint32_t row = number / uint32_t(cells.x);
  return ivec3(int32_t(number - row * uint32_t(cells.x)), int32_t(row % uint32_t(cells.y)),
               int32_t(row / uint32_t(cells.y)));
}

// First and last cell along each axis that, grown and closed, meets the closed box [lo, hi]. The grid's
// padding of two voxels keeps lo − growth − 1 beyond the origin. ceil(x / side) − 1 = floor((x − 1) / side).
ivec3 first_cell(ivec3 lo, ivec3 origin, int32_t side, int32_t growth) {
  return (lo - growth - 1 - origin) / side;
}
ivec3 last_cell(ivec3 hi, ivec3 origin, int32_t side, int32_t growth, ivec3 cells) {
  return min((hi + growth - origin) / side, cells - 1);
}

// The cell after `cell` in the box [first, last], x fastest; z beyond last.z after the last one.
ivec3 next_cell(ivec3 cell, ivec3 first, ivec3 last) {
  cell.x += 1;
  if (cell.x > last.x) {
    cell.x = first.x;
    cell.y += 1;
    if (cell.y > last.y) {
      cell.y = first.y;
      cell.z += 1;
    }
  }
  return cell;
}
#endif
