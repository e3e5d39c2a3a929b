// A picture of a test: bodies as spheres, walls as surfaces one sees through, forces as lines, cells in
// flat colours.
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
  MeshBasicMaterial,
  MeshLambertMaterial,
  Scene,
  WebGLRenderer,
} from "three";
import { colourOf } from "./colours";
import { boundsOf, brokenOf, type Picture, type Scalars } from "./frames";
import { viewOf, type View } from "./view";
import type { PolyData } from "./vtp";

/** Beyond this many spheres each has fewer triangles. */
const MANY = 3000;

export interface Shown {
  picture: Picture;
  spheresBy: Scalars | undefined;
  linesBy: Scalars | undefined;
  cellsBy: Scalars | undefined;
  hasWalls: boolean;
  hasLines: boolean;
  /** Whether the view is taken anew when what is seen has another place or size. */
  follows: boolean;
}

export class Viewport {
  readonly #canvas: HTMLCanvasElement;
  readonly #isFlat: boolean;
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #sun = new DirectionalLight("#ffffff", 2.2);
  #content = new Group();
  #aspect = 1;
  /** Made for the first picture, and kept for all that follow. */
  #view: View | undefined;
  /** What the view was made for. */
  #bounds = "";

  /** Throws where the browser has no WebGL. */
  constructor(canvas: HTMLCanvasElement, isFlat: boolean) {
    this.#canvas = canvas;
    this.#isFlat = isFlat;
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#sun.position.set(-0.4, 0.3, 1);
    this.#scene.add(new AmbientLight("#ffffff", 1), this.#content);
  }

  resize(width: number, height: number): void {
    this.#renderer.setSize(width, height, false);
    this.#aspect = width / height;
    this.#view?.setAspect(this.#aspect);
    this.#draw();
  }

  show({ picture, spheresBy, linesBy, cellsBy, hasWalls, hasLines, follows }: Shown): void {
    this.#clear();
    const { spheres, walls, lines, cells } = picture;
    if (spheres) this.#content.add(spheresOf(spheres, spheresBy));
    if (cells) this.#content.add(cellsOf(cells, cellsBy));
    if (walls && hasWalls) this.#content.add(wallsOf(walls));
    if (lines && hasLines) this.#content.add(linesOf(lines, linesBy));
    // Walls may be far larger than what they hold.
    const seen = spheres ?? cells ?? lines ?? walls;
    if (seen && (!this.#view || follows)) this.#place(seen);
    this.#draw();
  }

  dispose(): void {
    this.#clear();
    this.#leave();
    this.#renderer.dispose();
  }

  #place(seen: PolyData): void {
    const bounds = boundsOf(seen);
    if (!bounds || JSON.stringify(bounds) === this.#bounds) return;
    this.#bounds = JSON.stringify(bounds);
    this.#leave();
    this.#view = viewOf(bounds, this.#isFlat, this.#aspect, this.#canvas);
    this.#view.camera.add(this.#sun);
    this.#scene.add(this.#view.camera);
    this.#view.controls.addEventListener("change", () => this.#draw());
  }

  #leave(): void {
    if (!this.#view) return;
    this.#view.controls.dispose();
    this.#scene.remove(this.#view.camera);
    this.#view = undefined;
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
    if (this.#view) this.#renderer.render(this.#scene, this.#view.camera);
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

/** Each cell has corners of its own, so that it has one colour; displacements have one at each corner. */
function cellsOf({ points, corners, ends }: PolyData, by: Scalars | undefined): Mesh {
  const isByPoint = by?.values.length === points.length / 3;
  const colours = colourOf(by, isByPoint ? points.length / 3 : ends.length);
  const [places, own] = [new Float32Array(3 * corners.length), new Float32Array(3 * corners.length)];
  let cell = 0;
  corners.forEach((point, corner) => {
    while (corner >= (ends[cell] ?? Infinity)) cell++;
    const from = 3 * (isByPoint ? point : cell);
    places.set(points.subarray(3 * point, 3 * point + 3), 3 * corner);
    own.set(colours.subarray(from, from + 3), 3 * corner);
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.setAttribute("color", new BufferAttribute(own, 3));
  geometry.setIndex(trianglesOf(ends));
  return new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true, side: DoubleSide }));
}

/** Polygons cut into triangles, as places in the list of all corners. */
function trianglesOf(ends: Int32Array): number[] {
  const triangles: number[] = [];
  let first = 0;
  for (const end of ends) {
    for (let corner = first + 1; corner + 1 < end; corner++) triangles.push(first, corner, corner + 1);
    first = end;
  }
  return triangles;
}

function wallsOf({ points, corners, ends }: PolyData): Group {
  const triangles = trianglesOf(ends).map((corner) => corners[corner] ?? 0);
  const edges: number[] = [];
  let first = 0;
  for (const end of ends) {
    for (let corner = first; corner < end; corner++) {
      const next = corner + 1 < end ? corner + 1 : first;
      edges.push(corners[corner] ?? 0, corners[next] ?? 0);
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
