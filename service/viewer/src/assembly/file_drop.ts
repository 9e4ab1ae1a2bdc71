// Files that come by a button or by dropping: one assembly, several files, a folder with all below it.

export interface Taken {
  name: string;
  blob: Blob
}

const UNWANTED = /^(\.|thumbs\.db$|desktop\.ini$)/i;

/** A name that the server takes: letters, digits, '.', '_', '-', at most 100, no dot in front. */
export function plain_name(name: string): string {
  const plain = name.normalize('NFKD')
                    .replace(/[\u0300-\u036f]/g, '')
                    .replace(/[^A-Za-z0-9._-]/g, '_')
                    .replace(/^\.+/, '');
  const dot = plain.lastIndexOf('.');
  const ending = dot > 0 ? plain.slice(dot).slice(0, 20) : '';
  return (plain.slice(0, dot > 0 ? dot : undefined).slice(0, 100 - ending.length) || 'file') + ending;
}

/** Gives every file a plain name of its own; what no program wrote for people is left out. */
export function named_apart(files: {name: string; blob: Blob}[]): Taken[] {
  const used = new Set(['scene.json', 'path.csv']);
  return files.filter(({name}) => !UNWANTED.test(name)).map(({name, blob}) => {
    const plain = plain_name(name);
    let own = plain;
    for (let i = 2; used.has(own); ++i) own = plain.replace(/(\.[^.]*)?$/, (ending) => `_${i}${ending}`);
    used.add(own);
    return {name: own, blob};
  });
}

async function files_of(entry: FileSystemEntry): Promise<File[]> {
  if (entry.isFile)
    return [await new Promise<File>((resolve, reject) => {
      (entry as FileSystemFileEntry).file(resolve, reject);
    })];
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const found: File[] = [];
  for (;;) {  // a reader gives a hundred at a time
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => {
      reader.readEntries(resolve, reject);
    });
    if (some.length === 0) return found;
    for (const next of some) found.push(...await files_of(next));
  }
}

/** Takes files dropped anywhere on the page, or chosen with one of the two inputs. */
export function take_files(
    inputs: HTMLInputElement[], dropping: (over: boolean) => void, taken: (files: Taken[]) => void): void {
  const give = (files: File[]) => {
    const named = named_apart(files.map((file) => ({name: file.name, blob: file})));
    if (named.length > 0) taken(named);
  };
  for (const input of inputs) {
    input.addEventListener('change', () => {
      give([...(input.files ?? [])]);
      input.value = '';
    });
  }
  let depth = 0;  // entering a child leaves the parent
  const carries_files = (event: DragEvent) => event.dataTransfer?.types.includes('Files') ?? false;
  window.addEventListener('dragenter', (event) => {
    if (carries_files(event)) {
      event.preventDefault();
      if (++depth === 1) dropping(true);
    }
  });
  window.addEventListener('dragover', (event) => {
    if (carries_files(event)) event.preventDefault();
  });
  window.addEventListener('dragleave', (event) => {
    if (carries_files(event) && --depth === 0) dropping(false);
  });
  window.addEventListener('drop', (event) => {
    if (!carries_files(event)) return;
    event.preventDefault();
    depth = 0;
    dropping(false);
    const entries = [...event.dataTransfer!.items]
                        .map((item) => item.webkitGetAsEntry())
                        .filter((entry): entry is FileSystemEntry => entry !== null);
    const plain = [...event.dataTransfer!.files];
    void (
        entries.length > 0 ? Promise.all(entries.map(files_of)).then((found) => found.flat()) :
                             Promise.resolve(plain))
        .then(give);
  });
}
