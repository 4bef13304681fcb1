// Numbers, times and names of resources, for people.

// "datasets/arm/versions/3" as "arm@3", "aliases/left" as "left".
export function shortName(name: string): string {
  return name.replace(/^[a-z]+\//, '').replace('/versions/', '@');
}

// "datasets/arm/versions/3" as ["arm", "3"].
export function nameParts(name: string): string[] {
  return name.replace(/^[a-z]+\//, '').split('/versions/');
}

// "arm@3" as "datasets/arm/versions/3"; without a version the newest.
export function fullName(kind: string, short: string): string {
  const [name, version] = short.trim().split('@');
  return `${kind}/${name}` + (version ? `/versions/${version}` : '');
}

// "STATE_RUNNING" as "running".
export function word(value: string): string {
  return value.replace(/^[A-Z]+_/, '').toLowerCase().replace(/_/g, ' ');
}

// By the clock of this machine, as "2026-11-28 09:15".
export function moment(ms: string | number): string {
  if (Number(ms) === 0) return '–';
  const date = new Date(Number(ms));
  const two = (value: number) => String(value).padStart(2, '0');
  return `${date.getFullYear()}-${two(date.getMonth() + 1)}-` +
    `${two(date.getDate())} ${two(date.getHours())}:${two(date.getMinutes())}`;
}

export function span(ms: string | number): string {
  const s = Math.round(Number(ms) / 1000);
  if (s < 1) return `${Number(ms)} ms`;
  if (s < 120) return `${s} s`;
  const minutes = Math.floor(s / 60);
  if (minutes < 120) return `${minutes} min`;
  const hours = Math.floor(minutes / 60);
  return hours < 48 ? `${hours} h ${minutes % 60} min` :
    `${Math.floor(hours / 24)} days`;
}

const UNITS = ['B', 'KiB', 'MiB', 'GiB', 'TiB'];

export function bytes(count: string | number): string {
  let value = Number(count);
  let unit = 0;
  for (; value >= 1024 && unit < UNITS.length - 1; ++unit) value /= 1024;
  return `${unit === 0 ? value : Number(value.toPrecision(3))} ${UNITS[unit]}`;
}

export function grouped(count: string | number): string {
  return String(count).replace(/\B(?=(\d{3})+$)/g, ',');
}

export function share(part: number, whole: number): string {
  if (whole === 0) return '–';
  return `${(100 * part / whole).toFixed(1)} %`;
}

export function signed(value: number): string {
  return value > 0 ? `+${value}` : value < 0 ? `−${-value}` : '±0';
}
