// SPDX-License-Identifier: MIT
// The module silt.wasm as an object of JavaScript; used by the worker and by the test in node.

const decoder = new TextDecoder();

export async function compileSimulation(bytes) {
  let memory;
  // The standard library asks for a clock, and for files, which there are none of (ENOSYS).
  const system = new Proxy({}, {
    get: (_, name) => name === 'clock_time_get'
      ? (_clock, _precision, result) => {
        const nanoseconds = BigInt(Math.round(performance.now() * 1e6));
        new DataView(memory.buffer).setBigUint64(result, nanoseconds, true);
        return 0;
      }
      : () => 52,
  });
  const { instance } = await WebAssembly.instantiate(bytes, { wasi_snapshot_preview1: system });
  const silt = instance.exports;
  memory = silt.memory;
  silt._initialize();
  return new Simulation(silt);
}

class Simulation {
  constructor(silt) {
    this.silt = silt;
  }

  // The numbers are those at the top of the program, in its order. Throws Silt's own sentence.
  start(scene, numbers) {
    new Float64Array(this.silt.memory.buffer, this.silt.numbers() >>> 0, 5).set(numbers);
    if (!this.silt.start(scene)) throw new Error(this.message());
  }
  // Steps until this time [s], at most `most` of them; returns their number.
  stepUntil(time, most) {
    const steps = this.silt.step_until(time, most);
    if (steps < 0) throw new Error(this.message());
    return steps;
  }
  tilt(angle) {
    if (!this.silt.tilt(angle)) throw new Error(this.message());
  }
  // The state, copied.
  observe(quantity) {
    const { silt } = this;
    if (!silt.observe(quantity)) throw new Error(this.message());
    const floats = (at, size) => new Float32Array(silt.memory.buffer, at >>> 0, size >>> 0).slice();
    const [kinetic, potential, pressure] = new Float64Array(silt.memory.buffer, silt.curves() >>> 0, 3);
    return {
      time: silt.time(),
      timeStep: silt.time_step(),
      size: silt.size() >>> 0,
      particles: floats(silt.picture(), silt.picture_size()),
      walls: floats(silt.walls(), silt.walls_size()),
      kinetic, potential, pressure,
    };
  }
  get time() { return this.silt.time(); }
  endOfProgram(scene) { return this.silt.end_of_program(scene); }
  // 16 hexadecimal digits.
  hash() { return BigInt.asUintN(64, this.silt.hash()).toString(16).padStart(16, '0'); }

  message() {
    const bytes = new Uint8Array(this.silt.memory.buffer);
    const begin = this.silt.error() >>> 0;
    return decoder.decode(bytes.slice(begin, bytes.indexOf(0, begin)));
  }
}
