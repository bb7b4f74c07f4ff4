// What of a scene a pointer can take: points of its scenario file, as places of the world at the start.

// The value at some keys of a scenario, and all but the last of the keys.
const valueAt = (scene, at) => at.reduce((value, key) => value?.[key], scene);
const parentOf = (scene, at) => valueAt(scene, at.slice(0, -1));

function toWorld({ x, y, heading }, [px, py]) {
  const [dx, dy] = turned(px, py, heading);
  return [x + dx, y + dy];
}

function toBody({ x, y, heading }, [wx, wy]) {
  return turned(wx - x, wy - y, -heading);
}

const poseOfBody = ({ position_m: [x, y] = [0, 0], heading_rad: heading = 0 }) => ({ x, y, heading });

// Radius of a circle about the load that holds its outline (m).
function radiusOf(load) {
  if (load.radius_m !== undefined) return load.radius_m;
  const of = ({ disc, polygon, polyline, compound }) => (disc ? disc.radius_m : compound
    ? Math.max(...compound.parts.map((part) => Math.hypot(...(part.position_m || [0, 0])) + of(part.outline)))
    : Math.max(...(polygon || polyline).points_m.map((point) => Math.hypot(...point))));
  return of(load.outline);
}

// Grips of an outline: each corner, a point on each circle, and the place of each part.
function* outlineGrips(scene, at, pose, what) {
  const { disc, polygon, polyline, compound } = valueAt(scene, at);
  if (disc) yield radiusGrip([...at, 'disc', 'radius_m'], pose, disc.radius_m, what);
  for (const [kind, shape] of Object.entries({ polygon, polyline })) {
    for (const [i, point] of (shape?.points_m || []).entries()) {
      const key = [...at, kind, 'points_m', i];
      yield { kind: 'point', name: `${what}: point ${i}`, at: key, place: toWorld(pose, point), move: (to, place) => { parentOf(to, key)[i] = toBody(pose, place); } };
    }
  }
  for (const [i, part] of (compound?.parts || []).entries()) {
    const [own, key] = [poseOfBody(part), [...at, 'compound', 'parts', i]];
    const [x, y] = toWorld(pose, [own.x, own.y]);
    yield { kind: 'part', name: `${what}: part ${i}: place`, at: key, place: [x, y], move: (to, place) => { valueAt(to, key).position_m = toBody(pose, place); } };
    yield* outlineGrips(scene, [...key, 'outline'], { x, y, heading: pose.heading + own.heading }, `${what}: part ${i}`);
  }
}

function radiusGrip(at, pose, radius, what) {
  const move = (to, place) => { parentOf(to, at)[at.at(-1)] = Math.max(Math.hypot(...toBody(pose, place)), 1e-9); };
  return { kind: 'point', name: `${what}: radius`, at: at.slice(0, -1), place: toWorld(pose, [radius, 0]), move };
}

// Waypoints of tips and obstacles are [time, x, y, ...].
function* waypointGrips(waypoints, at, what) {
  for (const [k, [time, x, y]] of waypoints.entries()) {
    const key = [...at, k];
    const move = (to, place) => { valueAt(to, key).splice(1, 2, ...place); };
    yield { kind: 'waypoint', name: `${what}: waypoint ${k}, ${Number(time.toPrecision(4))} s`, at: key, place: [x, y], move };
  }
}

function* springGrips(scene, pose) {
  for (const [i, { root_m: root, bearing_rad: bearing, rest_length_m: length }] of scene.springs.entries()) {
    const at = ['springs', i];
    yield { kind: 'spring', name: `spring ${i}: root`, at, place: toWorld(pose, root), move: (to, place) => { to.springs[i].root_m = toBody(pose, place); } };
    if (!(length > 0)) continue;
    const tip = [root[0] + length * Math.cos(bearing), root[1] + length * Math.sin(bearing)];
    const move = (to, place) => {
      const [x, y] = toBody(pose, place);
      Object.assign(to.springs[i], { bearing_rad: Math.atan2(y - root[1], x - root[0]), rest_length_m: Math.hypot(x - root[0], y - root[1]) });
    };
    yield { kind: 'spring', name: `spring ${i}: tip at rest`, at, place: toWorld(pose, tip), move };
  }
}

