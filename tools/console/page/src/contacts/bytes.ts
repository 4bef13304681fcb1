// Bytes that come as base64.

export function bytesOf(text: string): Uint8Array {
  return Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
}

// Numbers of single precision; little-endian, as all machines with a browser.
export function floatsOf(text: string): Float32Array {
  const { buffer } = bytesOf(text);
  return new Float32Array(buffer, 0, Math.floor(buffer.byteLength / 4));
}
