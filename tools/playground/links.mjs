// Links: a model of the library by its name, any other text compressed; all behind `#`, which no server sees.
const through = async (data, stream) =>
  new Uint8Array(await new Response(new Blob([data]).stream().pipeThrough(stream)).arrayBuffer());
const toText = bytes =>
  btoa(Array.from(bytes, b => String.fromCharCode(b)).join('')).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
const toBytes = text => Uint8Array.from(atob(text.replaceAll('-', '+').replaceAll('_', '/')), c => c.charCodeAt(0));

export async function write({ model, text, scene, parameters }) {
  const found = new URLSearchParams();
  if (model) found.set('model', model);
  else found.set('text', toText(await through(new TextEncoder().encode(text), new CompressionStream('deflate-raw'))));
  if (scene) found.set('scene', scene);
  for (const [name, value] of Object.entries(parameters)) found.set(`p.${name}`, value);
  return `#${String(found).replaceAll('%2F', '/')}`;
}

/** What a link opens; null if it names nothing. */
export async function read(hash, models) {
  const given = new URLSearchParams(hash.slice(1));
  const numbers = [...given].filter(([name, x]) => name.startsWith('p.') && Number.isFinite(+x));
  const parameters = Object.fromEntries(numbers.map(([name, x]) => [name.slice(2), +x]));
  const scene = given.get('scene') ?? '';
  const model = given.get('model');
  if (model !== null) return model === 'new' || models[model] ? { model, scene, parameters } : null;
  if (!given.get('text')) return null;
  try {
    const bytes = await through(toBytes(given.get('text')), new DecompressionStream('deflate-raw'));
    return { text: new TextDecoder().decode(bytes), scene, parameters };
  } catch {
    return null; // a link that was cut
  }
}
