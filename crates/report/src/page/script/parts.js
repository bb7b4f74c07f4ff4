// The parts of a scene on a canvas: load, supports, springs, ants, obstacles and contacts at one instant.

// Springs from slack to the largest pull: light to dark on paper, dark to light on a dark page.
const RAMP = [[86, 180, 233], [0, 158, 115], [230, 159, 0], [213, 94, 0], [160, 20, 70]];

function rampColor(share) {
  const at = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1);
  const [a, b] = [RAMP[Math.floor(at)], RAMP[Math.min(Math.floor(at) + 1, RAMP.length - 1)]];
  return `rgb(${a.map((part, i) => Math.round(part + (at % 1) * (b[i] - part))).join(',')})`;
}

function turned(x, y, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [c * x - s * y, s * x + c * y];
}

// Of at most this many springs all are numbered.
const FEW_SPRINGS = 20;

class Parts {
  constructor(data) {
    this.data = data;
    this.time = data.opens_at;
  }

  get look() {
    return scheme.look;
  }

  colorOf(run) {
    return scheme.color(run.color);
  }

  // Adds the parts of an outline at a pose to the path of the pen.
  trace(pen, outline, pose, scale) {
    for (const part of outline) {
      if (part.disc) {
        const [x, y] = scale.to(...this.placed(pose, part.disc[0], part.disc[1]));
        const radius = part.disc[2] * scale.per;
        pen.moveTo(x + radius, y);
        pen.arc(x, y, radius, 0, 2 * Math.PI);
        continue;
      }
      (part.polygon || part.polyline).forEach(([px, py], i) => {
        const [x, y] = scale.to(...this.placed(pose, px, py));
        if (i === 0) pen.moveTo(x, y); else pen.lineTo(x, y);
      });
      if (part.polygon) pen.closePath();
    }
  }

  // Pose of an obstacle now.
  poseOf(obstacle) {
    const { path } = obstacle;
    const { from, to, share } = placeIn(path.map((waypoint) => waypoint[0]), this.time);
    const [x, y, heading] = [1, 2, 3].map((i) => path[from][i] + share * (path[to][i] - path[from][i]));
    return { x, y, heading };
  }

  // Obstacles that stand still are hatched, those that move are grey, with their path.
  drawObstacles(pen, scale) {
    for (const obstacle of this.data.obstacles) {
      const pose = this.poseOf(obstacle);
      if (obstacle.path.length > 1) {
        pen.strokeStyle = this.look.soft;
        pen.lineWidth = 1;
        pen.setLineDash([2, 3]);
        pen.beginPath();
        obstacle.path.forEach(([, x, y], i) => (i ? pen.lineTo(...scale.to(x, y)) : pen.moveTo(...scale.to(x, y))));
        pen.stroke();
        pen.setLineDash([]);
      }
      const closed = obstacle.outline.filter((part) => !part.polyline);
      pen.beginPath();
      this.trace(pen, closed, pose, scale);
      pen.fillStyle = obstacle.path.length > 1 ? this.look.faint : this.hatching(pen);
      pen.fill('nonzero');
      pen.beginPath();
      this.trace(pen, obstacle.outline, pose, scale);
      pen.strokeStyle = this.look.soft;
      pen.lineWidth = 1.8;
      pen.stroke();
    }
  }

  // Lines of 45 degrees as a pattern.
  hatching(pen) {
    const size = 8;
    const tile = element('canvas', { width: size, height: size });
    const inner = tile.getContext('2d');
    inner.strokeStyle = this.look.soft;
    inner.lineWidth = 0.7;
    inner.beginPath();
    for (const shift of [-size, 0, size]) { inner.moveTo(shift - 1, size + 1); inner.lineTo(shift + size + 1, -1); }
    inner.stroke();
    return pen.createPattern(tile, 'repeat');
  }

  // A dot where the load touches, and an arrow of the force on the load.
  drawContacts(pen, state, scale) {
    const unit = this.data.radius * scale.per;
    const color = scheme.isDark ? '#c79ae0' : '#7b3fa0';
    for (const [px, py, fx, fy] of state.contacts) {
      if (Number.isNaN(px)) continue;
      const [x, y] = scale.to(px, py);
      const force = Math.hypot(fx, fy);
      const share = force / (this.data.force_unit || 1);
      if (share * unit > 3) this.arrow(pen, x, y, fx / force, -fy / force, unit * Math.min(share, 1), color, 2.5, share > 1.001);
      pen.fillStyle = color;
      pen.beginPath();
      pen.arc(x, y, 4, 0, 2 * Math.PI);
      pen.fill();
    }
  }

