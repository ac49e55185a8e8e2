// A spec in the fragment of an address: #spec=, then raw DEFLATE (RFC 1951) in base64url (RFC 4648).

const MOST = 2_000_000; // characters; what a link unpacks to is not trusted

async function through(stream, data) {
  const writer = stream.writable.getWriter();
  writer.write(data).catch(() => {});
  writer.close().catch(() => {});
  const parts = [];
  let size = 0;
  for (const reader = stream.readable.getReader(); ; ) {
    const { done, value } = await reader.read();
    if (done) return new Uint8Array(await new Blob(parts).arrayBuffer());
    size += value.length;
    if (size > MOST) {
      reader.cancel();
      throw new Error("the spec in the link is too large");
    }
    parts.push(value);
  }
}

export async function fragment(text) {
  const packed = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(text));
  let letters = "";
  for (const byte of packed) letters += String.fromCharCode(byte);
  return `#spec=${btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "")}`;
}

// The spec of a fragment; null where there is none.
export async function shared(hash) {
  const [, packed] = /^#spec=([\w-]+)$/.exec(hash) ?? [];
  if (!packed) return null;
  const letters = atob(packed.replaceAll("-", "+").replaceAll("_", "/"));
  const data = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
  return new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), data));
}
