// The course of a scene as the page has received it: frames by time, and the curves that they make.

const MOST_POINTS = 4000;
const QUANTITIES = [
  ['pull', 'largest pull', 'N'], ['force', 'largest force of an obstacle', 'N'], ['speed', 'edge speed', 'm/s'],
  ['kinetic', 'kinetic energy', 'J'], ['dissipated', 'energy dissipated', 'J'], ['apart', 'edge displacement from the first', 'm'],
];
const SERIES = ['times', 'x', 'y', ...QUANTITIES.map(([key]) => key)];

// Between two frames numbers go straight; what the later frame does not have stays as it was.
function blended(a, b, share) {
  if (Array.isArray(a)) return Array.isArray(b) && a.length === b.length ? a.map((value, i) => blended(value, b[i], share)) : a;
  return typeof a === 'number' && typeof b === 'number' ? a + share * (b - a) : a;
}

class Course {
  constructor(labels, radius) {
    this.labels = labels;
    this.radius = radius;
    this.frames = [];
    this.runs = labels.map(() => Object.fromEntries(SERIES.map((key) => [key, []])));
  }

  get times() {
    return this.runs[0].times;
  }

  get end() {
    return this.times.at(-1) ?? 0;
  }

  // Takes a frame in, unless its time was here already.
  add(frame) {
    if (this.frames.length && frame.time_s <= this.end) return false;
    this.frames.push(frame);
    const [first] = frame.lanes;
    this.runs.forEach((run, i) => {
      const { pose, twist, energy, pulls, contacts } = frame.lanes[i];
      const row = {
        times: frame.time_s, x: pose?.[0], y: pose?.[1],
        pull: Math.max(0, ...pulls.filter((pull) => pull !== null)), force: Math.max(0, ...contacts.map(([, , fx, fy]) => Math.hypot(fx, fy))),
        speed: twist ? Math.hypot(twist[0], twist[1]) + this.radius * Math.abs(twist[2]) : NaN,
        kinetic: energy?.[1], dissipated: energy?.[2],
        apart: pose && first.pose ? Math.hypot(pose[0] - first.pose[0], pose[1] - first.pose[1]) + this.radius * Math.abs(pose[2] - first.pose[2]) : NaN,
      };
      for (const key of SERIES) run[key].push(row[key] ?? NaN);
    });
    // Twice as coarse when there are too many.
    if (this.frames.length > MOST_POINTS) this.keep((_, i) => i % 2 === 0);
    return true;
  }

  // Keeps some of the instants.
  keep(isKept) {
    this.frames = this.frames.filter(isKept);
    for (const run of this.runs) for (const key of SERIES) run[key].splice(0, run[key].length, ...run[key].filter(isKept));
  }

  // The same course up to a time.
  until(time) {
    const cut = new Course(this.labels, this.radius);
    this.frames.filter((frame) => frame.time_s <= time).forEach((frame) => cut.add(frame));
    return cut;
  }

  // The last instant at or before a time.
  before(time) {
    return this.times[indexAt(this.times, time)] ?? 0;
  }

  // What is seen at a time, and its place among the instants.
  at(time) {
    const place = placeIn(this.times, time);
    const [from, to] = [this.frames[place.from], this.frames[place.to]];
    if (!(place.share > 0)) return { ...from, place };
    const ants = (a, b) => (a.length === b.length ? a.map((ant, i) => {
      const turn = b[i][2] - ant[2];
      return [...blended(ant.slice(0, 2), b[i].slice(0, 2), place.share), ant[2] + place.share * Math.atan2(Math.sin(turn), Math.cos(turn)), ant[3]];
    }) : a);
    return {
      place, time_s: time, pushers: blended(from.pushers, to.pushers, place.share),
      stages: from.stages.map((stage, i) => ({ tips: blended(stage.tips, to.stages[i].tips, place.share), ants: ants(stage.ants, to.stages[i].ants) })),
      lanes: from.lanes.map((lane, i) => ({
        ...lane,
        ...Object.fromEntries(['pose', 'twist', 'pulls', 'contacts', 'energy'].map((key) => [key, blended(lane[key], to.lanes[i][key], place.share)])),
      })),
    };
  }
}
