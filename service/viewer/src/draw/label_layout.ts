// Where labels go: beside their points, not over one another, nor over what else lies on the picture.
export interface Box {
  x: number;
  y: number;
  width: number;
  height: number
}

const GAP = 3;    // px between two
const NEAR = 12;  // px from the point

const overlap = (a: Box, b: Box): boolean => a.x < b.x + b.width + GAP && b.x < a.x + a.width + GAP &&
    a.y < b.y + b.height + GAP && b.y < a.y + a.height + GAP;

/**
 * Places boxes of `sizes` beside `points`, the first ones first; null where no room is free, which hides
 * that label. `taken`: what must stay free, and `frame`: the picture. Pixels.
 */
export function place_labels(
    points: ({
      x: number;
      y: number
    }|null)[],
    sizes: {width: number; height: number}[], taken: readonly Box[], frame: Box): (Box|null)[] {
  const used = [...taken];
  return points.map((point, i) => {
    if (!point) return null;
    const {width, height} = sizes[i];
    for (let ring = 0; ring < 6; ++ring) {
      const away = NEAR + ring * (height + GAP);
      for (const [x, y] of [
               [point.x + NEAR, point.y + away - height / 2], [point.x + NEAR, point.y - away - height / 2],
               [point.x - NEAR - width, point.y + away - height / 2],
               [point.x - NEAR - width, point.y - away - height / 2]]) {
        const box = {x: Math.round(x), y: Math.round(y), width, height};
        const inside = box.x >= frame.x && box.y >= frame.y && box.x + width <= frame.x + frame.width &&
            box.y + height <= frame.y + frame.height;
        if (!inside || used.some((other) => overlap(box, other))) continue;
        used.push(box);
        return box;
      }
    }
    return null;
  });
}
