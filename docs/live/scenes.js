// SPDX-License-Identifier: MIT
// What the page offers for each scene: the numbers at the top of its program, in the same order, the
// quantities that colours show, and the part of space that is drawn.

// As the enumeration Quantity in scenes.hpp.
const speed = (most) => ({ id: 0, name: 'Speed', unit: 'm/s', most });
const pressure = (most) => ({ id: 1, name: 'Pressure', unit: 'kPa', most, scale: 1e-3 });
const spin = (most) => ({ id: 2, name: 'Spin', unit: 'rad/s', most });

// `digits` are those after the point. A slider with `decades` changes the exponent.
const frictionAngle = (value) => ({
  name: 'friction_angle', label: 'Friction angle', unit: 'rad', value, least: 0, most: 1.2, step: 0.02, digits: 2,
});
const restitution = (value) => ({
  name: 'restitution', label: 'Restitution', unit: '', value, least: 0.05, most: 1, step: 0.05, digits: 2,
});

export const scenes = [
  {
    name: 'dam_break', title: 'Dam break', method: 'MPS', particles: 'fluid particles',
    text: 'A column of water, rounded to whole particles, collapses in a closed tank and runs up its wall.',
    numbers: [
      { name: 'spacing', label: 'Particle spacing', unit: 'm', value: 0.028, least: 0.01, most: 0.05, step: 0.001, digits: 3 },
      { name: 'width', label: 'Width of the column', unit: 'm', value: 0.4, least: 0.1, most: 1.5, step: 0.05, digits: 2 },
      { name: 'height', label: 'Height of the column', unit: 'm', value: 0.8, least: 0.1, most: 1.1, step: 0.05, digits: 2 },
      { name: 'viscosity', label: 'Kinematic viscosity', unit: 'm²/s', value: 1e-6, least: -6, most: -1, step: 0.5, decades: true },
    ],
    quantities: [pressure(8), speed(4)],
    view: [-0.03, -0.03, 1.63, 1.23], hasGauge: true,
  },
  {
    name: 'tower', title: 'Broken tower', method: 'DEM', particles: 'grains',
    text: 'A disc falls on a tower of discs, which breaks and collapses to a heap.',
    numbers: [
      { name: 'R', label: 'Radius of a grain', unit: 'm', value: 0.0125, least: 0.005, most: 0.025, step: 0.0005, digits: 4 },
      frictionAngle(0.46), restitution(0.5),
      { name: 'alpha', label: 'Global damping', unit: '1/s', value: 0.5, least: 0, most: 5, step: 0.1, digits: 1 },
    ],
    quantities: [speed(2.5), spin(60)],
    view: [-0.83, -0.03, 0.83, 1.23],
  },
  {
    name: 'vibrating_floor', title: 'Vibrating floor', method: 'DEM', particles: 'grains',
    text: 'A floor shakes a bed of discs, which is thrown up and lands again.',
    numbers: [
      { name: 'depth', label: 'Depth of the bed', unit: 'm', value: 0.16, least: 0.02, most: 0.5, step: 0.02, digits: 2 },
      { name: 'amplitude', label: 'Amplitude of the floor', unit: 'm', value: 0.012, least: 0, most: 0.03, step: 0.001, digits: 3 },
      { name: 'frequency', label: 'Frequency of the floor', unit: 'Hz', value: 9, least: 1, most: 25, step: 0.5, digits: 1 },
      restitution(0.6), frictionAngle(0.3),
    ],
    quantities: [speed(1.2), spin(60)],
    view: [-0.53, -0.06, 0.53, 0.745], hasSine: true,
  },
  {
    name: 'hopper', title: 'Hopper', method: 'DEM', particles: 'grains',
    text: 'Discs settle in a hopper; after 0.6 s its lid opens and they run out.',
    numbers: [
      { name: 'R', label: 'Mean radius of the grains', unit: 'm', value: 0.0095, least: 0.005, most: 0.02, step: 0.0005, digits: 4 },
      { name: 'opening', label: 'Opening', unit: 'm', value: 0.12, least: 0.02, most: 0.4, step: 0.01, digits: 2 },
      frictionAngle(0.46), restitution(0.5),
    ],
    quantities: [speed(2.5), spin(60)],
    view: [-0.83, -0.03, 0.83, 1.23],
  },
  {
    name: 'wave_maker', title: 'Wave maker', method: 'MPS', particles: 'fluid particles',
    text: 'A piston makes waves, which run up a beach. The depth is rounded to whole particles.',
    numbers: [
      { name: 'spacing', label: 'Particle spacing', unit: 'm', value: 0.02, least: 0.012, most: 0.03, step: 0.001, digits: 3 },
      { name: 'depth', label: 'Depth of the water', unit: 'm', value: 0.24, least: 0.1, most: 0.4, step: 0.02, digits: 2 },
      { name: 'stroke', label: 'Stroke of the piston', unit: 'm', value: 0.08, least: 0, most: 0.2, step: 0.01, digits: 2 },
      { name: 'frequency', label: 'Frequency of the piston', unit: 'Hz', value: 1.1, least: 0.5, most: 2, step: 0.05, digits: 2 },
    ],
    quantities: [speed(0.8), pressure(3)],
    view: [-0.03, -0.03, 2.03, 0.63], hasSine: true,
  },
  {
    name: 'floating_body', title: 'Floating box', method: 'MPS', particles: 'fluid particles',
    text: 'A box is released with a turn, and rights itself or turns over: by its width, height and density.',
    numbers: [
      { name: 'spacing', label: 'Particle spacing', unit: 'm', value: 0.025, least: 0.016, most: 0.04, step: 0.001, digits: 3 },
      { name: 'width', label: 'Width of the box', unit: 'm', value: 0.3, least: 0.1, most: 0.6, step: 0.02, digits: 2 },
      { name: 'height', label: 'Height of the box', unit: 'm', value: 0.2, least: 0.1, most: 0.4, step: 0.02, digits: 2 },
      { name: 'density_ratio', label: 'Density to that of water', unit: '', value: 0.5, least: 0.05, most: 2, step: 0.05, digits: 2 },
      { name: 'turn', label: 'Turn at first', unit: 'rad', value: 0.5, least: -1.5, most: 1.5, step: 0.1, digits: 1 },
    ],
    quantities: [speed(1), pressure(6)],
    view: [-0.03, -0.03, 1.63, 1.23], hasSine: true,
  },
  {
    name: 'landslide', title: 'Landslide', method: 'DEM + MPS', particles: 'grains and fluid particles',
    text: 'Discs slide down a slope into water and make a wave. The depth is rounded to whole particles.',
    numbers: [
      { name: 'spacing', label: 'Particle spacing of the water', unit: 'm', value: 0.025, least: 0.016, most: 0.04, step: 0.001, digits: 3 },
      { name: 'depth', label: 'Depth of the water', unit: 'm', value: 0.2, least: 0.1, most: 0.3, step: 0.02, digits: 2 },
      { name: 'slope', label: 'Slope, rise over run', unit: '', value: 1, least: 0.6, most: 1.2, step: 0.05, digits: 2 },
      { name: 'diameter', label: 'Diameter of the discs', unit: 'm', value: 0.016, least: 0.008, most: 0.016, step: 0.001, digits: 3 },
      { name: 'density', label: 'Density of the discs', unit: 'kg/m³', value: 2500, least: 1100, most: 8000, step: 100, digits: 0 },
    ],
    quantities: [speed(1.5)],
    view: [-0.03, -0.03, 2.03, 0.99],
  },
];

// A number as it stands in a program, with all of its digits: small ones with an exponent.
export function toText(value) {
  return value === 0 || Math.abs(value) >= 1e-3 ? String(value) : value.toExponential();
}

// The text of a program with other numbers.
export function withNumbers(program, scene, values) {
  let text = program;
  scene.numbers.forEach((number, k) => {
    const line = new RegExp(`(constexpr double ${number.name} = )[^;]*;( *)//`);
    text = text.replace(line, (whole, start, space) => {
      const changed = `${start}${toText(values[k])};`;
      const width = whole.length - 2;  // so that the comments stay below each other
      return `${changed.padEnd(Math.max(width, changed.length + 2))}//`;
    });
  });
  return text;
}
