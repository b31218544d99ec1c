// The terrain in 3D: heights over time, the driven paths, the robots. z is up, x east, y north, metres.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { onSchemeChange, styleColor, tickTexts } from './elements.js';

const pathWidth_px = 3;
/// As in the pictures of a run: a longer path hides the ground.
const drawnSides = 20;

/// A text that always faces the reader, `height` metres high.
function textSprite(text, height, color) {
  const size = 64;
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d');
  const font = `${size}px system-ui, "DejaVu Sans", sans-serif`;
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 8;
  canvas.height = size * 1.3;
  context.font = font;
  context.fillStyle = color;
  context.textBaseline = 'middle';
  context.fillText(text, 4, canvas.height / 2);
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map, depthWrite: false }));
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  return sprite;
}

/// 1, 2 or 5 times a power of ten, for some five ticks.
function tickStep(span) {
  const rough = span / 5;
  const decade = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].find((factor) => factor * decade >= rough) * decade;
}

function colorTable(rgb) {
  return rgb.map(([red, green, blue]) =>
    new THREE.Color().setRGB(red / 255, green / 255, blue / 255, THREE.SRGBColorSpace));
}

/// The grid of heights as a mesh whose vertices are coloured.
class Surface {
  constructor(terrain, heights) {
    this.heights = heights;
    this.nx = heights.nx;
    this.ny = heights.ny;
    this.x = terrain.x_m;
    this.y = terrain.y_m;
    this.heightColors = colorTable(terrain.height_colors);
    this.changeColors = colorTable(terrain.change_colors);
    [this.lowest, this.highest] = terrain.color_range_m;
    this.limit = terrain.change_limit_m;
    const nodes = this.nx * this.ny;
    this.geometry = new THREE.BufferGeometry();
    for (const name of ['position', 'normal', 'color']) {
      this.geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * nodes), 3));
    }
    const cells = (this.nx - 1) * (this.ny - 1);
    const index = new Uint32Array(6 * cells);
    let at = 0;
    for (let iy = 0; iy + 1 < this.ny; ++iy) {
      for (let ix = 0; ix + 1 < this.nx; ++ix) {
        const a = iy * this.nx + ix;
        index.set([a, a + 1, a + this.nx, a + 1, a + this.nx + 1, a + this.nx], at);
        at += 6;
      }
    }
    this.geometry.setIndex(new THREE.BufferAttribute(index, 1));
    this.mesh = new THREE.Mesh(this.geometry,
      new THREE.MeshLambertMaterial({ vertexColors: true, side: THREE.DoubleSide }));
    this.mesh.frustumCulled = false;
  }

  /// The height below a place, m.
  below(x, y) {
    const along = (places, place) => {
      const step = places.length > 1 ? places[1] - places[0] : 1;
      return Math.max(0, Math.min(places.length - 1, Math.round((place - places[0]) / step)));
    };
    return this.heights.metres(along(this.y, y) * this.nx + along(this.x, x));
  }

  update(exaggeration, byChange) {
    const { nx, ny, x, y, heights } = this;
    const position = this.geometry.attributes.position.array;
    const normal = this.geometry.attributes.normal.array;
    const color = this.geometry.attributes.color.array;
    const z = new Float32Array(nx * ny);
    for (let i = 0; i < z.length; ++i) z[i] = heights.metres(i) * exaggeration;
    const table = byChange ? this.changeColors : this.heightColors;
    const span = Math.max(1e-9, this.highest - this.lowest);
    for (let iy = 0; iy < ny; ++iy) {
      const south = Math.max(0, iy - 1);
      const north = Math.min(ny - 1, iy + 1);
      for (let ix = 0; ix < nx; ++ix) {
        const i = iy * nx + ix;
        const west = Math.max(0, ix - 1);
        const east = Math.min(nx - 1, ix + 1);
        const slopeX = (z[iy * nx + east] - z[iy * nx + west]) / (x[east] - x[west]);
        const slopeY = (z[north * nx + ix] - z[south * nx + ix]) / (y[north] - y[south]);
        const length = Math.hypot(slopeX, slopeY, 1);
        position.set([x[ix], y[iy], z[i]], 3 * i);
        normal.set([-slopeX / length, -slopeY / length, 1 / length], 3 * i);
        const share = byChange
          ? 0.5 + (0.5 * (heights.metres(i) - heights.metresBefore(i))) / this.limit
          : (heights.metres(i) - this.lowest) / span;
        const entry = table[Math.round(Math.max(0, Math.min(1, share)) * (table.length - 1))];
        color.set([entry.r, entry.g, entry.b], 3 * i);
      }
    }
    for (const attribute of Object.values(this.geometry.attributes)) attribute.needsUpdate = true;
  }
}

