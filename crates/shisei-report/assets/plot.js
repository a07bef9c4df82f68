"use strict";
// Plots that share one x range and one cursor.
(() => {
  const { text } = shisei;
  const charts = [];
  let cursorX = null;
  let listeners = [];

  const number = (value, digits) => value.toFixed(digits).replace("-", "−");
  const digitsOf = (unit) => (unit === "°" || unit === "°/s" ? 2 : 3);

  // The value of a series at the row nearest to x; breaks have no value of their own.
  const valueNear = (rows, k, row) => {
    for (const candidate of [row, row + 1, row - 1]) {
      if (rows.x[candidate] !== undefined && Math.abs(rows.x[candidate] - rows.x[row]) === 0) {
        const value = rows.y[k][candidate];
        if (value != null) return { value, sigma: rows.sigma[k] && rows.sigma[k][candidate] };
      }
    }
    return null;
  };

  const nearestRow = (xs, wanted) => {
    const row = shisei.rowAt(xs, wanted);
    return row + 1 < xs.length && xs[row + 1] - wanted < wanted - xs[row] ? row + 1 : row;
  };

  const drawSpans = (u, spans) => {
    const { ctx, bbox } = u;
    const pixel = devicePixelRatio || 1;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (const [from, to, kind] of spans) {
      if (from === null || to === null) continue;
      const left = u.valToPos(from, "x", true);
      const width = Math.max(u.valToPos(to, "x", true) - left, pixel);
      if (left > bbox.left + bbox.width || left + width < bbox.left) continue;
      ctx.fillStyle = shisei.colour(kind + "-fill");
      ctx.fillRect(left, bbox.top, width, bbox.height);
      if (kind === "rest") {
        ctx.fillStyle = shisei.colour("rest-edge");
        ctx.fillRect(left, bbox.top, width, 3 * pixel);
      } else {
        hatch(ctx, left, bbox.top, width, bbox.height, kind, pixel);
      }
    }
    ctx.restore();
  };

  // Gaps lean one way, poor stretches the other: readable without colour.
  const hatch = (ctx, left, top, width, height, kind, pixel) => {
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.strokeStyle = shisei.colour(kind + "-edge");
    ctx.lineWidth = pixel;
    ctx.beginPath();
    const step = 8 * pixel;
    const lean = kind === "gap" ? 1 : -1;
    const first = Math.floor((left - height) / step) * step;
    const last = Math.min(left + width + height, first + 4000 * step);
    for (let x = first; x < last; x += step) {
      ctx.moveTo(x, lean > 0 ? top + height : top);
      ctx.lineTo(x + height, lean > 0 ? top : top + height);
    }
    ctx.stroke();
    ctx.restore();
  };

  const drawBands = (u, chart) => {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    const { x, y, sigma } = chart.plot.rows;
    const first = Math.max(shisei.rowAt(x, u.scales.x.min) - 1, 0);
    const last = Math.min(shisei.rowAt(x, u.scales.x.max) + 2, x.length - 1);
    chart.plot.series.forEach((series, k) => {
      if (!sigma[k] || !u.series[k + 1].show) return;
      ctx.fillStyle = shisei.colour("tone-" + series.tone + "-band");
      let run = [];
      const close = () => {
        if (run.length > 1) {
          ctx.beginPath();
          run.forEach(([px, high], n) => (n ? ctx.lineTo(px, high) : ctx.moveTo(px, high)));
          for (let n = run.length - 1; n >= 0; n--) ctx.lineTo(run[n][0], run[n][2]);
          ctx.closePath();
          ctx.fill();
        }
        run = [];
      };
      for (let row = first; row <= last; row++) {
        const value = y[k][row];
        if (value === undefined) continue;
        if (value === null || sigma[k][row] === null) {
          close();
          continue;
        }
        // one edge point a pixel, the widest of those in it
        const px = Math.round(u.valToPos(x[row], "x", true));
        const high = u.valToPos(value + sigma[k][row], "y", true);
        const low = u.valToPos(value - sigma[k][row], "y", true);
        const last = run[run.length - 1];
        if (last && last[0] === px) {
          last[1] = Math.min(last[1], high);
          last[2] = Math.max(last[2], low);
        } else {
          run.push([px, high, low]);
        }
      }
      close();
    });
    ctx.restore();
  };

  // One pen stroke for each unbroken run; within a pixel's width only its first, least, greatest and last
  // values are drawn. (uPlot's own lines close up where a break is narrower than a pixel.)
  const linePath = (u, index, first, last) => {
    const stroke = new Path2D();
    const [xs, ys] = [u.data[0], u.data[index]];
    let pen = null;
    let column = null;
    const to = (px, value) => {
      const py = u.valToPos(value, "y", true);
      if (pen) stroke.lineTo(px, py);
      else stroke.moveTo(px, py);
      pen = [px, py];
    };
    const flush = () => {
      if (!column) return;
      const { px, open, low, high, close } = column;
      const alone = pen === null && low === high;
      to(px, open);
      if (low < Math.min(open, close)) to(px, low);
      if (high > Math.max(open, close)) to(px, high);
      if (close !== open || low !== high) to(px, close);
      if (alone) stroke.lineTo(px + 0.01, pen[1]); // a single sample shows as a dot
      column = null;
    };
    for (let row = Math.max(first - 2, 0); row <= Math.min(last + 2, xs.length - 1); row++) {
      const value = ys[row];
      if (value === undefined) continue;
      if (value === null) {
        flush();
        pen = null;
        continue;
      }
      const px = Math.round(u.valToPos(xs[row], "x", true) * 2) / 2;
      if (column && column.px === px) {
        column.low = Math.min(column.low, value);
        column.high = Math.max(column.high, value);
        column.close = value;
      } else {
        flush();
        column = { px, open: value, low: value, high: value, close: value };
      }
    }
    flush();
    return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 1 };
  };

  // Angles read best in parts of a turn.
  const DEGREE_STEPS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 45, 90, 180, 360];

  const options = (chart, width, height) => {
    const { plot } = chart;
    const axis = (which, extra) => ({
      label: which.unit ? `${which.label} (${which.unit})` : which.label,
      labelSize: 22,
      labelFont: `13px ${shisei.colour("font")}`,
      font: `12px ${shisei.colour("font")}`,
      stroke: () => shisei.colour("quiet"),
      grid: { stroke: () => shisei.colour("grid"), width: 1 },
      ticks: { stroke: () => shisei.colour("grid"), width: 1, size: 5 },
      ...extra,
    });
    const plain = (u, splits) => splits.map((v) => (v === null ? "" : String(+v.toPrecision(10)).replace("-", "−")));
    return {
      width,
      height,
      legend: { show: false },
      padding: [8, 14, 0, 0],
      cursor: {
        y: false,
        drag: { x: true, y: false, dist: 6 },
        points: { size: 7, width: 1.5 },
        bind: { mouseleave: () => () => null, dblclick: () => () => { setRange(null); return null; } },
      },
      scales: {
        x: { time: false, distr: plot.xAxis.log ? 3 : 1 },
        y: { distr: plot.yAxis.log ? 3 : 1 },
      },
      axes: [
        axis(plot.xAxis, { size: 32, values: plot.xAxis.log ? undefined : plain }),
        axis(plot.yAxis, { size: 52, incrs: plot.yAxis.unit === "°" ? DEGREE_STEPS : undefined, values: plot.yAxis.log ? undefined : plain }),
      ],
      series: [
        {},
        ...plot.series.map((series) => ({
          label: series.name,
          stroke: () => shisei.colour("tone-" + series.tone),
          width: 1.5,
          points: series.points ? { show: true, size: 5 } : { show: false },
          cap: "round",
          paths: series.points ? () => null : linePath,
          spanGaps: false,
        })),
      ],
      hooks: {
        drawClear: [(u) => { drawSpans(u, plot.spans); }],
        drawAxes: [(u) => { drawBands(u, chart); }],
        setScale: [(u, key) => { if (key === "x") follow(u); }],
        setCursor: [(u) => {
          if (chart.moving || u.cursor.left == null || u.cursor.left < 0) return;
          setCursor(u.posToVal(u.cursor.left, "x"));
        }],
      },
    };
  };

  // All plots take the x range of the one that was zoomed.
  let following = false;
  const follow = (from) => {
    if (following) return;
    following = true;
    const { min, max } = from.scales.x;
    for (const { u } of charts) if (u !== from && u.scales.x.min !== undefined) u.setScale("x", { min, max });
    following = false;
    queueMicrotask(() => { if (cursorX !== null) placeCursor(); });
  };

  const whole = () => {
    const ends = charts.map(({ plot: { rows: { x } } }) => [x[0], x[x.length - 1]]);
    return [Math.min(...ends.map((e) => e[0])), Math.max(...ends.map((e) => e[1]))];
  };

  const setRange = (range) => {
    if (!charts.length) return;
    const [first, last] = whole();
    let [min, max] = range || [first, last];
    if (!(last > first)) return;
    const width = Math.max(Math.min(max - min, last - first), (last - first) * 1e-6);
    min = Math.min(Math.max(min, first), last - width);
    charts[0].u.setScale("x", { min, max: min + width });
  };

  const zoom = (factor, about) => {
    const { min, max } = charts[0].u.scales.x;
    const centre = about ?? (cursorX !== null && cursorX > min && cursorX < max ? cursorX : (min + max) / 2);
    setRange([centre - (centre - min) * factor, centre + (max - centre) * factor]);
  };

  const pan = (share) => {
    const { min, max } = charts[0].u.scales.x;
    const by = (max - min) * share;
    setRange([min + by, max + by]);
  };

  const placeCursor = () => {
    for (const chart of charts) {
      const { u, plot } = chart;
      chart.moving = true;
      u.setCursor({ left: u.valToPos(cursorX, "x"), top: 0 }, false);
      chart.moving = false;
      const row = nearestRow(plot.rows.x, cursorX);
      chart.values.forEach((cell, k) => {
        const found = valueNear(plot.rows, k, row);
        const digits = digitsOf(plot.yAxis.unit);
        let shown = "–";
        if (found) {
          shown = number(found.value, digits) + (plot.yAxis.unit === "°" ? "°" : "");
          if (found.sigma != null) shown += ` ±${number(found.sigma, digits)}`;
        }
        cell.textContent = shown;
      });
    }
  };

  const setCursor = (x, quietly) => {
    if (x === null || !Number.isFinite(x)) return;
    cursorX = x;
    placeCursor();
    if (!quietly) for (const listener of listeners) listener(x);
  };

  const legend = (chart, holder) => {
    const { plot } = chart;
    chart.values = plot.series.map((series, k) => {
      const button = document.createElement("button");
      button.type = "button";
      button.className = "tone-" + series.tone;
      button.setAttribute("aria-pressed", "true");
      const swatch = document.createElement("i");
      swatch.setAttribute("aria-hidden", "true");
      const name = document.createElement("b");
      name.textContent = series.name;
      const value = document.createElement("span");
      button.append(swatch, name, value);
      button.title = text.hide.replace("{name}", () => series.name);
      button.addEventListener("click", () => {
        const show = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", String(show));
        button.title = (show ? text.hide : text.show).replace("{name}", () => series.name);
        chart.u.setSeries(k + 1, { show });
      });
      holder.append(button);
      return value;
    });
    const unit = document.createElement("span");
    unit.className = "unit";
    unit.textContent = plot.yAxis.unit === "°" ? "" : plot.yAxis.unit;
    holder.append(unit);
  };

  const keyOfSpans = () => {
    const kinds = new Set(shisei.plots.flatMap((p) => p.spans.map((s) => s[2])));
    const holder = document.getElementById("key");
    const add = (className, word) => {
      const item = document.createElement("span");
      item.className = "key-" + className;
      item.append(document.createElement("i"), word);
      holder.append(item);
    };
    for (const kind of ["rest", "gap", "poor"]) if (kinds.has(kind)) add(kind, text[kind]);
    if (shisei.plots.some((p) => p.rows.sigma.some(Boolean))) add("band", text.band);
  };

  const heightFor = (width, n) => Math.round(Math.max(n ? 190 : 240, Math.min(n ? 230 : 320, width * (n ? 0.36 : 0.5))));

  const build = () => {
    shisei.plots.forEach((plot, n) => {
      if (!plot.rows.x.length) return;
      const holder = document.getElementById("plot" + n);
      const width = holder.clientWidth;
      const chart = { plot, holder, n, moving: false };
      legend(chart, document.getElementById("legend" + n));
      chart.u = new uPlot(options(chart, width, heightFor(width, n)), [plot.rows.x, ...plot.rows.y], holder);
      charts.push(chart);
      holder.addEventListener("wheel", (event) => {
        if (!event.ctrlKey && !event.metaKey) return;
        event.preventDefault();
        const left = event.clientX - chart.u.over.getBoundingClientRect().left;
        zoom(event.deltaY < 0 ? 0.8 : 1.25, chart.u.posToVal(left, "x"));
      }, { passive: false });
      touch(chart);
    });
    keyOfSpans();
    const most = shisei.plots.find((p) => p.drawnRows < p.rowsBefore);
    if (most) {
      const note = document.createElement("span");
      note.textContent = " " + text.thinned
        .replace("{n}", most.drawnRows.toLocaleString("en"))
        .replace("{m}", most.rowsBefore.toLocaleString("en"));
      document.getElementById("hint").append(note);
    }
    new ResizeObserver(() => resize()).observe(document.querySelector(".plots"));
  };

  // One finger moves the cursor, so that values can be read on a phone; the page still scrolls up and down.
  const touch = (chart) => {
    const { over } = chart.u;
    over.style.touchAction = "pan-y pinch-zoom";
    over.addEventListener("pointermove", (event) => {
      if (event.pointerType !== "touch") return;
      setCursor(chart.u.posToVal(event.clientX - over.getBoundingClientRect().left, "x"));
    });
  };

  const resize = (forced) => {
    for (const { u, holder, n } of charts) {
      const width = forced || holder.clientWidth;
      if (width > 0 && width !== u.width) u.setSize({ width, height: heightFor(width, n) });
    }
    setTimeout(() => { if (cursorX !== null) placeCursor(); }, 0); // after the new layout
  };

  shisei.charts = {
    build, setCursor, setRange, zoom, pan, resize, whole,
    cursor: () => cursorX,
    list: charts,
    redraw: () => charts.forEach(({ u }) => u.redraw(false, true)),
    onCursor: (listener) => listeners.push(listener),
  };
})();