  drawOutline(pen, state, scale, color, dash) {
    const [x, y] = scale.to(state.x, state.y);
    const front = this.data.front * scale.per;
    pen.strokeStyle = color;
    pen.lineWidth = 1.5;
    pen.setLineDash(dash);
    pen.beginPath();
    this.trace(pen, this.data.outline, state, scale);
    pen.moveTo(x, y);
    pen.lineTo(x + front * Math.cos(state.heading), y - front * Math.sin(state.heading));
    pen.stroke();
    pen.setLineDash([]);
  }

  drawLoad(pen, state, scale) {
    pen.fillStyle = this.colorOf(state.run);
    pen.globalAlpha = 0.14;
    pen.beginPath();
    this.trace(pen, this.data.outline, state, scale);
    pen.fill();
    pen.globalAlpha = 1;
    this.drawOutline(pen, state, scale, this.colorOf(state.run), []);
  }

  placed(state, x, y) {
    const [dx, dy] = turned(x, y, state.heading);
    return [state.x + dx, state.y + dy];
  }

  // Free springs, at rest in the load's frame.
  drawFree(pen, state, scale) {
    pen.strokeStyle = this.look.soft;
    pen.globalAlpha = 0.55;
    pen.lineWidth = 1.2;
    pen.beginPath();
    this.data.springs.forEach(([, ends], i) => {
      if (!Number.isNaN(state.tips[i][0])) return;
      pen.moveTo(...scale.to(...this.placed(state, ends[0], ends[1])));
      pen.lineTo(...scale.to(...this.placed(state, ends[2], ends[3])));
    });
    pen.stroke();
    pen.globalAlpha = 1;
  }

  drawHeld(pen, state, scale) {
    pen.lineWidth = Math.min(Math.max(0.12 * this.data.radius * scale.per, 2), 5);
    this.data.springs.forEach(([, ends], i) => {
      const [tx, ty] = state.tips[i];
      if (Number.isNaN(tx)) return;
      const pull = state.pulls[i];
      pen.strokeStyle = pen.fillStyle = Number.isNaN(pull) ? this.look.soft : rampColor(pull / (this.data.largest_pull || 1));
      const [x, y] = scale.to(tx, ty);
      pen.beginPath();
      pen.moveTo(...scale.to(...this.placed(state, ends[0], ends[1])));
      pen.lineTo(x, y);
      pen.stroke();
      pen.beginPath();
      pen.arc(x, y, pen.lineWidth, 0, 2 * Math.PI);
      pen.fill();
    });
  }

  // The number of each spring beside its middle: of all springs where they are few, else of attached ones.
  drawNumbers(pen, state, scale) {
    const isAttached = (i) => !Number.isNaN(state.tips[i][0]);
    const shown = this.data.springs.map((_, i) => i).filter((i) => this.data.springs.length <= FEW_SPRINGS || isAttached(i));
    if (shown.length > 3 * FEW_SPRINGS) return;
    pen.lineWidth = 3;
    pen.strokeStyle = this.look.back;
    for (const i of shown) {
      const [number, ends] = this.data.springs[i];
      const [rx, ry] = scale.to(...this.placed(state, ends[0], ends[1]));
      const [tx, ty] = isAttached(i) ? scale.to(...state.tips[i]) : scale.to(...this.placed(state, ends[2], ends[3]));
      const length = Math.hypot(tx - rx, ty - ry);
      const [ax, ay] = length > 1 ? [(ry - ty) / length, (tx - rx) / length] : [0, -1];
      const [x, y] = [(rx + tx) / 2 + 11 * ax, (ry + ty) / 2 + 11 * ay + 4];
      pen.font = '12px system-ui, "DejaVu Sans", Verdana, sans-serif';
      pen.textAlign = 'center';
      pen.strokeText(number, x, y);
      write(pen, number, x, y, 'center', isAttached(i) ? this.look.ink : this.look.soft, '12px');
    }
  }

