// A SpaceMouse for a page, in place of the browser's WebHID: window.cap says what its cap does, and unplugs
// it. A function for addInitScript.
export function stand_in_hid() {
  class Device extends EventTarget {
    vendorId = 0x256f;
    productId = 0xc635;
    productName = 'SpaceMouse Compact';
    opened = false;
    async open() {
      this.opened = true;
    }
    async close() {
      this.opened = false;
    }
  }
  const device = new Device();
  const hid = new EventTarget();
  hid.getDevices = async () => [];  // none was allowed before
  hid.requestDevice = async ({filters}) =>
      (filters.some(
           ({vendorId, productId}) => vendorId === device.vendorId && productId === device.productId) ?
           [device] :
           []);
  Object.defineProperty(navigator, 'hid', {value: hid});
  window.cap = {
    report(id, values) {
      if (!device.opened) return;
      const data = new DataView(new ArrayBuffer(2 * values.length));
      values.forEach((value, i) => data.setInt16(2 * i, value, true));
      device.dispatchEvent(Object.assign(new Event('inputreport'), {device, reportId: id, data}));
    },
    unplug() {
      device.opened = false;
      hid.dispatchEvent(Object.assign(new Event('disconnect'), {device}));
    },
  };
}