// An obstacle that moves is taken by its waypoints, another one by its origin, or by its middle where that is far from it.
function* obstacleGrips(scene) {
  for (const [i, obstacle] of (scene.obstacles || []).entries()) {
    const at = ['obstacles', i];
    const [, x, y, heading] = obstacle.path?.waypoints[0] || [];
    const pose = obstacle.path ? { x, y, heading } : poseOfBody(obstacle);
    yield* outlineGrips(scene, [...at, 'outline'], pose, obstacle.name);
    if (obstacle.path) { yield* waypointGrips(obstacle.path.waypoints, [...at, 'path', 'waypoints'], obstacle.name); continue; }
    const { points_m: points } = obstacle.outline.polyline || obstacle.outline.polygon || {};
    const middle = points ? [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length) : [0, 0];
    const move = (to, place) => {
      const [dx, dy] = turned(...middle, pose.heading);
      to.obstacles[i].position_m = [place[0] - dx, place[1] - dy];
    };
    yield { kind: 'obstacle', name: `${obstacle.name}: place`, at, place: toWorld(pose, middle), move };
  }
}

// All grips of a scenario; of those at one place the first is taken.
function gripsOf(scene) {
  const { load, ground, drive } = scene;
  const pose = poseOfBody(load);
  const tips = (drive.paths || []).flatMap((path, p) => [...waypointGrips(path.waypoints, ['drive', 'paths', p, 'waypoints'], `spring ${path.spring}`)]);
  const supports = ground.supports.map(({ offset_m: offset }, i) => ({
    kind: 'support', name: `support ${i}`, at: ['ground', 'supports', i], place: toWorld(pose, offset),
    move: (to, place) => { to.ground.supports[i].offset_m = toBody(pose, place); },
  }));
  const nest = drive.nest_position_m && { kind: 'nest', name: 'nest', at: ['drive'], place: drive.nest_position_m, move: (to, place) => { to.drive.nest_position_m = place; } };
  const outline = load.outline ? [...outlineGrips(scene, ['load', 'outline'], pose, 'load')] : [radiusGrip(['load', 'radius_m'], pose, load.radius_m, 'load')];
  const whole = { kind: 'load', name: 'load: place', at: ['load'], place: [pose.x, pose.y], move: (to, place) => { to.load.position_m = place; } };
  const grips = [...tips, ...obstacleGrips(scene), ...springGrips(scene, pose), ...outline, ...supports, ...(nest ? [nest] : []), whole];
  // A body comes before its parts, of which one is often where the body is.
  const isPart = ({ kind }) => kind === 'part';
  return [...grips.filter((grip) => !isPart(grip)), ...grips.filter(isPart)];
}

// What can be added: each changes the scenario, and returns the keys of what is new.
const ADDERS = {
  box: (scene, place, size) => addObstacle(scene, 'box', { polygon: { points_m: [[-size, -size], [size, -size], [size, size], [-size, size]] } }, place),
  disc: (scene, place, size) => addObstacle(scene, 'disc', { disc: { radius_m: size } }, place),
  wall: (scene, place, size) => addObstacle(scene, 'wall', { polyline: { points_m: [[0, -2 * size], [0, 2 * size]] } }, place),
  pusher(scene, place, size) {
    const at = addObstacle(scene, 'pusher', { disc: { radius_m: size / 2 } }, place);
    makePusher(scene, valueAt(scene, at), size);
    return [...at, 'path', 'waypoints', 1];
  },
  spring(scene, _, size) {
    const limit = scene.ground.friction_coefficient * scene.ground.supports.reduce((sum, { normal_load_n: load }) => sum + load, 0);
    const like = scene.springs.at(-1) || { rest_length_m: 2 * size, radial_stiffness_n_per_m: (limit || 1) / size, torsional_stiffness_nm_per_rad: 0, damping_ratio: 0 };
    // By the golden angle from the one before, so that many spread evenly.
    const bearing = (2.399963 * scene.springs.length) % (2 * Math.PI);
    scene.springs.push({ ...structuredClone(like), root_m: [size * Math.cos(bearing), size * Math.sin(bearing)], bearing_rad: bearing });
    return ['springs', scene.springs.length - 1];
  },
  support(scene, _, size) {
    const { supports } = scene.ground;
    const mean = supports.length ? supports.reduce((sum, { normal_load_n: load }) => sum + load, 0) / supports.length : 9.81 * scene.load.mass_kg;
    withWeight(scene, () => supports.push({ ...structuredClone(supports.at(-1) || {}), offset_m: [size / 2, 0], normal_load_n: mean }));
    return ['ground', 'supports', supports.length - 1];
  },
};