/// One robot: its path up to now, and boxes for hull and running gear.
class RobotModel {
  /// `length_m`: of the path, behind the robot, that is drawn.
  constructor(robot, track, stateColors, length_m) {
    this.track = track;
    this.length_m = length_m;
    this.segments = []; // the end point of each drawn segment
    const breaks = new Set(robot.track.breaks);
    for (let i = 1; i < track.rows.length; ++i) if (!breaks.has(i)) this.segments.push(i);
    this.colors = new Float32Array(6 * this.segments.length);
    this.ends_m = []; // how far it is along the path to the end of each segment
    this.segments.forEach((end, i) => {
      const color = stateColors[track.states[end]] ?? stateColors[0];
      this.colors.set([color.r, color.g, color.b, color.r, color.g, color.b], 6 * i);
      const [x, y] = [0, 1].map((axis) => track.places[3 * end + axis] - track.places[3 * (end - 1) + axis]);
      this.ends_m.push((this.ends_m[i - 1] ?? 0) + Math.hypot(x, y));
    });
    this.material = new LineMaterial({ linewidth: pathWidth_px, vertexColors: true });
    this.line = new LineSegments2(new LineSegmentsGeometry(), this.material);
    this.line.frustumCulled = false;
    this.body = new THREE.Group();
    this.body.rotation.order = 'ZYX';
    const part = (box, color) => {
      const made = new THREE.Mesh(
        new THREE.BoxGeometry(box.front - box.back, box.left - box.right, box.top - box.bottom),
        new THREE.MeshLambertMaterial({ color }),
      );
      made.position.set((box.front + box.back) / 2, (box.left + box.right) / 2, (box.top + box.bottom) / 2);
      this.body.add(made);
    };
    if (robot.boxes) {
      for (const gear of robot.boxes.gear) part(gear, 0x22262a);
      part(robot.boxes.hull, 0xd8432b);
      // The nose.
      const { hull } = robot.boxes;
      part({ ...hull, back: hull.front - 0.25 * (hull.front - hull.back), bottom: hull.top, top: hull.top + 0.008 },
        0xffffff);
    } else {
      part({ back: -0.05, front: 0.05, left: 0.05, right: -0.05, bottom: -0.05, top: 0.05 }, 0xd8432b);
    }
  }

  /// Heights `exaggeration` times as high, but not the height of the robot above the ground.
  place(exaggeration, ride_m) {
    const { places } = this.track;
    this.corners = new Float32Array(6 * this.segments.length);
    const up = (i) => (places[3 * i + 2] - ride_m) * exaggeration + ride_m;
    this.segments.forEach((end, i) => {
      const start = end - 1;
      const corner = (at) => [places[3 * at], places[3 * at + 1], up(at)];
      this.corners.set([...corner(start), ...corner(end)], 6 * i);
    });
  }

  /// The path up to a row of the session, or its end.
  show(row, whole) {
    let end = 0;
    while (end < this.segments.length && this.track.rows[this.segments[end]] <= row) ++end;
    let begin = 0;
    while (!whole && begin < end && this.ends_m[end - 1] - this.ends_m[begin] > this.length_m) ++begin;
    this.line.visible = end > begin;
    if (end === begin) return;
    this.line.geometry.dispose();
    this.line.geometry = new LineSegmentsGeometry();
    this.line.geometry.setPositions(this.corners.subarray(6 * begin, 6 * end));
    this.line.geometry.setColors(this.colors.subarray(6 * begin, 6 * end));
  }
}

export class TerrainView {
  /// `tracks`: rows, places and states of the path of each robot. Throws where the browser has no WebGL.
  constructor(parent, facts, heights, tracks) {
    this.parent = parent;
    this.facts = facts;
    this.heights = heights;
    this.exaggeration = 1;
    this.byChange = false;
    this.wholePath = false;
    const [width, depth] = [facts.terrain.x_m, facts.terrain.y_m].map((it) => it.at(-1) - it[0]);
    const path_m = drawnSides * Math.max(width, depth);
    this.renderer = new THREE.WebGLRenderer({ antialias: true });
    this.renderer.setPixelRatio(devicePixelRatio);
    parent.append(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(38, 1, 0.01, 200);
    this.camera.up.set(0, 0, 1);
    this.scene.add(new THREE.AmbientLight(0xffffff, 1.7));
    const sun = new THREE.DirectionalLight(0xffffff, 1.9);
    sun.position.set(-1, 0.6, 1.1);
    this.scene.add(sun);
    this.surface = new Surface(facts.terrain, heights);
    this.scene.add(this.surface.mesh);
    const stateColors = facts.leveling_states.map((state) => new THREE.Color(state.color));
    this.robots = facts.robots.map((robot, i) => new RobotModel(robot, tracks[i], stateColors, path_m));
    for (const robot of this.robots) this.scene.add(robot.line, robot.body);
    this.axes = new THREE.Group();
    this.scene.add(this.axes);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.draw());
    this.controls.maxPolarAngle = 1.5;
    this.#findRide();
    this.resetCamera();
    this.setScheme();
    onSchemeChange(() => this.setScheme());
    new ResizeObserver(() => this.resize()).observe(parent);
    this.resize();
  }

