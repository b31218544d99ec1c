// The data of the page: facts as JSON, and blocks of numbers (zlib, base64), as the program writes them
// (host_sim/render/report).

export const facts = () => JSON.parse(document.getElementById('facts').textContent);

async function bytesOf(name) {
  const text = document.getElementById(`block-${name}`).textContent;
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}

export const floats = async (name) => new Float32Array(await bytesOf(name));
export const doubles = async (name) => new Float64Array(await bytesOf(name));
export const words = async (name) => new Uint32Array(await bytesOf(name));
const octets = async (name) => new Uint8Array(await bytesOf(name));

/// Unsigned LEB128 numbers of a block, one after the other.
function leb128(bytes) {
  let at = 0;
  return () => {
    let value = 0;
    let weight = 1;
    for (;;) {
      const byte = bytes[at++];
      value += (byte & 127) * weight;
      if (byte < 128) return value;
      weight *= 128;
    }
  };
}

/// The heights of the terrain over time, in metres, on the coarse grid of the page.
export class Heights {
  /// `terrain`: of the facts.
  static async load(terrain) {
    const start = await octets('terrain-start');
    const steps = await octets('terrain-steps');
    return new Heights(terrain, start, steps);
  }

  constructor(terrain, start, steps) {
    this.nx = terrain.x_m.length;
    this.ny = terrain.y_m.length;
    this.low = terrain.low_m;
    this.unit = terrain.unit_m;
    const nodes = this.nx * this.ny;
    this.start = new Uint16Array(nodes);
    for (let i = 0; i < nodes; ++i) {
      const left = i % this.nx === 0 ? 0 : this.start[i - 1];
      this.start[i] = left + start[2 * i] + 256 * start[2 * i + 1];
    }
    this.steps = terrain.step_stops.map(() => null);
    const next = leb128(steps);
    for (let step = 0; step < this.steps.length; ++step) {
      const count = next();
      const nodesChanged = new Uint32Array(count);
      const by = new Int32Array(count);
      let node = 0;
      for (let i = 0; i < count; ++i) {
        node += next();
        const code = next();
        nodesChanged[i] = node++;
        by[i] = code % 2 === 1 ? -(code + 1) / 2 : code / 2;
      }
      this.steps[step] = { nodes: nodesChanged, by };
    }
    this.units = Int32Array.from(this.start);
    this.done = 0; // steps that `units` has
  }

  /// Goes to the state after so many steps. Whether anything changed.
  go(steps) {
    const from = this.done;
    while (this.done < steps) this.#apply(this.steps[this.done++], 1);
    while (this.done > steps) this.#apply(this.steps[--this.done], -1);
    return this.done !== from;
  }

  #apply(step, sign) {
    for (let i = 0; i < step.nodes.length; ++i) this.units[step.nodes[i]] += sign * step.by[i];
  }

  metres(node) {
    return this.low + this.unit * this.units[node];
  }
  metresBefore(node) {
    return this.low + this.unit * this.start[node];
  }
}
