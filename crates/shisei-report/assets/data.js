"use strict";
// Reads the page's data: JSON with numbers as base64 of little-endian bytes.
window.shisei = { frameHooks: [] };
(() => {
  const bytes = (text) => {
    const binary = atob(text);
    const out = new Uint8Array(binary.length);
    for (let k = 0; k < binary.length; k++) out[k] = binary.charCodeAt(k);
    return out.buffer;
  };
  const f64 = (text) => new Float64Array(bytes(text));
  const f32 = (text) => new Float32Array(bytes(text));
  const u32 = (text) => new Uint32Array(bytes(text));

  // Rows for uPlot: null breaks every line, undefined leaves a line as it is. A row that some line must
  // not reach from the one before gets an extra row at the same x in front of it.
  const plotRows = (plot) => {
    const x = f64(plot.x);
    const series = plot.series.map((s) => ({
      ...s,
      y: f32(s.y),
      sigma: s.sigma && f32(s.sigma),
      breaks: new Set(u32(s.breaks)),
    }));
    const xs = [];
    const ys = series.map(() => []);
    const sigmas = series.map((s) => (s.sigma ? [] : null));
    for (let row = 0; row < x.length; row++) {
      if (series.some((s) => s.breaks.has(row))) {
        xs.push(x[row]);
        series.forEach((s, k) => {
          ys[k].push(s.breaks.has(row) ? null : undefined);
          if (sigmas[k]) sigmas[k].push(null);
        });
      }
      xs.push(x[row]);
      series.forEach((s, k) => {
        const shown = Number.isFinite(s.y[row]) && !(plot.yAxis.log && s.y[row] <= 0);
        ys[k].push(shown ? s.y[row] : null);
        if (sigmas[k]) sigmas[k].push(Number.isFinite(s.sigma[row]) ? s.sigma[row] : null);
      });
    }
    return { x: xs, y: ys, sigma: sigmas };
  };

  const data = JSON.parse(document.getElementById("data").textContent);
  shisei.text = data.text;
  shisei.plots = data.plots.map((plot) => ({ ...plot, rows: plotRows(plot), drawnRows: plot.x.length && f64(plot.x).length }));
  shisei.attitudes = data.attitude && { t: f64(data.attitude.t), q: f32(data.attitude.q) };

  // Index of the last value not above `wanted`; 0 before the first.
  shisei.rowAt = (sorted, wanted) => {
    let low = 0;
    let high = sorted.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (sorted[middle] <= wanted) low = middle;
      else high = middle - 1;
    }
    return low;
  };

  // A style sheet colour by name, of the theme in force.
  shisei.colour = (name) =>
    getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
})();