function addObstacle(scene, kind, outline, place) {
  scene.obstacles ??= [];
  const names = new Set(scene.obstacles.map(({ name }) => name));
  let name = kind;
  for (let n = 2; names.has(name); n++) name = `${kind} ${n}`;
  scene.obstacles.push({ name, outline, position_m: place, heading_rad: 0, friction_coefficient: 0.2, restitution: 0 });
  return ['obstacles', scene.obstacles.length - 1];
}

// An obstacle that stands begins to move towards the load.
function makePusher(scene, obstacle, size) {
  const { x, y, heading } = poseOfBody(obstacle);
  const load = poseOfBody(scene.load);
  const way = Math.hypot(load.x - x, load.y - y) || 1;
  const to = [x + 2 * size * (load.x - x) / way, y + 2 * size * (load.y - y) / way];
  delete obstacle.position_m;
  delete obstacle.heading_rad;
  obstacle.path = { waypoints: [[0, x, y, heading], [scene.duration_s, ...to, heading]] };
}

// Supports that come or go leave the weight of the load as it is.
function withWeight(scene, change) {
  const { supports } = scene.ground;
  const sum = () => supports.reduce((so_far, { normal_load_n: load }) => so_far + load, 0);
  const before = sum();
  change();
  const factor = before > 0 && sum() > 0 ? before / sum() : 1;
  for (const support of supports) support.normal_load_n *= factor;
}

// A point after another one: of an outline, or of a path half-way to the next. A spring or an obstacle begins a path.
function addPoint(scene, at, size) {
  const list = at && parentOf(scene, at);
  const i = at?.at(-1);
  if (Array.isArray(list) && Array.isArray(list[i])) {
    const isPath = at.includes('waypoints');
    const [now, next] = [list[i], list[i + 1] ?? (isPath || at.includes('polyline') ? undefined : list[0])];
    const beyond = isPath ? [now[0] + 0.25 * scene.duration_s, now[1] + size, ...now.slice(2)] : [now[0] + size, now[1]];
    list.splice(i + 1, 0, next ? now.map((value, axis) => (value + next[axis]) / 2) : beyond);
    if (isPath) scene.duration_s = Math.max(scene.duration_s, list.at(-1)[0]);
    return [...at.slice(0, -1), i + 1];
  }
  if (at?.[0] === 'springs' && scene.drive.paths) {
    const { root_m: root, bearing_rad: bearing, rest_length_m: length } = scene.springs[i];
    const pose = poseOfBody(scene.load);
    const along = (far) => toWorld(pose, [root[0] + far * Math.cos(bearing), root[1] + far * Math.sin(bearing)]);
    scene.drive.paths = scene.drive.paths.filter(({ spring }) => spring !== i);
    scene.drive.paths.push({ spring: i, waypoints: [[0, ...along(length)], [scene.duration_s, ...along(length + 4 * size)]] });
    return ['drive', 'paths', scene.drive.paths.length - 1, 'waypoints', 1];
  }
  if (at?.[0] === 'obstacles' && !scene.obstacles[at[1]].path) {
    makePusher(scene, scene.obstacles[at[1]], size);
    return ['obstacles', at[1], 'path', 'waypoints', 1];
  }
  return undefined;
}

// Takes a part out, with what hangs on it; false for what a scene cannot do without.
function removePart(scene, at) {
  const [kind] = at;
  const isWaypoint = at.includes('waypoints');
  if (isWaypoint && parentOf(scene, at).length === 1) return removePart(scene, at.slice(0, kind === 'drive' ? 3 : 2));
  const ofPart = at.includes('parts') ? at.lastIndexOf('parts') + 2 : undefined;
  const key = isWaypoint || at.includes('points_m') ? at : at.slice(0, ofPart ?? { springs: 2, obstacles: 2, ground: 3, drive: 3 }[kind]);
  const [list, i] = [parentOf(scene, key), key.at(-1)];
  if (!Array.isArray(list)) return false;
  const takeOut = () => list.splice(i, 1);
  if (kind === 'ground') withWeight(scene, takeOut); else takeOut();
  if (kind === 'springs' && scene.drive.paths) {
    scene.drive.paths = scene.drive.paths.filter(({ spring }) => spring !== i);
    for (const path of scene.drive.paths) if (path.spring > i) path.spring -= 1;
  }
  return true;
}
