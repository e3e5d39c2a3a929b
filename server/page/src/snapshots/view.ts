// How a picture is looked at: from a little above and all around, or face on where it is flat.
import { MOUSE, OrthographicCamera, PerspectiveCamera, TOUCH, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

/** Room around a flat picture, over its size. */
const ROOM = 1.06;

export interface View {
  camera: PerspectiveCamera | OrthographicCamera;
  controls: OrbitControls;
  /** Width of the canvas over its height. */
  setAspect: (aspect: number) => void;
}

export interface Bounds {
  low: number[];
  high: number[];
}

/** Looks at all that lies within the bounds; at what is flat, along z. */
export function viewOf({ low, high }: Bounds, isFlat: boolean, aspect: number, canvas: HTMLCanvasElement): View {
  const [from, to] = [new Vector3(...low), new Vector3(...high)];
  const centre = from.clone().lerp(to, 0.5);
  const extent = to.clone().sub(from);
  const size = Math.max(extent.length(), 1e-9);
  const view = isFlat ? flat(extent, canvas) : spatial(canvas);
  const { camera, controls } = view;
  const way = isFlat ? new Vector3(0, 0, 1) : new Vector3(0.55, -1, 0.45).normalize();
  controls.target.copy(centre);
  camera.position.copy(centre).addScaledVector(way, (1.9 * size) / Math.min(1, aspect));
  camera.near = 0.01 * size;
  camera.far = 20 * size;
  view.setAspect(aspect);
  controls.update();
  followKeysAndWheel(controls, canvas);
  return view;
}

function spatial(canvas: HTMLCanvasElement): View {
  const camera = new PerspectiveCamera(35);
  camera.up.set(0, 0, 1);
  const setAspect = (aspect: number): void => {
    camera.aspect = aspect;
    camera.updateProjectionMatrix();
  };
  return { camera, controls: new OrbitControls(camera, canvas), setAspect };
}

/** Lengths along x and y are the same, however near one is; a drag moves what one cannot turn. */
function flat({ x, y }: Vector3, canvas: HTMLCanvasElement): View {
  const camera = new OrthographicCamera();
  const controls = new OrbitControls(camera, canvas);
  controls.enableRotate = false;
  controls.mouseButtons.LEFT = MOUSE.PAN;
  controls.touches.ONE = TOUCH.PAN;
  const setAspect = (aspect: number): void => {
    const half = (ROOM / 2) * Math.max(y, x / aspect, 1e-9);
    [camera.bottom, camera.top] = [-half, half];
    [camera.left, camera.right] = [-half * aspect, half * aspect];
    camera.updateProjectionMatrix();
  };
  return { camera, controls, setAspect };
}

/** The page scrolls with the wheel, unless somebody is at the picture. */
function followKeysAndWheel(controls: OrbitControls, canvas: HTMLCanvasElement): void {
  controls.listenToKeyEvents(canvas);
  controls.enableZoom = document.activeElement === canvas;
  canvas.addEventListener("focus", () => (controls.enableZoom = true));
  canvas.addEventListener("blur", () => (controls.enableZoom = false));
}
