// The little of WebHID that is used here: TypeScript's own library has none of it.
interface HIDDeviceFilter {
  vendorId: number;
  productId: number
}
interface HIDInputReportEvent extends Event {
  readonly device: HIDDevice;
  readonly reportId: number;
  readonly data: DataView
}
interface HIDDevice extends EventTarget {
  readonly vendorId: number;
  readonly productId: number;
  readonly productName: string;
  readonly opened: boolean;
  open(): Promise<void>;
  close(): Promise<void>;
  addEventListener(type: 'inputreport', listener: (event: HIDInputReportEvent) => void): void;
}
interface HID extends EventTarget {
  getDevices(): Promise<HIDDevice[]>;
  requestDevice(options: {filters: HIDDeviceFilter[]}): Promise<HIDDevice[]>;
  addEventListener(type: 'disconnect', listener: (event: Event&{readonly device: HIDDevice}) => void): void;
}
interface Navigator {
  readonly hid?: HID
}
