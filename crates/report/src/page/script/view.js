// One view a run, or one for all: what is seen at a time, how large, and differences magnified.

const ZOOM = { least: 1 / 64, most: 1e5, step: 1.5 };

class View extends Parts {
  constructor(data) {
    super(data);
    this.isOverlaid = false;
    this.follows = true;
    this.numbers = true;
    // Number of the run from which the others differ, and the factor of the differences as drawn.
    this.base = 0;
    this.factor = 1;
    this.whole = this.extentOfAll();
    this.reach = this.reachOfSprings();
    this.resetView();
  }

  resetView() {
    this.zoom = 1;
    // Of the middle of the view (m).
    this.shift = [0, 0];
  }

  // Whether the runs meet the same tips, so that their poses can be compared at each time.
  get isShared() {
    return this.data.stages.length === 1;
  }

  extentOfAll() {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    const add = (x, y, r) => {
      if (Number.isNaN(x + y)) return;
      box[0] = Math.min(box[0], x - r); box[1] = Math.min(box[1], y - r);
      box[2] = Math.max(box[2], x + r); box[3] = Math.max(box[3], y + r);
    };
    for (const run of this.data.runs) run.x.forEach((x, i) => add(x, run.y[i], 1.3 * this.data.radius));
    for (const stage of this.data.stages) for (const [x, y] of stage.tips) x.forEach((value, i) => add(value, y[i], 0));
    if (this.data.nest) add(...this.data.nest);
    for (const { path } of this.data.obstacles) if (path.length > 1) for (const [, x, y] of path) add(x, y, 0.5 * this.data.radius);
    // Of walls as much as lies beside the rest.
    const beside = Math.max(8 * this.data.radius, 0.6 * Math.max(box[2] - box[0], box[3] - box[1]));
    const most = [box[0] - beside, box[1] - beside, box[2] + beside, box[3] + beside];
    for (const obstacle of this.data.obstacles) {
      const [, x, y, heading] = obstacle.path[0];
      for (const [px, py, r] of obstacle.outline.flatMap((part) => (part.disc ? [part.disc] : (part.polygon || part.polyline).map(([a, b]) => [a, b, 0])))) {
        const [wx, wy] = this.placed({ x, y, heading }, px, py);
        const inside = (value, low, high) => Math.min(Math.max(value, low), high);
        add(inside(wx - r, most[0], most[2]), inside(wy - r, most[1], most[3]), 0);
        add(inside(wx + r, most[0], most[2]), inside(wy + r, most[1], most[3]), 0);
      }
    }
    return box;
  }

  // How far around a load that is followed the view goes.
  reachOfSprings() {
    let reach = 2.2 * this.data.radius;
    for (const [, ends] of this.data.springs) reach = Math.max(reach, Math.hypot(ends[2], ends[3]));
    return 1.7 * reach;
  }

  // What is seen around loads that are followed: the springs of the first, and all of the others.
  around([first, ...others]) {
    const box = [first.x - this.reach, first.y - this.reach, first.x + this.reach, first.y + this.reach];
    const room = 1.6 * this.data.radius;
    for (const { x, y } of others.filter((state) => Number.isFinite(state.x + state.y))) {
      box[0] = Math.min(box[0], x - room); box[1] = Math.min(box[1], y - room);
      box[2] = Math.max(box[2], x + room); box[3] = Math.max(box[3], y + room);
    }
    return box;
  }

  // What is seen of the world: the first of the loads is the one to follow.
  boxOf(loads) {
    return this.follows ? this.around(loads) : this.whole;
  }

  // World to view: equal along both axes, y upwards.
  scaleOf(loads, width, height) {
    const box = this.boxOf(loads);
    const fitted = Math.min((width - 24) / (box[2] - box[0]), (height - 64) / (box[3] - box[1])) || 1;
    const per = this.per = fitted * this.zoom;
    const [x, y] = [(box[0] + box[2]) / 2 + this.shift[0], (box[1] + box[3]) / 2 + this.shift[1]];
    return {
      per,
      to: (wx, wy) => [width / 2 + per * (wx - x), height / 2 + 12 - per * (wy - y)],
      from: (px, py) => [x + (px - width / 2) / per, y - (py - height / 2 - 12) / per],
    };
  }

  // Zooms so that what is seen at a place of a view (px from its middle) stays there.
  zoomBy(factor, x = 0, y = 0) {
    const zoom = Math.min(Math.max(this.zoom * factor, ZOOM.least), ZOOM.most);
    const change = (1 - this.zoom / zoom) / this.per;
    this.shift = [this.shift[0] + x * change, this.shift[1] - y * change];
    this.zoom = zoom;
    this.draw();
  }

  // Moves what is seen by so many px.
  panBy(x, y) {
    this.shift = [this.shift[0] - x / this.per, this.shift[1] + y / this.per];
    this.draw();
  }

