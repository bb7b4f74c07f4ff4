// What a pointer does in the drawing of the live page: it drags tips and pushers, or changes the scene.

class Live extends Timeline {
  // Editing shows the start of the scene in one view.
  setEditing(isOn) {
    this.editButton.setAttribute('aria-pressed', isOn);
    if (!isOn) {
      this.editor.show(undefined);
      this.isOverlaid = this.wasOverlaid && this.data.runs.length > 1;
      this.resize();
      return;
    }
    this.goTo(0);
    this.wasOverlaid = this.isOverlaid;
    // Beside the drawing, or right below it.
    if (innerWidth > 900) document.querySelector('.side').prepend(this.editor.box); else this.figure.after(this.editor.box);
    this.keeper.ask(({ scenario }) => {
      this.editor.show(scenario);
      [this.isOverlaid, this.follows] = [this.data.runs.length > 1, false];
      this.resize();
    });
  }

  // An edited scene is seen anew as a whole only when it is asked for.
  resetView() {
    super.resetView();
    if (this.editor?.isOn) this.whole = this.extentOfAll();
  }

  // While something is dragged the view stands still.
  boxOf(loads) {
    if (!this.still) return super.boxOf(loads);
    const [{ run }] = loads;
    if (!this.still.has(run.label)) this.still.set(run.label, super.boxOf(loads));
    return this.still.get(run.label);
  }

  // The view of a run.
  scaleIn(at) {
    return this.scaleOf(this.followed(this.isOverlaid ? this.states : [this.states[at]], this.states), this.grid.width, this.grid.height);
  }

  // Tips of a run, at rest where they are free.
  tipsOf(at) {
    const state = this.states[at];
    return this.data.springs.map(([, ends], i) => (Number.isNaN(state.tips[i][0]) ? this.placed(state, ends[2], ends[3]) : state.tips[i]));
  }

  // Number of the view that the pointer is on, or of one that it came from, and the place in it (px).
  pointAt(event, from) {
    const box = this.canvas.getBoundingClientRect();
    const [px, py] = [event.clientX - box.left, event.clientY - box.top];
    const { columns, width, height } = this.grid;
    const on = Math.floor(py / height) * columns + Math.min(Math.floor(px / width), columns - 1);
    const view = from ?? Math.min(Math.max(on, 0), this.isOverlaid ? 0 : this.data.runs.length - 1);
    return { view, x: px - (view % columns) * width, y: py - Math.floor(view / columns) * height };
  }

  nearest({ view, x, y }) {
    if (!this.now || this.states?.length !== this.data.runs.length) return undefined;
    const scale = this.scaleIn(view);
    const away = (place) => { const [px, py] = scale.to(...place); return Math.hypot(px - x, py - y); };
    const tips = this.tipsOf(view).map((place, i) => ({ spring: this.data.springs[i][0], distance: away(place) }));
    const pushers = this.scene.pushers.map((number) => ({ pusher: number, distance: this.distanceTo(number, scale, x, y) }));
    const [found] = [...tips, ...pushers].filter(({ distance }) => distance < NEAR).sort((a, b) => a.distance - b.distance);
    return found;
  }

  // Nothing within a pusher, half the reach beside its edge, and else infinite (px).
  distanceTo(number, scale, x, y) {
    const obstacle = this.data.obstacles[number];
    const path = new Path2D();
    this.trace(path, obstacle.outline, this.poseOf(obstacle), scale);
    this.tester ??= element('canvas', {}).getContext('2d');
    this.tester.lineWidth = NEAR;
    if (this.tester.isPointInPath(path, x, y)) return 0;
    return this.tester.isPointInStroke(path, x, y) ? NEAR / 2 : Infinity;
  }

  // Where the hand is (m): at the pointer, and on a pusher as far beside it as it was taken.
  target() {
    const { pointer: { view, x, y }, offset } = this.grab;
    const [wx, wy] = this.scaleIn(view).from(x, y);
    return [wx + offset[0], wy + offset[1]];
  }

