// A picture of a scene: bodies as spheres, walls as surfaces one sees through, forces as lines.
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  Group,
  IcosahedronGeometry,
  InstancedBufferAttribute,
  InstancedMesh,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { colourOf } from "./colours";
import { brokenOf, type Picture, type Scalars } from "./frames";
import type { PolyData } from "./vtp";

/** Beyond this many spheres each has fewer triangles. */
const MANY = 3000;

export interface Shown {
  picture: Picture;
  spheresBy: Scalars | undefined;
  linesBy: Scalars | undefined;
  hasWalls: boolean;
  hasLines: boolean;
}

export class Viewport {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(35, 1);
  readonly #controls: OrbitControls;
  #content = new Group();
  #isPlaced = false;

  /** Throws where the browser has no WebGL. */
  constructor(canvas: HTMLCanvasElement) {
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#camera.up.set(0, 0, 1);
    const sun = new DirectionalLight("#ffffff", 2.2);
    sun.position.set(-0.4, 0.3, 1);
    this.#camera.add(sun);
    this.#scene.add(new AmbientLight("#ffffff", 1), this.#camera, this.#content);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.listenToKeyEvents(canvas);
    // The page scrolls with the wheel, unless somebody is at the picture.
    this.#controls.enableZoom = false;
    canvas.addEventListener("focus", () => (this.#controls.enableZoom = true));
    canvas.addEventListener("blur", () => (this.#controls.enableZoom = false));
    this.#controls.addEventListener("change", () => this.#draw());
  }

  resize(width: number, height: number): void {
    this.#renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#draw();
  }

  show({ picture, spheresBy, linesBy, hasWalls, hasLines }: Shown): void {
    this.#clear();
    const { spheres, walls, lines } = picture;
    if (spheres) this.#content.add(spheresOf(spheres, spheresBy));
    if (walls && hasWalls) this.#content.add(wallsOf(walls));
    if (lines && hasLines) this.#content.add(linesOf(lines, linesBy));
    // Walls may be far larger than what they hold.
    if (!this.#isPlaced) this.#place((spheres ?? lines ?? walls)?.points ?? new Float64Array());
    this.#draw();
  }

  dispose(): void {
    this.#clear();
    this.#controls.dispose();
    this.#renderer.dispose();
  }

  /** Looks at all points, a little from above. */
  #place(points: Float64Array): void {
    const low = new Vector3(Infinity, Infinity, Infinity);
    const high = low.clone().negate();
    const point = new Vector3();
    for (let at = 0; at < points.length; at += 3) {
      point.fromArray(points, at);
      low.min(point);
      high.max(point);
    }
    if (low.x > high.x) return;
    const size = Math.max(high.distanceTo(low), 1e-9);
    this.#controls.target.copy(low).lerp(high, 0.5);
    this.#camera.position
      .copy(this.#controls.target)
      .addScaledVector(new Vector3(0.55, -1, 0.45).normalize(), (1.9 * size) / Math.min(1, this.#camera.aspect));
    this.#camera.near = 0.01 * size;
    this.#camera.far = 20 * size;
    this.#camera.updateProjectionMatrix();
    this.#controls.update();
    this.#isPlaced = true;
  }

  #clear(): void {
    this.#content.traverse((part) => {
      if (part instanceof Mesh || part instanceof LineSegments) {
        (part.geometry as BufferGeometry).dispose();
        (part.material as LineBasicMaterial).dispose();
      }
      if (part instanceof InstancedMesh) part.dispose();
    });
    this.#content.clear();
  }

  #draw(): void {
    this.#renderer.render(this.#scene, this.#camera);
  }
}

function spheresOf({ points, pointData }: PolyData, by: Scalars | undefined): InstancedMesh {
  const count = points.length / 3;
  const radii = pointData.find(({ name }) => name === "radius_m")?.values;
  const mesh = new InstancedMesh(new IcosahedronGeometry(1, count > MANY ? 1 : 3), new MeshLambertMaterial(), count);
  const matrix = new Matrix4();
  for (let index = 0; index < count; index++) {
    const radius = radii?.[index] ?? 0;
    matrix
      .makeScale(radius, radius, radius)
      .setPosition(points[3 * index] ?? 0, points[3 * index + 1] ?? 0, points[3 * index + 2] ?? 0);
    mesh.setMatrixAt(index, matrix);
  }
  mesh.instanceColor = new InstancedBufferAttribute(colourOf(by, count), 3);
  mesh.frustumCulled = false;
  return mesh;
}

function wallsOf({ points, corners, ends }: PolyData): Group {
  const triangles: number[] = [];
  const edges: number[] = [];
  let first = 0;
  for (const end of ends) {
    for (let corner = first; corner < end; corner++) {
      const next = corner + 1 < end ? corner + 1 : first;
      edges.push(corners[corner] ?? 0, corners[next] ?? 0);
      if (corner > first && corner + 1 < end)
        triangles.push(corners[first] ?? 0, corners[corner] ?? 0, corners[corner + 1] ?? 0);
    }
    first = end;
  }
  const surface = geometryOf(points, triangles);
  surface.computeVertexNormals();
  const outline = geometryOf(points, edges);
  const grey = new Color("#7d8c88");
  return new Group().add(
    new Mesh(
      surface,
      new MeshLambertMaterial({ color: grey, side: DoubleSide, transparent: true, opacity: 0.12, depthWrite: false }),
    ),
    new LineSegments(outline, new LineBasicMaterial({ color: grey, transparent: true, opacity: 0.45 })),
  );
}

/** Lines that have broken are left out. Each line has ends of its own, so that it has one colour, and is seen through the bodies it joins. */
function linesOf(part: PolyData, by: Scalars | undefined): LineSegments {
  const { points, lines } = part;
  const isBroken = brokenOf(part);
  const whole = [...lines.keys()].filter((end) => !(isBroken[end >> 1] ?? 0));
  const colours = colourOf(by, lines.length / 2);
  const [places, both] = [new Float64Array(3 * whole.length), new Float32Array(3 * whole.length)];
  whole.forEach((end, index) => {
    const point = 3 * (lines[end] ?? 0);
    places.set(points.subarray(point, point + 3), 3 * index);
    both.set(colours.subarray(3 * (end >> 1), 3 * (end >> 1) + 3), 3 * index);
  });
  const geometry = geometryOf(places);
  geometry.setAttribute("color", new BufferAttribute(both, 3));
  return new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, depthTest: false }));
}

function geometryOf(points: Float64Array, index?: number[]): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(points), 3));
  if (index) geometry.setIndex(index);
  return geometry;
}
