// The view of the scene: its camera, and the body that it follows.
import { OrthographicCamera, PerspectiveCamera, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { page } from './data.js';

const vec = x => new Vector3(...x);

function radius(shape) {
  if (shape.parts) return Math.max(...shape.parts.map(radius));
  return Math.max(
    shape.r || 0,
    (shape.length || 0) / 2,
    ...(shape.size || [0]).map(x => x / 2),
    ...(shape.corners || []).map(c => Math.hypot(...c)),
  );
}

export class View {
  makeCamera() {
    this.middle = vec(page.low).add(vec(page.high)).multiplyScalar(0.5);
    let reach = vec(page.high).sub(vec(page.low)).length() / 2;
    for (const [k, body] of page.bodies.entries())
      reach = Math.max(reach, page.bodies.length > 60 ? 0 : radius(body.shape) + this.farthest(k) * 0.75);
    for (const f of page.figures) reach = Math.max(reach, radius(f.shape));
    this.reach = reach * 1.12;
    this.planar
      ? (this.camera = new OrthographicCamera())
      : (this.camera = new PerspectiveCamera(38, 1, this.size / 200, this.size * 60));
    this.camera.up.copy(this.up);
    this.camera.near = page.size / 200;
    this.camera.far = 60 * page.scale;
    this.controls = new OrbitControls(this.camera, this.canvas);
    const far = page.travels; // follow the heaviest body, close to it
    if (far) {
      this.lead = page.bodies.reduce((a, b, k) => (b.mass > page.bodies[a].mass ? k : a), 0);
      this.reach = 0.95 * page.size;
    }
    this.controls.enableRotate = !this.planar;
    this.controls.addEventListener('change', () => (this.dirty = true));
    this.view('home');
    if (far) this.follow(this.lead);
  }
  farthest(k) {
    const run = this.runs[0],
      c = run.P.get(page.bodies[k].place);
    let most = 0;
    for (let i = 0; i < run.n; i += 7)
      most = Math.max(
        most,
        Math.hypot(
          ...[0, 1, 2].map(j => (c[j].fixed ? c[j].value : c[j].x[i]) - this.middle.getComponent(j)),
        ),
      );
    return most;
  }
  view(name) {
    const d =
      { x: new Vector3(1, 0, 0), y: new Vector3(0, -1, 0), z: new Vector3(0, 0, 1) }[name] || this.home();
    if (Math.abs(d.dot(this.up)) > 0.99)
      d.addScaledVector(
        Math.abs(this.up.x) < 0.5 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0),
        -0.01,
      ).normalize();
    this.controls.enableRotate = !this.planar || name !== 'home';
    const about = this.followed != null ? this.last : this.middle;
    this.controls.target.copy(about);
    this.camera.position
      .copy(about)
      .addScaledVector(
        d,
        this.planar
          ? 10 * this.reach
          : this.reach / Math.sin((0.5 * 38 * Math.PI) / 180) / Math.min(1, this.aspect || 1),
      );
    this.camera.zoom = 1;
    this.resize();
    this.controls.update();
    this.dirty = true;
  }
  home() {
    if (this.planar) return vec(page.normal);
    const u = this.up,
      side =
        Math.abs(u.z) > 0.9
          ? new Vector3(0.45, -1 * Math.sign(u.z), 0)
          : Math.abs(u.y) > 0.9
            ? new Vector3(0.45, 0, 1)
            : new Vector3(0, 0.45, 1);
    return side.normalize().addScaledVector(u, 0.42).normalize();
  }
  resize() {
    const w = this.canvas.parentElement.clientWidth,
      h = this.canvas.parentElement.clientHeight;
    if (!w || !h) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(w, h, false);
    this.aspect = w / h;
    if (this.planar) {
      const r = this.reach,
        y = this.aspect < 1 ? r / this.aspect : r;
      Object.assign(this.camera, {
        left: -y * this.aspect,
        right: y * this.aspect,
        top: y,
        bottom: -y,
        near: -100 * r,
        far: 100 * r,
      });
    } else this.camera.aspect = this.aspect;
    this.camera.updateProjectionMatrix();
    this.w = w;
    this.h = h;
    this.dirty = true;
  }
  follow(k) {
    this.followed = k;
    this.middle3 ||= new Vector3();
    if (k !== null) {
      this.last = this.runs[0].place(page.bodies[k].place, this.middle3).clone();
      this.view('home');
    } else {
      this.view('home');
    }
  }
}