  // The runs go back to the time that is shown; the course so far stays in view, pale.
  rewind() {
    if (this.time >= this.course.end) return;
    this.hold();
    const time = this.course.before(this.time);
    this.course = this.course.until(time);
    [this.goal, this.time, this.isLive] = [time, time, true];
    this.send({ do: 'go-to', time_s: time });
    this.showCourse();
  }

  take(event) {
    const pointer = this.pointAt(event);
    if (this.editor.isOn) {
      this.still = new Map();
      const isTaken = this.editor.take(this.scaleIn(0), pointer.x, pointer.y);
      if (!isTaken) this.still = undefined;
      return isTaken;
    }
    const found = this.nearest(pointer);
    if (!found) return false;
    if (this.scene.ants_on && found.spring !== undefined) {
      told('The ants move the tips.', { acts: [['Switch them off', () => this.change({ do: 'ants', on: false })]] });
      return false;
    }
    this.still = new Map();
    const handle = found.spring === undefined ? { pusher: found.pusher } : { spring: found.spring };
    this.grab = { pointer, handle, offset: [0, 0], wasPlaying: this.isPlaying };
    if (found.pusher !== undefined) {
      const obstacle = this.data.obstacles[found.pusher];
      const [x, y] = this.target();
      const pose = this.poseOf(obstacle);
      this.grab.offset = [pose.x - x, pose.y - y];
      // The path that was given ends here.
      obstacle.path.splice(1, Infinity, obstacle.path[0]);
    }
    this.rewind();
    this.send({ do: 'drag', handle, to: this.target() });
    this.send({ do: 'play' });
    [this.isPlaying, this.isLive] = [true, true];
    this.wake();
    this.canvas.style.cursor = 'grabbing';
    return true;
  }

  carry(event) {
    if (this.editor.grabbed) {
      const { x, y } = this.pointAt(event, 0);
      this.editor.carry(x, y);
      return true;
    }
    if (!this.grab) {
      const near = () => (this.editor.isOn ? this.editor.nearest(this.scaleIn(0), this.pointAt(event).x, this.pointAt(event).y) : this.nearest(this.pointAt(event)));
      if (!event.buttons) this.canvas.style.cursor = near() ? 'pointer' : '';
      return false;
    }
    this.grab.pointer = this.pointAt(event, this.grab.pointer.view);
    this.send({ do: 'drag', handle: this.grab.handle, to: this.target() });
    return true;
  }

  letGo() {
    if (this.editor.grabbed) this.editor.letGo();
    const { grab } = this;
    [this.grab, this.still] = [undefined, undefined];
    if (!grab) return;
    this.send({ do: 'drop' });
    if (!grab.wasPlaying) this.pause();
    this.keeper.changed();
    this.canvas.style.cursor = '';
  }

  // Lets go of the tip under the pointer.
  release(event) {
    const { spring } = (!this.editor.isOn && this.nearest(this.pointAt(event))) || {};
    if (spring === undefined) return;
    this.rewind();
    this.send({ do: 'release', spring });
    this.keeper.changed();
  }

  // The path of the run before the last change, pale.
  drawTrail(pen, state, base, scale, strength) {
    const before = this.earlier?.runs[this.earlier.labels.indexOf(state.run.label)];
    if (before && this.factor === 1) {
      pen.strokeStyle = this.colorOf(state.run);
      pen.globalAlpha = 0.35;
      pen.setLineDash([3, 3]);
      pen.beginPath();
      before.x.forEach((x, i) => pen.lineTo(...scale.to(x, before.y[i])));
      pen.stroke();
      pen.setLineDash([]);
      pen.globalAlpha = 1;
    }
    super.drawTrail(pen, state, base, scale, strength);
  }

  drawView(pen, shown, states, width, height) {
    super.drawView(pen, shown, states, width, height);
    const scale = this.scaleOf(this.followed(shown, states), width, height);
    if (this.editor.isOn) this.editor.draw(pen, scale);
    else if (this.grab) this.drawHand(pen, shown, scale);
  }

