// What a 3Dconnexion cap reports over HID, as driver/spacemouse/report.h has it: 1 moves (newer ones: and
// turns), 2 turns, 3 buttons.
export const FULL = 350;  // about a full deflection

/** The models that speak so, for the browser's choice. */
export const MODELS: HIDDeviceFilter[] = [
  [0x046d, 0xc626], [0x046d, 0xc62b],
  ...[0xc62e, 0xc62f, 0xc631, 0xc632, 0xc633, 0xc635, 0xc638, 0xc63a, 0xc652].map(
      (product) => [0x256f, product])
].map(([vendorId, productId]) => ({vendorId, productId}));

/** Deflections x, y, z, rx, ry, rz as the device counts them, −1 … 1: x right, y towards the user, z down. */
export interface Cap {
  axes: number[];
  buttons: number
}
export const at_rest = (): Cap => ({axes: [0, 0, 0, 0, 0, 0], buttons: 0});

/** Takes a report; what it does not speak of stays. False, and nothing changed: it is none that is known. */
export function take_report(cap: Cap, id: number, data: DataView): boolean {
  const put = (first: number, count: number): void => {
    for (let i = 0; i < count; ++i)
      cap.axes[first + i] = Math.max(-1, Math.min(1, data.getInt16(2 * i, true) / FULL));
  };
  if (id === 1 && data.byteLength >= 6)
    put(0, data.byteLength >= 12 ? 6 : 3);
  else if (id === 2 && data.byteLength >= 6)
    put(3, 3);
  else if (id === 3 && data.byteLength >= 1) {
    cap.buttons = 0;
    for (let i = 0; i < Math.min(4, data.byteLength); ++i)
      cap.buttons = (cap.buttons | (data.getUint8(i) << (8 * i))) >>> 0;
  } else
    return false;
  return true;
}