  // Slip of each support by the load's twist; friction is mu N against it, Eq. (13), and not known where it sticks.
  drawSupports(pen, state, scale) {
    // Many supports are drawn finer, so that the load is seen between them.
    const fine = Math.min(1, 2 / Math.sqrt(this.data.supports.length));
    const size = Math.max(fine * Math.min(Math.max(0.09 * this.data.radius * scale.per, 2), 6), 1.2);
    const largest = Math.max(...this.data.supports.map((support) => support[2]));
    for (const [ox, oy, limit] of this.data.supports) {
      if (!(limit > 0)) continue;
      const [ax, ay] = turned(ox, oy, state.heading);
      const [x, y] = scale.to(state.x + ax, state.y + ay);
      const [sx, sy] = [state.vx - state.rate * ay, state.vy + state.rate * ax];
      const speed = Math.hypot(sx, sy);
      if (!(speed > state.run.sticks_below)) {
        pen.fillStyle = this.look.soft;
        pen.fillRect(x - size, y - size, 2 * size, 2 * size);
        continue;
      }
      const [ux, uy] = [sx / speed, -sy / speed];
      const share = speed / (this.data.slip_unit || speed);
      const unit = this.data.radius * scale.per;
      this.arrow(pen, x, y, ux, uy, unit * Math.min(share, 1), '#009e73', 2 * fine, share > 1, fine);
      this.arrow(pen, x, y, -ux, -uy, 0.8 * fine * unit * limit / largest, '#cc3311', 3 * fine, false, fine);
      pen.fillStyle = '#e69f00';
      pen.beginPath();
      pen.arc(x, y, size, 0, 2 * Math.PI);
      pen.fill();
    }
  }

  arrow(pen, x, y, ux, uy, length, color, width, isCut, fine = 1) {
    const head = Math.min(8 * fine, 0.6 * length);
    const [ex, ey] = [x + ux * length, y + uy * length];
    pen.strokeStyle = pen.fillStyle = color;
    pen.lineWidth = width;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(ex - ux * head, ey - uy * head);
    pen.stroke();
    for (const back of isCut ? [0, 1.1 * head] : [0]) {
      const [hx, hy] = [ex - ux * back, ey - uy * back];
      pen.beginPath();
      pen.moveTo(hx, hy);
      pen.lineTo(hx - ux * head - 0.5 * uy * head, hy - uy * head + 0.5 * ux * head);
      pen.lineTo(hx - ux * head + 0.5 * uy * head, hy - uy * head - 0.5 * ux * head);
      pen.fill();
    }
  }

  // The mandibles are where the ant is; its body lies behind them.
  drawAnts(pen, state, scale, color) {
    const length = Math.max(0.75 * this.data.radius * scale.per, 9);
    for (const ant of state.ants) {
      const [x, y] = scale.to(ant.x, ant.y);
      pen.save();
      pen.translate(x, y);
      pen.rotate(-ant.heading);
      pen.strokeStyle = pen.fillStyle = color || (ant.holds ? (scheme.isDark ? '#e08a50' : '#8a3800') : this.look.soft);
      pen.lineWidth = 1.2;
      for (const [at, along, across] of [[-0.2, 0.15, 0.12], [-0.48, 0.15, 0.09], [-0.82, 0.22, 0.16]]) {
        pen.beginPath();
        pen.ellipse(at * length, 0, along * length, across * length, 0, 0, 2 * Math.PI);
        if (ant.holds) pen.fill(); else pen.stroke();
      }
      pen.beginPath();
      for (const side of [-1, 1]) {
        pen.moveTo(-0.08 * length, side * 0.05 * length);
        pen.lineTo(0, side * 0.02 * length);
        for (const leg of [-0.38, -0.48, -0.58]) {
          pen.moveTo(leg * length, side * 0.08 * length);
          pen.lineTo((leg + 0.9 * (leg + 0.48)) * length, side * 0.32 * length);
        }
      }
      pen.stroke();
      pen.restore();
    }
    if (this.data.has_ants) return;
    pen.strokeStyle = this.look.ink;
    pen.lineWidth = 1.2;
    for (const [x, y] of state.tips) {
      if (Number.isNaN(x)) continue;
      pen.beginPath();
      pen.arc(...scale.to(x, y), 6, 0, 2 * Math.PI);
      pen.stroke();
    }
  }
}