  // The soft hold of the hand, and the force that it takes on each run (N).
  drawHand(pen, shown, scale) {
    const { spring, pusher } = this.grab.handle;
    const at = this.data.springs.findIndex(([number]) => number === spring);
    const sum = (contacts) => contacts.filter(([, , , , obstacle]) => obstacle === pusher).reduce(([x, y], [, , fx, fy]) => [x + fx, y + fy], [0, 0]);
    const forces = shown.map((state) => (spring === undefined ? Math.hypot(...sum(state.contacts)) : state.pulls[at] || 0));
    const from = spring === undefined ? Object.values(this.poseOf(this.data.obstacles[pusher])) : shown[0].tips[at];
    const [hx, hy] = scale.to(...this.target());
    pen.strokeStyle = pen.fillStyle = this.look.ink;
    pen.lineWidth = 1.5;
    pen.setLineDash([2, 2]);
    pen.beginPath();
    if (!Number.isNaN(from[0])) { pen.moveTo(...scale.to(from[0], from[1])); pen.lineTo(hx, hy); }
    pen.stroke();
    pen.setLineDash([]);
    pen.beginPath();
    pen.arc(hx, hy, 4, 0, 2 * Math.PI);
    pen.fill();
    write(pen, `hand ${forces.map((force) => withPrefix(force, 'N')).join(', ')}`, hx + 12, hy - 10, 'left', this.look.ink, '600 13px');
    this.canvas.dataset.force = forces[0];
  }

  draw() {
    super.draw();
    if (this.grab && this.states) this.send({ do: 'drag', handle: this.grab.handle, to: this.target() });
  }

  // What the page says of itself, for the reader and for programs.
  tell(states) {
    const { now, server, canvas } = this;
    const text = withPrefix(this.data.largest_pull, 'N');
    const place = this.signs.querySelector('.ramp')?.nextSibling;
    if (place && place.textContent !== text) place.textContent = text;
    this.playButton.textContent = this.isPlaying ? 'Pause' : 'Play';
    this.clock.textContent = `${now.time_s.toFixed(3)} of ${this.lasts.toFixed(2)} s`;
    this.track.max = this.lasts;
    this.track.value = Math.min(this.time, this.lasts);
    this.track.style.setProperty('--done', `${100 * Math.min(this.course.end / this.lasts, 1)}%`);
    const failed = server.lanes.flatMap(({ status, cause }, i) => (status === 'ok' ? [] : [`${this.data.runs[i].label}: ${status}, ${cause}`]));
    const pace = this.pace === 1 ? '' : `at ${this.pace}× the scene lasts ${Number((this.lasts / this.pace).toPrecision(2))} s`;
    const share = this.busy === undefined ? '' : `computing takes ${Number((100 * this.busy).toPrecision(2))} % of the simulated time, ${this.recent.length} frames/s`;
    this.share.textContent = [...failed, pace, this.earlier && `pale: before ${this.earlier.before}`, share].filter(Boolean).join('; ');
    const scale = this.scaleIn(0);
    const pixels = (at) => scale.to(...at).map(Math.round);
    Object.assign(canvas.dataset, {
      time: now.time_s, end: this.course.end, before: this.earlier?.end ?? '', frame: server.frame, playing: this.isPlaying || server.is_playing, ended: server.has_ended,
      share: this.busy ?? '', fps: this.recent?.length ?? 0,
      poses: JSON.stringify(Object.fromEntries(states.map(({ run, x, y, heading }) => [run.label, [x, y, heading]]))),
      handles: JSON.stringify({ tips: this.tipsOf(0).map(pixels), pushers: now.pushers.map(pixels) }),
      grips: this.editor.isOn ? JSON.stringify(this.editor.grips.map(({ name, place: at }) => [name, ...pixels(at)])) : '',
    });
  }
}
