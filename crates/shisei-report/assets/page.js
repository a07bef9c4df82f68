"use strict";
// Joins the plots, the attitude and the controls: one time, wherever it is set.
(() => {
  const { text, charts, attitudeView } = shisei;
  const $ = (id) => document.getElementById(id);
  charts.build();
  attitudeView.build();

  const times = shisei.attitudes && shisei.attitudes.t.length ? shisei.attitudes.t : null;
  const [first, last] = times ? [times[0], times[times.length - 1]] : charts.list.length ? charts.whole() : [0, 0];
  const slider = $("time");
  const play = $("play");
  let now = first;
  let playing = false;

  const clock = (t) => {
    const seconds = `${t.toFixed(2)} s`.replace("-", "−");
    if (last < 120) return seconds;
    const whole = Math.floor(Math.max(t, 0));
    const parts = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
    return `${seconds} (${parts.map((p) => String(p).padStart(2, "0")).join(":")})`;
  };

  const show = (t, from) => {
    now = Math.min(Math.max(t, first), last);
    if (from !== "plot") charts.setCursor(now, true);
    attitudeView.setTime(now);
    if (!slider) return;
    slider.value = String(now);
    slider.setAttribute("aria-valuetext", clock(now));
    $("now").textContent = clock(now);
  };

  const setPlaying = (wanted) => {
    playing = wanted;
    play.textContent = playing ? `❚❚ ${text.pause}` : `▶ ${text.play}`;
    play.setAttribute("aria-pressed", String(playing));
    if (!playing) return;
    if (now >= last) show(first);
    let before = performance.now();
    const frame = (at) => {
      if (!playing) return;
      show(now + ((at - before) / 1000) * Number($("speed").value));
      before = at;
      if (now >= last) setPlaying(false);
      else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  };

  charts.onCursor((x) => {
    if (!playing) show(x, "plot");
  });

  if (slider) {
    slider.min = String(first);
    slider.max = String(last);
    slider.addEventListener("input", () => show(Number(slider.value)));
    slider.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 1 : 0.1;
      const target = {
        ArrowLeft: now - step, ArrowDown: now - step, ArrowRight: now + step, ArrowUp: now + step,
        PageUp: now + (last - first) / 10, PageDown: now - (last - first) / 10, Home: first, End: last,
      }[event.key];
      if (target === undefined) return;
      event.preventDefault();
      show(target);
    });
    play.addEventListener("click", () => setPlaying(!playing));
    document.addEventListener("keydown", (event) => {
      if (event.key !== " " || event.target.closest("button, select, a, summary")) return;
      event.preventDefault();
      setPlaying(!playing);
    });
  }

  if (charts.list.length) {
    $("zoom-in").addEventListener("click", () => charts.zoom(0.5));
    $("zoom-out").addEventListener("click", () => charts.zoom(2));
    $("pan-left").addEventListener("click", () => charts.pan(-0.25));
    $("pan-right").addEventListener("click", () => charts.pan(0.25));
    $("zoom-all").addEventListener("click", () => charts.setRange(null));
  }

  const redraw = () => {
    charts.redraw();
    attitudeView.draw();
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  // Paper is white: draw for it, and as before afterwards.
  addEventListener("beforeprint", () => {
    document.documentElement.classList.add("paper");
    charts.resize(680);
    redraw();
  });
  addEventListener("afterprint", () => {
    document.documentElement.classList.remove("paper");
    charts.resize();
    redraw();
  });

  // the plots lay themselves out in a microtask; the cursor can be placed after it
  setTimeout(() => {
    show(first);
    document.documentElement.dataset.ready = "true";
  }, 0);
})();