  // Pose, speed, tips and ants of a run now.
  stateOf(run) {
    const place = placeIn(run.times, this.time);
    const stage = this.data.stages[run.stage];
    const staged = placeIn(stage.times, this.time);
    const tips = stage.tips.map(([x, y]) => [between(x, staged), between(y, staged)]);
    const ants = stage.ants.map(([x, y, heading]) => {
      const [from, to] = [heading[staged.from], heading[staged.to]];
      const turn = Math.atan2(Math.sin(to - from), Math.cos(to - from));
      return { x: between(x, staged), y: between(y, staged), heading: from + staged.share * turn, holds: from > 3 * Math.PI };
    });
    return {
      run, tips, ants,
      x: between(run.x, place), y: between(run.y, place), heading: between(run.heading, place),
      // What moves is told by the instant before, as tips hold or not.
      vx: run.vx[place.from], vy: run.vy[place.from], rate: run.turn_rate[place.from],
      pulls: run.pulls.map((series) => between(series, place)),
      contacts: run.contacts.map((series) => series.map((values) => between(values, place))),
      place,
    };
  }

  // A value of a run as drawn: away from the base by a multiple of the difference.
  drawn(value, base) {
    return base + this.factor * (value - base);
  }

  // A state as drawn. Contacts stay where they are measured, and are drawn with unchanged poses only.
  magnified(state, base) {
    if (this.factor === 1 || state === base) return state;
    const [x, y, heading] = ['x', 'y', 'heading'].map((name) => this.drawn(state[name], base[name]));
    return { ...state, x, y, heading, contacts: [] };
  }

  // Edge displacement of a run from the base (m).
  apart(state, base) {
    return Math.hypot(state.x - base.x, state.y - base.y) + this.data.radius * Math.abs(state.heading - base.heading);
  }

  drawAll(canvas, states) {
    const pen = canvas.getContext('2d');
    const { columns, width, height } = this.grid;
    pen.fillStyle = this.look.back;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    const views = this.isOverlaid ? [states] : states.map((state) => [state]);
    views.forEach((shown, at) => {
      pen.save();
      pen.translate((at % columns) * width, Math.floor(at / columns) * height);
      pen.beginPath();
      pen.rect(0, 0, width, height);
      pen.clip();
      this.drawView(pen, shown, states, width, height);
      pen.restore();
    });
  }

  // The loads that one view follows: at the same tips all stay in view, others are followed one by one.
  followed(shown, states) {
    const base = states[this.base];
    return this.isShared ? [base, ...states.map((state) => this.magnified(state, base))] : shown;
  }

  drawView(pen, shown, states, width, height) {
    const base = states[this.base];
    const drawn = shown.map((state) => this.magnified(state, base));
    const scale = this.scaleOf(this.followed(shown, states), width, height);
    this.drawNest(pen, scale);
    this.drawObstacles(pen, scale);
    // Below all else, as it may not hide springs or ants.
    if (this.follows) this.drawMap(pen, shown, width, height);
    for (const state of shown) this.drawTrail(pen, state, base, scale, this.follows ? 0.35 : 0.6);
    const top = drawn[drawn.length - 1];
    this.drawFree(pen, top, scale);
    if (!this.isOverlaid && top.run !== base.run) this.drawOutline(pen, base, scale, this.look.soft, [4, 3]);
    for (const state of drawn) {
      this.drawLoad(pen, state, scale);
      this.drawHeld(pen, state, scale);
      if (!this.isOverlaid) this.drawSupports(pen, state, scale);
      this.drawContacts(pen, state, scale);
    }
    if (this.numbers) this.drawNumbers(pen, top, scale);
    if (this.isShared) this.drawAnts(pen, top, scale); else for (const state of shown) this.drawAnts(pen, state, scale, this.isOverlaid && this.colorOf(state.run));
    this.drawScaleBar(pen, scale, width, height);
    this.drawTitle(pen, shown, base, width);
    pen.strokeStyle = this.look.faint;
    pen.strokeRect(0.5, 0.5, width - 1, height - 1);
  }

  drawNest(pen, scale) {
    if (!this.data.nest) return;
    const [x, y, radius] = this.data.nest;
    const [px, py] = scale.to(x, y);
    pen.strokeStyle = '#009e73';
    pen.fillStyle = '#009e7322';
    pen.lineWidth = 1.5;
    pen.setLineDash([4, 3]);
    pen.beginPath();
    pen.arc(px, py, Math.max(radius * scale.per, 4), 0, 2 * Math.PI);
    pen.fill();
    pen.stroke();
    pen.setLineDash([]);
    write(pen, 'nest', px, py - Math.max(radius * scale.per, 4) - 5, 'center', scheme.isDark ? '#5fd0a8' : '#00754f');
  }

