// Files that a person has dropped or chosen, with their names within the folder
// that they are in.

export interface PickedFile {
  // As "frames/a.npy".
  name: string;
  file: File;
}

export interface Picked {
  files: PickedFile[];
  // Files that were left out: editors and systems hide theirs in folders.
  hidden: number;
}

// A folder with more is not gone through to its end.
const MOST_FILES = 5000;

export function filesOfInput(list: FileList): Picked {
  return cleaned([...list].map((file) =>
    ({ name: file.webkitRelativePath || file.name, file })));
}

// What is dropped can be asked for only at once, not later.
export function filesOfDrop(data: DataTransfer): Promise<Picked> {
  const entries = [...data.items].map((item) => item.webkitGetAsEntry());
  const files = [...data.files];
  if (entries.some((entry) => entry === null)) {
    return Promise.resolve(cleaned(files.map((file) =>
      ({ name: file.name, file }))));
  }
  return filesOf(entries as FileSystemEntry[]).then(cleaned);
}

async function filesOf(entries: FileSystemEntry[]): Promise<PickedFile[]> {
  const files: PickedFile[] = [];
  const waiting = [...entries];
  while (waiting.length > 0 && files.length < MOST_FILES) {
    const entry = waiting.shift()!;
    if (entry.isFile) {
      const file = await new Promise<File>((resolve, reject) =>
        (entry as FileSystemFileEntry).file(resolve, reject));
      files.push({ name: entry.fullPath.slice(1), file });
    } else {
      waiting.push(...await entriesOf(entry as FileSystemDirectoryEntry));
    }
  }
  return files;
}

async function entriesOf(folder: FileSystemDirectoryEntry):
    Promise<FileSystemEntry[]> {
  const reader = folder.createReader();
  const all: FileSystemEntry[] = [];
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) =>
      reader.readEntries(resolve, reject));
    if (some.length === 0) return all;
    all.push(...some);
  }
}

// Without hidden files, and without the folder that all of them are in.
function cleaned(all: PickedFile[]): Picked {
  const files = all.filter(({ name }) =>
    !name.split('/').some((part) => part.startsWith('.')));
  const top = files[0]?.name.split('/')[0] + '/';
  if (files.every(({ name }) => name.startsWith(top))) {
    for (const file of files) file.name = file.name.slice(top.length);
  }
  return { files, hidden: all.length - files.length };
}
