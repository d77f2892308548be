"use strict";
// The view of a robot: forward kinematics and a painter's algorithm on a canvas. No libraries, nothing is loaded.
(() => {
  const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const times = (s, a) => [s * a[0], s * a[1], s * a[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const length = (a) => Math.hypot(a[0], a[1], a[2]);
  const unit = (a) => times(1 / (length(a) || 1), a);
  const turn = (R, a) => [dot(R[0], a), dot(R[1], a), dot(R[2], a)];
  const column = (R, j) => [R[0][j], R[1][j], R[2][j]];
  const product = (A, B) => A.map((row) => [0, 1, 2].map((j) => dot(row, column(B, j))));
  const IDENTITY = { p: [0, 0, 0], R: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] };
  const then = (a, b) => ({ p: add(a.p, turn(a.R, b.p)), R: product(a.R, b.R) });
  const point = (pose, a) => add(pose.p, turn(pose.R, a));

  // Rodrigues' formula.
  const about = ([x, y, z], angle) => {
    const s = Math.sin(angle), c = Math.cos(angle), d = 1 - c;
    return [
      [c + x * x * d, x * y * d - z * s, x * z * d + y * s],
      [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
      [z * x * d - y * s, z * y * d + x * s, c + z * z * d],
    ];
  };

  // Poses of all links in the base frame, and of each joint before it moves.
  const kinematics = (robot, y) => {
    const links = [], carried = [];
    for (const joint of robot.joints) {
      const parent = joint.parent === null ? IDENTITY : links[joint.parent];
      const before = then(parent, { p: joint.translation, R: joint.rotation });
      const q = joint.terms.reduce((sum, [k, ratio]) => sum + ratio * y[k], joint.position);
      const motion = { p: times(joint.slide * q, joint.axis), R: about(joint.axis, joint.turn * q) };
      carried.push(before);
      links.push(then(before, motion));
    }
    return { links, carried };
  };
  const poseOf = (state, joint) => (joint === null ? IDENTITY : state.links[joint]);

  // Two directions across a third.
  const across = (a) => {
    const helper = Math.abs(a[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
    const u = unit(cross(helper, a));
    return [u, cross(a, u)];
  };

  // Faces of a tapered prism between two points.
  const prism = (faces, a, b, radiusA, radiusB, sides, colour, caps) => {
    const axis = subtract(b, a);
    if (length(axis) < 1e-9) return;
    const [u, v] = across(unit(axis));
    const ring = (center, radius) => Array.from({ length: sides }, (_, k) => {
      const angle = (2 * Math.PI * (k + 0.5)) / sides;
      return add(center, add(times(radius * Math.cos(angle), u), times(radius * Math.sin(angle), v)));
    });
    const first = ring(a, radiusA), second = ring(b, radiusB);
    for (let k = 0; k < sides; k++) {
      const next = (k + 1) % sides;
      faces.push({ points: [first[k], first[next], second[next], second[k]], colour });
    }
    if (caps) {
      faces.push({ points: first.slice().reverse(), colour });
      faces.push({ points: second, colour });
    }
  };

  const setUp = (figure) => {
    const robot = JSON.parse(figure.querySelector("script.data").textContent);
    const canvas = figure.querySelector("canvas");
    const context = canvas.getContext("2d");
    const sliders = [...figure.querySelectorAll("input[data-coordinate]")];
    const outputs = [...figure.querySelectorAll("output[data-frame]")];
    const y = sliders.map((slider) => Number(slider.value));
    const START = { azimuth: 0.9, elevation: 0.38, zoom: 1 };
    const view = { ...START };
    let active = -1;

    // The size of the robot stretched out, and where it sits, do not change as it moves.
    const reach = (() => {
      const far = robot.joints.map(() => 0);
      let most = 0;
      robot.joints.forEach((joint, k) => {
        far[k] = (joint.parent === null ? 0 : far[joint.parent]) + length(joint.translation);
        most = Math.max(most, far[k]);
      });
      const extent = (entry, offset) => (entry.joint === null ? 0 : far[entry.joint]) + length(offset);
      for (const frame of robot.frames) most = Math.max(most, extent(frame, frame.translation));
      for (const body of robot.bodies) most = Math.max(most, extent(body, body.center));
      return most || 1;
    })();
    const heaviest = Math.max(...robot.bodies.map((body) => body.mass), 0);
    const thick = 0.032 * reach;
    const up = length(robot.gravity) > 0 ? unit(times(-1, robot.gravity)) : [0, 0, 1];
    const [ground1, ground2] = across(up);
    // What is looked at: the middle of the robot at the start, from so far that all of it is seen.
    const { target, radius } = (() => {
      const state = kinematics(robot, y);
      const points = [[0, 0, 0], ...state.links.map((pose) => pose.p),
        ...robot.frames.map((frame) => point(poseOf(state, frame.joint), frame.translation)),
        ...robot.bodies.map((body) => point(poseOf(state, body.joint), body.center))];
      const target = [0, 1, 2].map((k) => {
        const values = points.map((p) => p[k]);
        return (Math.min(...values) + Math.max(...values)) / 2;
      });
      const distances = points.map((p) => length(subtract(p, target)));
      return { target, radius: Math.max(...distances, 0.3 * reach) };
    })();

    const colours = () => {
      const style = getComputedStyle(document.documentElement);
      const of = (name) => style.getPropertyValue(name).trim();
      return { ink: of("--ink"), soft: of("--soft"), grid: of("--rule"), body: of("--body"), accent: of("--accent"),
        link: of("--link"), paper: of("--paper"), x: of("--series-2"), y: of("--series-3"), z: of("--series-1") };
    };
    const channels = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
    const shaded = (hex, light) => `rgb(${channels(hex).map((c) => Math.round(Math.min(255, c * light))).join(",")})`;

    const camera = () => {
      const ce = Math.cos(view.elevation), se = Math.sin(view.elevation);
      const flat = add(times(Math.cos(view.azimuth), ground1), times(Math.sin(view.azimuth), ground2));
      const toEye = add(times(ce, flat), times(se, up));
      const right = unit(cross(up, flat));
      return { toEye, right, above: cross(toEye, right) };
    };

    const draw = () => {
      const ratio = window.devicePixelRatio || 1;
      const width = canvas.clientWidth, height = canvas.clientHeight;
      if (!width || !height) return;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      const { toEye, right, above } = camera();
      const distance = 4.5 * reach;
      const scale = (0.4 * Math.min(width, height) * view.zoom) / radius;
      const project = (p) => {
        const d = subtract(p, target);
        const depth = dot(d, toEye);
        const s = (scale * distance) / (distance - depth);
        return [width / 2 + s * dot(d, right), height / 2 - s * dot(d, above), depth, s];
      };
      const palette = colours();
      const state = kinematics(robot, y);
      const items = [];
      const light = unit(add(toEye, add(times(0.6, above), times(-0.5, right))));
      const faces = [];
      const lines = (from, to, colour, wide, dashed) => {
        const a = project(from), b = project(to);
        items.push({ depth: (a[2] + b[2]) / 2, paint: () => {
          context.beginPath();
          context.setLineDash(dashed ? [4, 4] : []);
          context.moveTo(a[0], a[1]);
          context.lineTo(b[0], b[1]);
          context.strokeStyle = colour;
          context.lineWidth = wide;
          context.stroke();
          context.setLineDash([]);
        } });
      };

      // The ground through the base, square to gravity.
      const step = 10 ** Math.floor(Math.log10(reach)) / (reach / 10 ** Math.floor(Math.log10(reach)) < 3 ? 4 : 2);
      const cells = Math.ceil((0.7 * reach) / step);
      for (let k = -cells; k <= cells; k++) {
        const at = (a, b) => add(times(a * step, ground1), times(b * step, ground2));
        for (const [a, b] of [[at(k, -cells), at(k, cells)], [at(-cells, k), at(cells, k)]]) {
          const [p, q] = [project(a), project(b)];
          context.beginPath();
          context.moveTo(p[0], p[1]);
          context.lineTo(q[0], q[1]);
          context.strokeStyle = palette.grid;
          context.lineWidth = k === 0 ? 1.2 : 0.6;
          context.stroke();
        }
      }

      const joined = (from, to) => prism(faces, from, to, 0.62 * thick, 0.5 * thick, 8, palette.body, true);
      robot.joints.forEach((joint, k) => {
        const from = joint.parent === null ? [0, 0, 0] : state.links[joint.parent].p;
        const origin = state.carried[k].p;
        joined(from, origin);
        const axis = turn(state.carried[k].R, joint.axis);
        if (joint.slide && joint.moves) joined(origin, state.links[k].p);
        if (!joint.turn && joint.moves) {
          const half = times(1.6 * thick, axis);
          const colour = joint.terms.length === 0 ? palette.body : joint.terms.some(([k]) => k === active) ? palette.link : palette.accent;
          prism(faces, subtract(state.links[k].p, half), add(state.links[k].p, half), 1.5 * thick, 1.5 * thick, 4, colour, true);
        } else if (joint.moves) {
          const half = times(1.35 * thick, axis);
          const colour = joint.terms.length === 0 ? palette.body : joint.terms.some(([k]) => k === active) ? palette.link : palette.accent;
          prism(faces, subtract(origin, half), add(origin, half), 1.15 * thick, 1.15 * thick, 20, colour, true);
        }
      });
      // A link that carries no joint reaches to its farthest frame, or to its centre of mass.
      const carries = new Set(robot.joints.map((joint) => joint.parent));
      robot.joints.forEach((_, k) => {
        if (carries.has(k)) return;
        const ends = [...robot.frames.filter((frame) => frame.joint === k).map((frame) => frame.translation),
          ...robot.bodies.filter((body) => body.joint === k).map((body) => body.center)];
        if (!ends.length) return;
        const farthest = ends.reduce((a, b) => (length(b) > length(a) ? b : a));
        joined(state.links[k].p, point(state.links[k], farthest));
      });

      // Cylinders are a barrel and a rod, springs a thin bar.
      for (const rod of robot.rods) {
        const [a, b] = rod.ends.map((end) => point(poseOf(state, end.joint), end.point));
        const middle = times(0.5, add(a, b));
        const [barrel, bar] = rod.input ? [0.5, 0.22] : [0.2, 0.2];
        const colour = rod.input ? palette.accent : palette.link;
        prism(faces, a, middle, barrel * thick, barrel * thick, 10, colour, true);
        prism(faces, middle, b, bar * thick, bar * thick, 10, rod.input ? palette.body : colour, true);
      }

      for (const face of faces) {
        const normal = unit(cross(subtract(face.points[1], face.points[0]), subtract(face.points[2], face.points[0])));
        const shown = face.points.map(project);
        // Turned away from the eye: its front hides it.
        let area = 0;
        shown.forEach((p, k) => {
          const q = shown[(k + 1) % shown.length];
          area += p[0] * q[1] - q[0] * p[1];
        });
        if (area > 0) continue;
        const depth = shown.reduce((sum, p) => sum + p[2], 0) / shown.length;
        const fill = shaded(face.colour, 0.62 + 0.5 * Math.max(0, dot(normal, light)));
        items.push({ depth, paint: () => {
          context.beginPath();
          shown.forEach((p, k) => (k ? context.lineTo(p[0], p[1]) : context.moveTo(p[0], p[1])));
          context.closePath();
          context.fillStyle = fill;
          context.strokeStyle = fill;
          context.lineWidth = 0.8;
          context.fill();
          context.stroke();
        } });
      }

      for (const body of robot.bodies) {
        if (!(body.mass > 0)) continue;
        const [cx, cy, depth, s] = project(point(poseOf(state, body.joint), body.center));
        const radius = Math.max(3.5, s * thick * 1.1 * Math.cbrt(body.mass / heaviest));
        // In front of what it is the centre of.
        items.push({ depth: depth + 2.2 * thick, paint: () => {
          context.beginPath();
          context.arc(cx, cy, radius, 0, 2 * Math.PI);
          context.fillStyle = palette.paper;
          context.fill();
          context.fillStyle = palette.ink;
          for (const start of [0, Math.PI]) {
            context.beginPath();
            context.moveTo(cx, cy);
            context.arc(cx, cy, radius, start, start + Math.PI / 2);
            context.fill();
          }
          context.beginPath();
          context.arc(cx, cy, radius, 0, 2 * Math.PI);
          context.strokeStyle = palette.ink;
          context.lineWidth = 1;
          context.stroke();
        } });
      }

      const triad = (pose, size) => ["x", "y", "z"].forEach((name, k) => {
        lines(pose.p, add(pose.p, times(size, column(pose.R, k))), palette[name], 2);
      });
      triad(IDENTITY, 0.16 * reach);
      for (const frame of robot.frames) {
        triad(then(poseOf(state, frame.joint), { p: frame.translation, R: frame.rotation }), 0.13 * reach);
      }

      items.sort((a, b) => a.depth - b.depth);
      for (const item of items) item.paint();

      context.font = "12px sans-serif";
      context.fillStyle = palette.ink;
      context.textBaseline = "middle";
      for (const frame of robot.frames) {
        const [px, py] = project(point(poseOf(state, frame.joint), frame.translation));
        context.fillText(frame.name, px + 9, py - 11);
      }
      if (length(robot.gravity) > 0) {
        const [x0, y0] = [width - 34, 24];
        const down = times(-1, up), dx = dot(down, right), dy = -dot(down, above);
        context.strokeStyle = palette.soft;
        context.fillStyle = palette.soft;
        context.lineWidth = 1.5;
        context.beginPath();
        context.moveTo(x0, y0);
        context.lineTo(x0 + 34 * dx, y0 + 34 * dy);
        context.stroke();
        context.beginPath();
        context.arc(x0 + 34 * dx, y0 + 34 * dy, 3, 0, 2 * Math.PI);
        context.fill();
        context.fillText("g", x0 + 8, y0 + 8);
      }
    };

    const fixed = (value, digits) => value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
    const say = () => {
      sliders.forEach((slider, k) => {
        const degrees = slider.dataset.unit === "rad" ? ` (${fixed((y[k] * 180) / Math.PI, 1)}°)` : "";
        const words = `${fixed(y[k], 3)} ${slider.dataset.unit}${degrees}`;
        slider.parentElement.querySelector("output").textContent = words;
        slider.setAttribute("aria-valuetext", words);
      });
      const state = kinematics(robot, y);
      for (const output of outputs) {
        const frame = robot.frames.find((entry) => entry.name === output.dataset.frame);
        const origin = point(poseOf(state, frame.joint), frame.translation);
        output.textContent = origin.map((x) => fixed(x, 4)).join(", ");
        output.dataset.origin = JSON.stringify(origin);
      }
    };

    let waiting = false;
    const refresh = () => {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        draw();
      });
    };
    const moved = () => {
      say();
      refresh();
    };
    sliders.forEach((slider, k) => {
      slider.addEventListener("input", () => {
        y[k] = Number(slider.value);
        moved();
      });
      slider.addEventListener("focus", () => { active = k; refresh(); });
      slider.addEventListener("blur", () => { active = -1; refresh(); });
    });
    figure.querySelector(".home").addEventListener("click", () => {
      sliders.forEach((slider, k) => {
        slider.value = slider.dataset.start;
        y[k] = Number(slider.value);
      });
      moved();
    });

    const orbit = (azimuth, elevation) => {
      view.azimuth += azimuth;
      view.elevation = Math.max(-1.55, Math.min(1.55, view.elevation + elevation));
      refresh();
    };
    const zoom = (factor) => {
      view.zoom = Math.max(0.2, Math.min(12, view.zoom * factor));
      refresh();
    };
    const VIEWS = {
      oblique: () => Object.assign(view, START),
      front: () => Object.assign(view, { azimuth: Math.atan2(ground2[0], ground1[0]), elevation: 0 }),
      side: () => Object.assign(view, { azimuth: Math.atan2(ground2[1], ground1[1]), elevation: 0 }),
      top: () => Object.assign(view, { azimuth: -Math.PI / 2, elevation: 1.55 }),
      closer: () => zoom(1.25),
      farther: () => zoom(0.8),
    };
    for (const button of figure.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => {
        VIEWS[button.dataset.view]();
        refresh();
      });
    }
    const KEYS = {
      ArrowLeft: () => orbit(-0.1, 0), ArrowRight: () => orbit(0.1, 0),
      ArrowUp: () => orbit(0, 0.1), ArrowDown: () => orbit(0, -0.1),
      "+": () => zoom(1.15), "=": () => zoom(1.15), "-": () => zoom(1 / 1.15),
      0: () => { Object.assign(view, START); refresh(); },
    };
    canvas.addEventListener("keydown", (event) => {
      const act = KEYS[event.key];
      if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      act();
    });
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) orbit(-0.008 * event.movementX, 0.008 * event.movementY);
    });
    // A plain wheel scrolls the page; with Ctrl, as a pinch also comes, it zooms.
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      zoom(Math.exp(-0.004 * event.deltaY));
    }, { passive: false });
    new ResizeObserver(refresh).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", refresh);
    // On paper the canvas shows what was drawn last: draw it in the colours of paper.
    const paper = (on) => {
      document.documentElement.toggleAttribute("data-paper", on);
      draw();
    };
    addEventListener("beforeprint", () => paper(true));
    addEventListener("afterprint", () => paper(false));
    say();
    draw();
  };

  for (const figure of document.querySelectorAll("figure.scene")) setUp(figure);
})();
