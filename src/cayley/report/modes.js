// Draws a mode: points x + Re(u exp(i t)) along parallel lines of sight, lines between them.
(() => {
  const data = JSON.parse(document.getElementById("modes-data").textContent);
  const canvas = document.getElementById("stage"), pen = canvas.getContext("2d");
  const rows = [...document.querySelectorAll("tr[data-mode]")];
  const play = document.getElementById("play"), size = document.getElementById("size");
  const colors = ["#0072b2", "#0072b2", "#d55e00"], widths = [2.2, 1, 1.2];
  const motion = window.matchMedia("(prefers-reduced-motion: reduce)");
  let mode = 0, phase = 0, playing = !motion.matches, last = null, azimuth = -1.0472, elevation = 0.3142, drag = null;

  const middle = [0, 1, 2].map((k) => {
    const all = data.points.map((p) => p[k]);
    return (Math.min(...all) + Math.max(...all)) / 2;
  });
  function seen(p) {
    const [x, y, z] = p.map((c, k) => c - middle[k]);
    const [ca, sa, ce, se] = [Math.cos(azimuth), Math.sin(azimuth), Math.cos(elevation), Math.sin(elevation)];
    return [-sa * x + ca * y, -(-se * ca * x - se * sa * y + ce * z)];
  }

  function moved(part) {
    const [re, im] = data.moves[mode], c = part * Math.cos(phase), s = part * Math.sin(phase);
    return data.points.map((p, n) => p.map((x, k) => x + c * re[n][k] - s * im[n][k]));
  }

  function lines(points, color, scale) {
    const flat = points.map(seen), rest = data.points.map(seen);
    const [wide, tall] = [0, 1].map((k) => Math.max(...rest.map((p) => Math.abs(p[k]))) + data.shown);
    const one = 0.46 * Math.min(canvas.width / wide, canvas.height / tall);
    const at = (n) => [canvas.width / 2 + one * flat[n][0], canvas.height / 2 + one * flat[n][1]];
    data.lines.forEach(([a, b, kind]) => {
      pen.strokeStyle = color || colors[kind];
      pen.lineWidth = scale * widths[kind] * window.devicePixelRatio;
      pen.beginPath();
      pen.moveTo(...at(a));
      pen.lineTo(...at(b));
      pen.stroke();
    });
  }

  function draw() {
    const box = canvas.getBoundingClientRect(), ratio = window.devicePixelRatio;
    if (canvas.width !== Math.round(box.width * ratio)) {
      canvas.width = Math.round(box.width * ratio);
      canvas.height = Math.round(box.height * ratio);
    }
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.lineCap = "round";
    lines(data.points, "#c4c4c4", 0.6);
    lines(moved(Number(size.value)), null, 1);
  }

  function frame(time) {
    if (last !== null && playing) phase += (time - last) * 2 * Math.PI / 1600; // shown at one speed, whatever the frequency
    last = time;
    draw();
    if (playing) requestAnimationFrame(frame);
  }

  function start(wanted) {
    playing = wanted;
    play.textContent = playing ? "Pause" : "Play";
    last = null;
    requestAnimationFrame(frame);
  }

  function choose(k) {
    mode = k;
    phase = 0;
    rows.forEach((row) => row.setAttribute("aria-selected", String(Number(row.dataset.mode) === k)));
    draw();
  }

  rows.forEach((row) => {
    row.addEventListener("click", () => choose(Number(row.dataset.mode)));
    row.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      choose(Number(row.dataset.mode));
    });
  });
  play.addEventListener("click", () => start(!playing));
  size.addEventListener("input", draw);
  canvas.addEventListener("pointerdown", (event) => {
    drag = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) return;
    azimuth -= (event.clientX - drag[0]) / 150;
    elevation = Math.max(-1.57, Math.min(1.57, elevation + (event.clientY - drag[1]) / 150));
    drag = [event.clientX, event.clientY];
    draw();
  });
  canvas.addEventListener("pointerup", () => { drag = null; });
  window.addEventListener("resize", draw);
  choose(Number(new URLSearchParams(location.search).get("mode")) || Number(rows[0]?.dataset.mode) || 0);
  start(playing);
})();
