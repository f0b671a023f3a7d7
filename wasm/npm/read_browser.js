/** The bytes at an address. */
export async function read(address) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`csrbf: ${response.url} could not be loaded: ${response.status}`);
  return response.arrayBuffer();
}