  drawTrail(pen, { run, place }, base, scale, strength) {
    const origin = this.factor === 1 ? run : base.run;
    const path = (from, to) => {
      pen.beginPath();
      for (let i = from; i <= to; i++) {
        const [x, y] = scale.to(this.drawn(run.x[i], origin.x[i]), this.drawn(run.y[i], origin.y[i]));
        if (i === from) pen.moveTo(x, y); else pen.lineTo(x, y);
      }
      pen.stroke();
    };
    pen.lineJoin = 'round';
    pen.strokeStyle = this.look.faint;
    pen.lineWidth = 1;
    path(place.from, run.times.length - 1);
    pen.strokeStyle = this.colorOf(run);
    pen.globalAlpha = strength;
    pen.lineWidth = 1.8;
    path(0, place.from);
    pen.globalAlpha = 1;
  }

  // The whole way, small, in a corner.
  drawMap(pen, shown, width, height) {
    const side = Math.min(96, 0.28 * width);
    const [left, top] = [width - side - 8, height - side - 8];
    const box = this.whole;
    const per = (side - 10) / Math.max(box[2] - box[0], box[3] - box[1]) || 1;
    const to = (x, y) => [left + side / 2 + per * (x - (box[0] + box[2]) / 2), top + side / 2 - per * (y - (box[1] + box[3]) / 2)];
    pen.fillStyle = this.look.back;
    pen.fillRect(left, top, side, side);
    pen.lineWidth = 1;
    pen.strokeStyle = this.look.faint;
    pen.strokeRect(left + 0.5, top + 0.5, side - 1, side - 1);
    if (this.data.obstacles.length) {
      pen.save();
      pen.beginPath();
      pen.rect(left, top, side, side);
      pen.clip();
      pen.strokeStyle = this.look.soft;
      for (const obstacle of this.data.obstacles) {
        pen.beginPath();
        this.trace(pen, obstacle.outline, this.poseOf(obstacle), { per, to });
        pen.stroke();
      }
      pen.restore();
    }
    if (this.data.nest) {
      pen.strokeStyle = '#009e73';
      pen.beginPath();
      pen.arc(...to(this.data.nest[0], this.data.nest[1]), Math.max(per * this.data.nest[2], 2), 0, 2 * Math.PI);
      pen.stroke();
    }
    for (const { run, x, y } of shown) {
      pen.strokeStyle = this.look.soft;
      pen.beginPath();
      const every = Math.max(1, Math.floor(run.times.length / 600));
      for (let i = 0; i < run.times.length; i += every) pen.lineTo(...to(run.x[i], run.y[i]));
      pen.stroke();
      pen.fillStyle = this.colorOf(run);
      pen.beginPath();
      pen.arc(...to(x, y), 3, 0, 2 * Math.PI);
      pen.fill();
    }
  }

  drawScaleBar(pen, scale, width, height) {
    const length = niceBelow(0.22 * width / scale.per);
    const [x, y] = [12, height - 12];
    pen.strokeStyle = this.look.ink;
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(x, y - 4); pen.lineTo(x, y); pen.lineTo(x + length * scale.per, y); pen.lineTo(x + length * scale.per, y - 4);
    pen.stroke();
    write(pen, withPrefix(length, 'm').replace(/\.?0+ /, ' '), x, y - 8, 'left', this.look.soft);
    if (this.recorder) write(pen, `${this.time.toFixed(3)} s`, width / 2, y - 2, 'center', this.look.ink, '600 14px');
  }

  // Names of the runs, and how far they are apart: in the longest words that fit.
  drawTitle(pen, shown, base, width) {
    let [x, y] = [12, 22];
    for (const { run } of shown) {
      pen.font = '600 14px system-ui, "DejaVu Sans", Verdana, sans-serif';
      const wide = 18 + pen.measureText(run.label).width + 16;
      if (x > 12 && x + wide > width) [x, y] = [12, y + 20];
      pen.fillStyle = this.colorOf(run);
      pen.fillRect(x, y - 11, 12, 12);
      write(pen, run.label, x + 18, y, 'left', this.look.ink, '600 14px');
      x += wide;
    }
    const others = shown.filter((state) => state !== base);
    if (!others.length) return;
    const far = others.map((state) => withPrefix(this.apart(state, base), 'm'));
    const named = this.isOverlaid ? others.map((state, at) => `${state.run.label} ${far[at]}`) : far;
    const drawn = this.factor === 1 ? '' : `, drawn ×${this.factor}`;
    const words = [[`edge displacement from ${base.run.label}: ${named.join(', ')}${drawn}`], [`displacement from ${base.run.label}:`, `${named.join(', ')}${drawn}`],
      ['edge displacement', ...named.map((text) => `${text}${drawn}`)], far.map((text) => `${text}${drawn}`)];
    pen.font = '13px system-ui, "DejaVu Sans", Verdana, sans-serif';
    const fits = words.find((lines) => lines.every((line) => pen.measureText(line).width < width - 20)) || words.at(-1);
    fits.forEach((line, at) => write(pen, line, 12, y + 20 + 17 * at, 'left', this.look.soft));
  }
}
