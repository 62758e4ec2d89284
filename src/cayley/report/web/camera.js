// The eye: it looks at a target from a distance, and is moved by mouse, wheel, pen or fingers.

const ANGLE = (30 * Math.PI) / 180; // of view, from top to bottom

class Camera {
  /** `up` is an axis of space. */
  constructor(up) {
    this.up = up;
    const k = up.findIndex((component) => component !== 0);
    const first = [0, 0, 0];
    first[(k + 1) % 3] = 1;
    this.first = first; // the direction of azimuth zero
    this.second = cross(up, first);
    this.target = [0, 0, 0];
    this.distance = this.size = 1;
    this.look("oblique");
  }

  look(view) {
    const angles = { oblique: [-60, 20], front: [-90, 0], side: [0, 0], top: [-90, 89.9] }[view];
    [this.azimuth, this.elevation] = angles.map((degrees) => (degrees * Math.PI) / 180);
  }

  /** See all of a box, and some room around it for labels. */
  fit(low, high, aspect) {
    this.target = times(0.5, add(low, high));
    this.size = Math.max(0.5 * Math.hypot(...minus(high, low)), 1e-9);
    this.distance = this.size / Math.sin(0.5 * ANGLE);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [0, 1, 2].map((axis) => (k & (1 << axis) ? high : low)[axis]));
    for (let round = 0; round < 4; round++) {
      const seen = corners.map((corner) => projected(this.matrix(aspect), corner));
      const most = Math.max(...seen.flatMap(([x, y]) => [Math.abs(x) / 0.82, Math.abs(y) / 0.82]));
      this.distance *= most;
    }
  }

  get backward() {
    const level = add(times(Math.cos(this.azimuth), this.first), times(Math.sin(this.azimuth), this.second));
    return add(times(Math.cos(this.elevation), level), times(Math.sin(this.elevation), this.up));
  }

  get eye() {
    return add(this.target, times(this.distance, this.backward));
  }

  matrix(aspect) {
    const far = this.distance + 8 * this.size;
    const near = Math.max(this.distance - 8 * this.size, 0.01 * this.distance);
    return matrixProduct(perspective(ANGLE, aspect, near, far), lookAt(this.eye, this.target, this.up));
  }

  orbit(dx, dy) {
    const most = (89.9 * Math.PI) / 180;
    this.azimuth -= 0.008 * dx;
    this.elevation = Math.min(most, Math.max(-most, this.elevation + 0.008 * dy));
  }

  pan(dx, dy, height) {
    const right = unit(cross(this.up, this.backward));
    const above = cross(this.backward, right);
    const scale = (2 * Math.tan(0.5 * ANGLE) * this.distance) / height;
    this.target = add(this.target, add(times(-dx * scale, right), times(dy * scale, above)));
  }

  zoom(factor) {
    this.distance = Math.min(50 * this.size, Math.max(1e-3 * this.size, this.distance * factor));
  }
}

/**
 * Move the camera that `camera()` returns by events of an element: drag to orbit, with the right button or shift to pan,
 * wheel or two fingers to zoom.
 */
function listen(element, camera, changed, clicked) {
  const fingers = new Map();
  let moved = 0;
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    moved = 0;
  });
  element.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    moved += Math.abs(dx) + Math.abs(dy);
    const other = [...fingers].find(([id]) => id !== event.pointerId);
    fingers.set(event.pointerId, now);
    if (other) {
      const apart = (place) => Math.hypot(place[0] - other[1][0], place[1] - other[1][1]) || 1;
      camera().zoom(apart(before) / apart(now));
      camera().pan(0.5 * dx, 0.5 * dy, element.clientHeight);
    } else if (event.buttons & 2 || event.shiftKey) camera().pan(dx, dy, element.clientHeight);
    else camera().orbit(dx, dy);
    changed();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    element.addEventListener(end, (event) => {
      fingers.delete(event.pointerId);
      if (end === "pointerup" && moved < 4) clicked(event.offsetX, event.offsetY);
    });
  }
  element.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      camera().zoom(Math.exp(0.0012 * event.deltaY * (event.deltaMode ? 30 : 1)));
      changed();
    },
    { passive: false },
  );
}
