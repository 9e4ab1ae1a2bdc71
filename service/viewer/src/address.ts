// What is shown, kept in the address: a link, or a reload, comes back to it.
// #path=contacts/scene.json&source=run&run=first
export interface Address {
  scene?: string;
  path?: string;
  source?: string;
  run?: string;
  assembly?: string
}

export function read_address(): Address {
  return Object.fromEntries(new URLSearchParams(location.hash.slice(1))) as Address;
}
export function write_address(address: Address): void {
  const known = Object.entries(address).filter(
      (entry): entry is[string, string] => typeof entry[1] === 'string' && entry[1] !== '');
  history.replaceState(null, '', `#${new URLSearchParams(known)}`);
}