  /// How high the chassis is above the ground, from the start of the first path.
  #findRide() {
    const { places } = this.robots[0].track;
    this.ride = places.length > 0 ? places[2] - this.surface.below(places[0], places[1]) : 0;
  }

  setScheme() {
    this.scene.background = new THREE.Color(styleColor('--panel'));
    this.#drawAxes(styleColor('--ink'), styleColor('--faint'));
    this.update(this.row ?? 0, this.poses ?? [], true);
  }

  #drawAxes(ink, faint) {
    this.axes.clear();
    const { x_m: x, y_m: y } = this.facts.terrain;
    const [west, east] = [x[0], x[x.length - 1]];
    const [south, north] = [y[0], y[y.length - 1]];
    const size = Math.max(east - west, north - south);
    const ground = this.surface.lowest * this.exaggeration - 0.002 * size;
    const letter = 0.035 * size;
    const points = [];
    const add = (...corners) => points.push(...corners.map(([px, py]) => new THREE.Vector3(px, py, ground)));
    const corners = [[west, south], [east, south], [east, north], [west, north]];
    corners.forEach((corner, i) => add(corner, corners[(i + 1) % 4]));
    const text = (words, px, py) => {
      const sprite = textSprite(words, letter, ink);
      sprite.position.set(px, py, ground);
      this.axes.add(sprite);
    };
    const step = tickStep(size);
    const marks = (low, high) => {
      const list = [];
      for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9; ++k) list.push(k * step);
      return list;
    };
    const each = (list, draw) => tickTexts(list).forEach((words, i) => draw(words, list[i]));
    each(marks(west, east), (words, px) => {
      add([px, south], [px, south - 0.015 * size]);
      text(words, px, south - 1.2 * letter);
    });
    each(marks(south, north), (words, py) => {
      add([west, py], [west - 0.015 * size, py]);
      text(words, west - 1.5 * letter, py);
    });
    text('x, east [m]', (west + east) / 2, south - 2.8 * letter);
    text('y, north [m]', west - 4.2 * letter, (south + north) / 2);
    this.axes.add(new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(points),
      new THREE.LineBasicMaterial({ color: faint })));
  }

  /// From the south-west, or from above.
  resetCamera(above = false) {
    const { x_m: x, y_m: y } = this.facts.terrain;
    const middle = new THREE.Vector3((x[0] + x[x.length - 1]) / 2, (y[0] + y[y.length - 1]) / 2, this.surface.lowest);
    const size = Math.max(x[x.length - 1] - x[0], y[y.length - 1] - y[0]);
    const offset = above ? new THREE.Vector3(0, -0.001, 1.85) : new THREE.Vector3(-0.6, -1.25, 1.0);
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(offset, size);
    this.controls.update();
    this.draw();
  }

  resize() {
    const width = this.parent.clientWidth;
    const height = this.parent.clientHeight;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  setExaggeration(times) {
    this.exaggeration = times;
    this.#drawAxes(styleColor('--ink'), styleColor('--faint'));
    this.update(this.row, this.poses, true);
  }
  setByChange(byChange) {
    this.byChange = byChange;
    this.update(this.row, this.poses, true);
  }

  setWholePath(whole) {
    this.wholePath = whole;
    this.update(this.row, this.poses, false);
  }

  /// Shows the heights as they are, the paths up to `row` and the robots at `poses` (x, y, z, roll, pitch, yaw).
  /// `changed`: the surface is to be drawn anew.
  update(row, poses, changed) {
    this.row = row;
    this.poses = poses;
    if (changed) {
      this.surface.update(this.exaggeration, this.byChange);
      for (const robot of this.robots) robot.place(this.exaggeration, this.ride);
    }
    this.robots.forEach((robot, i) => {
      robot.show(row, this.wholePath);
      const pose = poses[i];
      robot.body.visible = pose !== undefined;
      if (pose === undefined) return;
      robot.body.position.set(pose.x, pose.y, (pose.z - this.ride) * this.exaggeration + this.ride);
      // Nose up and left side up are positive.
      robot.body.rotation.set(pose.roll, -pose.pitch, pose.yaw, 'ZYX');
    });
    this.draw();
  }

  draw() {
    if (this.renderer && this.surface) this.renderer.render(this.scene, this.camera);
  }
}
