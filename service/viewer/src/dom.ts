// Elements by name and by making.
export function element<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`index.html has no #${id}`);
  return found as T;
}
export function make<K extends keyof HTMLElementTagNameMap>(
    tag: K, attributes: Record<string, string> = {}, ...children: (Node|string)[]): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}
/**
 * Sets an element's text if it is another: what is written anew is laid out and painted anew, with every
 * picture.
 */
export function write(target: HTMLElement, text: string): void {
  if (target.textContent !== text) target.textContent = text;
}
/** Fills a select, keeping what was chosen if it is still there. */
export function fill(
    select: HTMLSelectElement,
    options: {value: string; text: string; disabled?: boolean; title?: string}[]): void {
  const text = JSON.stringify(options);
  if (select.dataset['filled'] === text) return;  // an open list must not close under the pointer
  select.dataset['filled'] = text;
  const chosen = select.value;
  select.replaceChildren(...options.map((option) => {
    const made = make('option', {value: option.value}, option.text);
    made.disabled = option.disabled ?? false;
    if (option.title) made.title = option.title;
    return made;
  }));
  if (options.some((option) => option.value === chosen)) select.value = chosen;
}
