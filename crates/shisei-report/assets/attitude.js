"use strict";
// The 3-D attitude: a box with its axes over a level grid, drawn on a 2-D canvas.
(() => {
  const BOX = [0.62, 0.42, 0.16]; // half lengths along the sensor's x, y, z
  const GROUND = 1; // half a side of the level grid
  const FLOOR = -0.75; // its height
  const AXIS_LENGTH = 1.15;
  const FACES = [
    { axis: 0, sign: 1 }, { axis: 0, sign: -1 },
    { axis: 1, sign: 1 }, { axis: 1, sign: -1 },
    { axis: 2, sign: 1 }, { axis: 2, sign: -1 },
  ];
  const view = { azimuth: -0.95, elevation: 0.42 };
  let canvas, ctx, pose = [1, 0, 0, 0];

  const rotate = ([w, x, y, z], [a, b, c]) => {
    const t = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
    return [
      a + w * t[0] + y * t[2] - z * t[1],
      b + w * t[1] + z * t[0] - x * t[2],
      c + w * t[2] + x * t[1] - y * t[0],
    ];
  };

  // Between two attitudes on the shorter way.
  const between = (t) => {
    const { t: times, q } = shisei.attitudes;
    const row = shisei.rowAt(times, t);
    const a = q.subarray(4 * row, 4 * row + 4);
    const next = Math.min(row + 1, times.length - 1);
    const b = q.subarray(4 * next, 4 * next + 4);
    const step = times[next] - times[row];
    const share = step > 0 ? Math.min(Math.max((t - times[row]) / step, 0), 1) : 0;
    const sign = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < 0 ? -1 : 1;
    const mixed = [0, 1, 2, 3].map((k) => (1 - share) * a[k] + share * sign * b[k]);
    const norm = Math.hypot(...mixed) || 1;
    return mixed.map((c) => c / norm);
  };

  // World to screen: x right, y down, depth towards the eye; a mild perspective.
  const project = ([x, y, z]) => {
    const ca = Math.cos(view.azimuth), sa = Math.sin(view.azimuth);
    const ce = Math.cos(view.elevation), se = Math.sin(view.elevation);
    const right = -sa * x + ca * y;
    const away = ca * x + sa * y;
    const up = ce * z - se * away;
    const depth = ce * away + se * z;
    const scale = 5.2 / (5.2 - depth);
    const size = Math.min(canvas.width, canvas.height) * 0.3;
    return [canvas.width / 2 + right * scale * size, canvas.height * 0.47 - up * scale * size, depth];
  };

  const line = (a, b, colour, width) => {
    const [p, q] = [project(a), project(b)];
    ctx.strokeStyle = colour;
    ctx.lineWidth = width * devicePixelRatio;
    ctx.beginPath();
    ctx.moveTo(p[0], p[1]);
    ctx.lineTo(q[0], q[1]);
    ctx.stroke();
  };

  const label = (at, word, colour, size) => {
    const [x, y] = project(at);
    ctx.font = `600 ${size * devicePixelRatio}px ${shisei.colour("font")}`;
    ctx.textAlign = "center";
    ctx.textBaseline = "middle";
    ctx.lineWidth = 3.5 * devicePixelRatio;
    ctx.lineJoin = "round";
    ctx.strokeStyle = shisei.colour("card");
    ctx.strokeText(word, x, y);
    ctx.fillStyle = colour;
    ctx.fillText(word, x, y);
  };

  const drawGround = () => {
    const colour = shisei.colour("grid");
    const quiet = shisei.colour("quiet");
    for (let k = -2; k <= 2; k++) {
      const at = (k * GROUND) / 2;
      line([at, -GROUND, FLOOR], [at, GROUND, FLOOR], colour, 1);
      line([-GROUND, at, FLOOR], [GROUND, at, FLOOR], colour, 1);
    }
    [[1, 0], [0, 1]].forEach(([x, y], k) => {
      line([0, 0, FLOOR], [x * GROUND, y * GROUND, FLOOR], quiet, 1.3);
      label([x * GROUND * 1.12, y * GROUND * 1.12, FLOOR], "XY"[k], quiet, 11);
    });
  };

  // The box is convex: the faces turned to the eye, farthest first, are all there is to see.
  const drawBox = () => {
    const corner = (u, v, { axis, sign }) => {
      const point = [0, 0, 0];
      point[axis] = sign * BOX[axis];
      point[(axis + 1) % 3] = u * BOX[(axis + 1) % 3];
      point[(axis + 2) % 3] = v * BOX[(axis + 2) % 3];
      return rotate(pose, point);
    };
    const light = [0.35, -0.25, 0.9];
    const faces = FACES.map((face) => {
      const normal = [0, 0, 0];
      normal[face.axis] = face.sign;
      const world = rotate(pose, normal);
      const points = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([u, v]) => project(corner(u, v, face)));
      let area = 0;
      points.forEach((p, k) => {
        const n = points[(k + 1) % 4];
        area += p[0] * n[1] - n[0] * p[1];
      });
      const shade = 0.5 + 0.5 * (world[0] * light[0] + world[1] * light[1] + world[2] * light[2]);
      return { face, points, shade, visible: area * face.sign < 0 };
    });
    for (const { face, points, shade, visible } of faces) {
      if (!visible) continue;
      ctx.beginPath();
      points.forEach(([x, y], k) => (k ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
      ctx.closePath();
      const [hue, chroma, low, high] = shisei.colour("box").split(" ");
      ctx.fillStyle = `hsl(${hue} ${chroma}% ${+low + (high - low) * shade}%)`;
      ctx.fill();
      ctx.strokeStyle = shisei.colour("box-edge");
      ctx.lineWidth = 1.2 * devicePixelRatio;
      ctx.lineJoin = "round";
      ctx.stroke();
      if (face.axis === 2 && face.sign === 1) {
        // a notch at the +x end of the top face, so that it is not mistaken for the bottom
        const notch = [[0.9, -0.35], [0.9, 0.35], [0.66, 0]]
          .map(([a, b]) => project(rotate(pose, [a * BOX[0], b * BOX[1], BOX[2]])));
        ctx.beginPath();
        notch.forEach(([x, y], k) => (k ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
        ctx.closePath();
        ctx.fillStyle = shisei.colour("box-edge");
        ctx.fill();
      }
    }
  };

  const axes = () =>
    [0, 1, 2].map((k) => {
      const from = [0, 0, 0], to = [0, 0, 0], text = [0, 0, 0];
      from[k] = BOX[k];
      to[k] = k === 2 ? 0.85 : AXIS_LENGTH;
      text[k] = to[k] + 0.14;
      return { k, from: rotate(pose, from), to: rotate(pose, to), text: rotate(pose, text) };
    });

  const drawAxis = ({ k, from, to, text }) => {
    const colour = shisei.colour("tone-" + "xyz"[k]);
    line(from, to, colour, 3);
    const [a, b] = [project(from), project(to)];
    const angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
    const length = Math.min(9 * devicePixelRatio, Math.hypot(b[0] - a[0], b[1] - a[1]));
    ctx.beginPath();
    ctx.moveTo(b[0] + length * 0.5 * Math.cos(angle), b[1] + length * 0.5 * Math.sin(angle));
    for (const turn of [2.5, -2.5]) ctx.lineTo(b[0] + length * Math.cos(angle + turn), b[1] + length * Math.sin(angle + turn));
    ctx.closePath();
    ctx.fillStyle = colour;
    ctx.fill();
    label(text, "xyz"[k], colour, 14);
  };

  const draw = () => {
    if (!ctx) return;
    ctx.clearRect(0, 0, canvas.width, canvas.height);
    drawGround();
    // an axis that leaves the box on the far side is behind it
    const [behind, before] = [[], []];
    for (const axis of axes()) (project(axis.to)[2] < project(axis.from)[2] ? behind : before).push(axis);
    behind.forEach(drawAxis);
    drawBox();
    before.forEach(drawAxis);
  };

  const resize = () => {
    const width = Math.round(canvas.clientWidth * devicePixelRatio);
    const height = Math.round(canvas.clientHeight * devicePixelRatio);
    if (width && height && (canvas.width !== width || canvas.height !== height)) {
      canvas.width = width;
      canvas.height = height;
    }
    draw();
  };

  const turn = (azimuth, elevation) => {
    view.azimuth += azimuth;
    view.elevation = Math.min(Math.max(view.elevation + elevation, -1.5), 1.5);
    draw();
  };

  const build = () => {
    if (!shisei.attitudes || !shisei.attitudes.t.length) return;
    canvas = document.getElementById("attitude");
    ctx = canvas.getContext("2d");
    let last = null;
    canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!last) return;
      turn(-(event.clientX - last[0]) * 0.01, (event.clientY - last[1]) * 0.01);
      last = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { last = null; });
    canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
      if (!step) return;
      event.preventDefault();
      turn(...step);
    });
    new ResizeObserver(resize).observe(canvas);
    resize();
  };

  shisei.attitudeView = {
    build,
    draw,
    pose: () => pose,
    setTime: (t) => {
      if (!ctx) return;
      pose = between(t);
      canvas.dataset.pose = pose.map((c) => c.toFixed(5)).join(" ");
      draw();
    },
  };
})();
