// SPDX-License-Identifier: MIT
// Draws particles as discs and walls as lines by WebGL2.

// --- colours -------------------------------------------------------------------------------------

// sRGB [0, 1] of a colour of OKLab (B. Ottosson 2020) in polar coordinates: lightness, chroma, hue
// [rad].
function fromOklch(L, C, h) {
  const a = C * Math.cos(h), b = C * Math.sin(h);
  const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (L - 0.0894841775 * a - 1.2914855480 * b) ** 3;
  return [4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s]
    .map((linear) => Math.min(1, Math.max(0, linear)))
    .map((linear) => linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);
}

// The colours of 256 values: lightness rises, and the hue falls, in equal perceived steps. On a dark
// page it begins lighter, so that what rests is seen there, too.
export function colourTable(isDark) {
  const lowest = isDark ? 0.54 : 0.41;
  const table = new Uint8Array(4 * 256);
  for (let k = 0; k < 256; ++k) {
    const t = k / 255;
    const colour = fromOklch(lowest + (0.88 - lowest) * t, 0.115 + 0.03 * Math.abs(2 * t - 1), (272 - 170 * t) * Math.PI / 180);
    table.set([...colour.map((part) => Math.round(255 * part)), 255], 4 * k);
  }
  return table;
}

export function drawBar(canvas, table) {
  const image = new ImageData(new Uint8ClampedArray(table), 256, 1);
  canvas.getContext('2d').putImageData(image, 0, 0);
}

// --- particles and walls -------------------------------------------------------------------------

const particleVertex = `#version 300 es
layout(location = 0) in vec2 position;   // [m]
layout(location = 1) in float radius;    // [m]
layout(location = 2) in float value;
layout(location = 3) in float angle;     // [rad]
layout(location = 4) in float grain;     // 1, or 0 of fluid
uniform vec2 middle, scale;              // of the view [m]; clip coordinates per metre
uniform float pixels;                    // per metre
uniform float swell;                     // of the discs of fluid
uniform float most;
out float share;
out float pixelRadius;
out vec2 direction;
out float isGrain;
void main() {
  gl_Position = vec4((position - middle) * scale, 0, 1);
  pixelRadius = radius * pixels * (grain > 0.5 ? 1.0 : swell);
  gl_PointSize = 2.0 * pixelRadius + 2.0;
  share = clamp(value / most, 0.0, 1.0);
  direction = vec2(cos(angle), sin(angle));
  isGrain = grain;
}`;
const particleFragment = `#version 300 es
precision highp float;
in float share;
in float pixelRadius;
in vec2 direction;
uniform sampler2D colours;
in float isGrain;
out vec4 colour;
void main() {
  vec2 offset = (gl_PointCoord - 0.5) * vec2(1, -1) * (2.0 * pixelRadius + 2.0);  // [pixels]
  float distance = length(offset);
  float cover = clamp(pixelRadius - distance + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  vec3 base = texture(colours, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  // A rim, and a spoke that shows how a grain has turned.
  float rim = smoothstep(pixelRadius - max(1.2, 0.14 * pixelRadius) - 0.5, pixelRadius - 0.2, distance);
  float across = abs(direction.x * offset.y - direction.y * offset.x);
  float along = dot(direction, offset);
  float spoke = (1.0 - smoothstep(0.07 * pixelRadius + 0.2, 0.07 * pixelRadius + 1.2, across)) *
                step(0.0, along) * step(4.0, pixelRadius);
  float dark = isGrain * max(0.34 * rim, 0.5 * spoke);
  colour = vec4(base * (1.0 - dark), 1) * cover;
}`;
const wallVertex = `#version 300 es
layout(location = 0) in vec2 position;  // [m]
uniform vec2 middle, scale;
void main() { gl_Position = vec4((position - middle) * scale, 0, 1); }`;
const wallFragment = `#version 300 es
precision highp float;
uniform vec3 ink;
out vec4 colour;
void main() { colour = vec4(ink, 1); }`;

function compile(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

export class Drawing {
  // colourBy() and draw() are due after construction, and when `restored` is called after a lost context.
  constructor(canvas, restored) {
    this.canvas = canvas;
    const gl = canvas.getContext('webgl2', { alpha: true, antialias: true });
    if (!gl) throw new Error('This browser has no WebGL2, which draws the particles.');
    this.gl = gl;
    this.prepare();
    // Otherwise the browser does not restore it.
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => {
      this.prepare();
      restored();
    });
  }

  prepare() {
    const { gl } = this;
    this.particles = compile(gl, particleVertex, particleFragment);
    this.walls = compile(gl, wallVertex, wallFragment);
    this.buffer = gl.createBuffer();
    this.wallBuffer = gl.createBuffer();
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  // By a table of colourTable().
  colourBy(table) {
    const { gl } = this;
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, table);
  }

  // `look` has view [m], most, ink (sRGB, 0 to 1) and swell, by which the discs of fluid are larger.
  draw(frame, look) {
    const { gl, canvas } = this;
    if (gl.isContextLost()) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);

    const [left, low, right, high] = look.view;
    const pixels = Math.min(width / (right - left), height / (high - low));
    const view = (program) => {
      gl.useProgram(program);
      gl.uniform2f(gl.getUniformLocation(program, 'middle'), (left + right) / 2, (low + high) / 2);
      gl.uniform2f(gl.getUniformLocation(program, 'scale'), 2 * pixels / width, 2 * pixels / height);
    };

    view(this.particles);
    gl.uniform1f(gl.getUniformLocation(this.particles, 'pixels'), pixels);
    gl.uniform1f(gl.getUniformLocation(this.particles, 'swell'), look.swell);
    gl.uniform1f(gl.getUniformLocation(this.particles, 'most'), look.most);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, frame.particles, gl.DYNAMIC_DRAW);
    [[0, 2, 0], [1, 1, 8], [2, 1, 12], [3, 1, 16], [4, 1, 20]].forEach(([place, size, offset]) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 24, offset);
    });
    gl.drawArrays(gl.POINTS, 0, frame.particles.length / 6);

    view(this.walls);
    gl.uniform3f(gl.getUniformLocation(this.walls, 'ink'), ...look.ink);
    const corners = wallCorners(frame.walls, 1.25 * ratio / pixels);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.wallBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, corners, gl.DYNAMIC_DRAW);
    [1, 2, 3, 4].forEach((place) => gl.disableVertexAttribArray(place));
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 8, 0);
    gl.drawArrays(gl.TRIANGLES, 0, corners.length / 2);
  }
}

// Two triangles for each line, which extend it by `half` [m] to all sides.
function wallCorners(lines, half) {
  const corners = [];
  for (let k = 0; k < lines.length; k += 4) {
    const [x, y, X, Y] = lines.subarray(k, k + 4);
    const length = Math.hypot(X - x, Y - y) || 1;
    const u = half * (X - x) / length, v = half * (Y - y) / length;
    const a = [x - u - v, y - v + u], b = [x - u + v, y - v - u];
    const c = [X + u - v, Y + v + u], d = [X + u + v, Y + v - u];
    corners.push(...a, ...b, ...c, ...b, ...c, ...d);
  }
  return new Float32Array(corners);
}
