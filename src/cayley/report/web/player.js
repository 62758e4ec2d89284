// The player: reads scenes from the page or from the server of `cayley view`, and links picture, controls and plots.

const element = (id) => document.getElementById(id);
const PAGE = JSON.parse(element("page").textContent);
const MAPS = Object.fromEntries(Object.entries(PAGE.maps).map(([name, text]) => [name, fromBase64(text)]));
const PLAY_SECONDS = 10; // that a run takes at the speed it starts with, about
const PERIOD_SECONDS = 2; // that a period takes then

class Player {
  constructor() {
    this.now = 0;
    this.playing = false;
    this.color = { key: "", component: -1, map: "size" };
    this.selected = null;
    this.plots = [];
    this.loaded = PAGE.scenes.map(() => null);
    element("player").hidden = false;
    this.listen();
  }

  /** Show a scene; its frames are unpacked when it is first shown. */
  async open(number) {
    this.pause();
    this.wanted = number;
    const scene = this.loaded[number] || new Scene(PAGE.scenes[number]);
    if (!this.loaded[number]) {
      this.loaded[number] = scene;
      if (PAGE.live) while (await more(scene, number));
      else scene.append(await unzipped(fromBase64(element(`frames${number}`).textContent)));
    }
    if (this.wanted !== number) return; // another one was asked for meanwhile
    this.scene = scene;
    this.number = number;
    for (const row of document.querySelectorAll("[data-scene]"))
      row.setAttribute("aria-selected", Number(row.dataset.scene) === number);
    element("note").textContent = scene.note;
    element("player").classList.toggle("still", scene.frames === 1 && !PAGE.live);
    const rods = scene.parts.filter((part) => part.kind === "strand");
    element("rods").hidden = !rods.some((part) => part.quantities.length);
    document.querySelector(".halves > div").hidden = !scene.parts.length;
    document.querySelector(".halves").classList.toggle("one", element("rods").hidden || !scene.parts.length);
    if (scene.parts.length) {
      this.makePicture();
      if (this.picture) this.picture.show(scene);
    }
    this.fillControls(rods);
    this.buildPlots();
    this.go(scene.time.data[0]);
    if (scene.period && !matchMedia("(prefers-reduced-motion: reduce)").matches) this.play();
  }

  /** Without WebGL there are the plots alone. */
  makePicture() {
    const canvas = element("picture");
    if (this.picture || canvas.hidden) return;
    try {
      this.picture = new Picture(canvas, element("overlay"), MAPS);
    } catch (error) {
      canvas.hidden = true;
      element("trouble").hidden = false;
      element("trouble").textContent = `${error.message}.`;
      return;
    }
    const choose = (x, y) => this.choose(this.picture.pick(x, y));
    listen(
      canvas,
      () => this.picture.camera,
      () => this.draw(),
      choose,
    );
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  get first() {
    return this.scene.time.data[0];
  }

  get last() {
    return this.scene.time.data[this.scene.frames - 1];
  }

  listen() {
    const on = (id, event, action) => element(id).addEventListener(event, action);
    on("play", "click", () => (this.playing ? this.pause() : this.play()));
    on("slider", "input", () => {
      this.pause();
      this.go(Number(element("slider").value));
    });
    on("scene", "change", () => this.open(Number(element("scene").value)));
    on("color", "change", () => this.recolor());
    for (const id of ["thickness", "frames", "ports"]) on(id, "change", () => this.draw());
    on("quantity", "change", () => this.buildRodPlots());
    on("part", "change", () => this.choose(this.middle(Number(element("part").value))));
    on("node", "input", () => this.choose({ part: this.selected.part, node: Number(element("node").value) }));
    for (const row of document.querySelectorAll("[data-scene]")) {
      const choose = () => this.open(Number(row.dataset.scene));
      row.addEventListener("click", choose);
      row.addEventListener("keydown", (event) => event.key === "Enter" && choose());
    }
    for (const button of document.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => {
        if (!this.picture) return;
        this.picture.camera.look(button.dataset.view);
        this.picture.fit();
        this.draw();
      });
    }
    document.addEventListener("keydown", (event) => {
      if (/^(INPUT|SELECT|BUTTON|TEXTAREA|SUMMARY)$/.test(event.target.tagName)) return;
      const steps = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (event.key === " ") this.playing ? this.pause() : this.play();
      else if (steps) this.step(steps);
      else return;
      event.preventDefault();
    });
  }

  fillControls(rods) {
    const { scene } = this;
    const fill = (id, rows) => {
      const before = element(id).value; // stays chosen if it is there
      element(id).replaceChildren(...rows.map(([value, text]) => new Option(text, value, false, `${value}` === before)));
    };
    const names = PAGE.scenes.map((one, k) => [k, one.name]);
    fill("scene", names);
    element("scene").value = this.number;
    element("scenes").hidden = PAGE.scenes.length < 2;
    const known = new Map(scene.parts.flatMap((part) => part.quantities.map((one) => [one.key, one])));
    const colors = [...known.values()].flatMap((one) => [
      [`${one.key}/-1`, one.axes ? `‖${one.label}‖` : one.label],
      ...(one.axes || []).map((axis, k) => [`${one.key}/${k}`, `${one.label} ${axis}`]),
    ]);
    this.known = known;
    fill("color", [...colors, ["/", "nothing"]]);
    fill(
      "part",
      rods.map((part) => [scene.parts.indexOf(part), part.name]),
    );
    fill("quantity", rods.length ? rods[0].quantities.map((one) => [one.key, one.label]) : []);
    this.selected = element("rods").hidden ? null : this.middle(Number(element("part").value));
    this.fillSpeeds();
    this.recolor();
    this.span();
  }

  middle(part) {
    return { part, node: this.scene.parts[part].nodes >> 1 };
  }

  fillSpeeds() {
    const seconds = this.scene.period ? PERIOD_SECONDS : PLAY_SECONDS;
    const usual = roundUp(Math.max(this.last - this.first, 1e-9) / seconds);
    const speeds = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10].map((factor) =>
      Number((factor * usual).toPrecision(1)),
    );
    const all = [...new Set([...speeds, 1])].sort((a, b) => a - b);
    element("speed").replaceChildren(
      ...all.map((speed) => new Option(speed === 1 ? "real time" : `${shown(speed)} ×`, speed)),
    );
    element("speed").value = Number(usual.toPrecision(1));
  }

  /** The ends of the slider. */
  span() {
    Object.assign(element("slider"), { min: this.first, max: this.last });
  }

  recolor() {
    const [key, component] = element("color").value.split("/");
    const one = this.known.get(key);
    const signed = one && one.axes && Number(component) >= 0;
    this.color = { key, component: Number(component), map: signed ? "signed" : "size" };
    this.rescale();
    element("colorbar").hidden = !one;
    if (!one) return this.draw();
    const text = element("color").selectedOptions[0].textContent;
    element("colorname").textContent = one.unit === "1" ? text : `${text} [${one.unit}]`;
    const pen = document.querySelector("#colorbar canvas").getContext("2d");
    for (let k = 0; k < 128; k++) {
      pen.fillStyle = `rgb(${MAPS[this.color.map].subarray(3 * (255 - 2 * k), 3 * (255 - 2 * k) + 3).join(",")})`;
      pen.fillRect(0, k, 1, 1);
    }
    this.draw();
  }

  /** The range of the colors, from all frames. */
  rescale() {
    const most = (this.color.key && this.scene.largest(this.color)) || 1;
    this.range = this.color.map === "signed" ? [-most, most] : [0, most];
    const [low, high] = this.range;
    for (const [id, value] of [
      ["low", low],
      ["middle", 0.5 * (low + high)],
      ["high", high],
    ])
      element(id).textContent = shown(value, 3);
  }

  buildPlots() {
    for (const plot of this.plots) plot.remove();
    const time = this.scene.time.column(0);
    this.plots = this.scene.graphs.map(
      (graph) =>
        new Plot(
          element("graphs"),
          {
            title: graph.title,
            unit: graph.unit,
            names: graph.names,
            across: "time [s]",
            shade: this.scene.shade,
            linked: true,
          },
          [time, ...graph.names.map((_, k) => graph.channel.column(k))],
          (at) => this.seek(at),
        ),
    );
    this.buildRodPlots();
  }

  /** The plots of the chosen rod: along it, and over the time at the chosen node. */
  buildRodPlots() {
    for (const plot of [this.along, this.over]) if (plot) plot.remove();
    this.along = this.over = null;
    if (!this.selected) return;
    const part = this.scene.parts[this.selected.part];
    const one = this.chosen();
    const names = one.axes ? [...one.axes, "‖·‖"] : [one.label];
    const range = () => {
      const most = 1.05 * this.scene.largest({ key: one.key, component: -1 }, part) || 1;
      return [one.axes ? -most : 0, most]; // of all frames, so that it stays while the animation plays
    };
    const about = { unit: one.unit, names, shade: this.scene.shade };
    this.along = new Plot(
      element("along"),
      {
        ...about,
        title: `${one.label} along ${part.name}`,
        across: "arc length [m]",
        shade: null,
        range,
      },
      this.alongData(),
      (at) => this.choose({ part: this.selected.part, node: nearest(part.s, at) }),
    );
    this.over = new Plot(
      element("over"),
      { ...about, title: `${one.label} over the time`, across: "time [s]", linked: true },
      this.overData(),
      (at) => this.seek(at),
    );
    this.showNode();
    this.markTime();
  }

  chosen() {
    const part = this.scene.parts[this.selected.part];
    return part.quantities.find((one) => one.key === element("quantity").value) || part.quantities[0];
  }

  alongData() {
    const part = this.scene.parts[this.selected.part];
    const one = this.chosen();
    const frame = Math.round(this.scene.frameAt(this.now));
    const row = one.channel.row(frame);
    const components = one.axes ? [0, 1, 2, -1] : [-1];
    return [part.s, ...components.map((component) => Array.from(colored(one, row, component)))];
  }

  overData() {
    const one = this.chosen();
    const { node } = this.selected;
    const columns = one.axes ? [0, 1, 2].map((c) => one.channel.column(3 * node + c)) : [one.channel.column(node)];
    const sizes = one.axes ? [columns[0].map((x, k) => Math.hypot(x, columns[1][k], columns[2][k]))] : [];
    return [this.scene.time.column(0), ...columns, ...sizes];
  }

  /** Choose a node, in the picture, by the slider or in the plot along the rod. */
  choose(place) {
    if (!place || !this.selected) return;
    const moved = place.part !== this.selected.part;
    this.selected = place;
    element("part").value = place.part;
    if (moved) this.buildRodPlots();
    else {
      this.over.set(this.overData(), true);
      this.showNode();
    }
    this.draw();
  }

  showNode() {
    const part = this.scene.parts[this.selected.part];
    const { node } = this.selected;
    Object.assign(element("node"), { max: part.nodes - 1 });
    element("node").value = node;
    element("nodename").textContent = `${node} (s = ${shown(part.s[node])} m)`;
    this.over.element.querySelector(".u-title").textContent = `${this.chosen().label} at node ${node} over the time`;
    this.along.mark(part.s[node]);
  }

  markTime() {
    for (const plot of [...this.plots, this.over]) if (plot) plot.mark(this.now);
  }

  /** Go to a time. */
  go(time) {
    this.now = Math.min(this.last, Math.max(this.first, time));
    element("slider").value = this.now;
    element("clock").textContent = `t = ${shown(this.now, 5)} s`;
    if (this.along) this.along.set(this.alongData(), true);
    if (this.along) this.along.mark(this.scene.parts[this.selected.part].s[this.selected.node]);
    this.markTime();
    this.draw();
  }

  seek(time) {
    this.pause();
    this.go(time);
  }

  step(frames) {
    this.pause();
    const frame = Math.round(this.scene.frameAt(this.now)) + frames;
    this.go(this.scene.time.data[Math.min(this.scene.frames - 1, Math.max(0, frame))]);
  }

  play() {
    this.pause();
    this.playing = true;
    element("play").textContent = "❚❚";
    if (this.now >= this.last) this.go(this.first);
    let before = performance.now();
    const turn = (now) => {
      const next = this.now + (Number(element("speed").value) * (now - before)) / 1000;
      before = now;
      const again = this.first + (this.scene.period ? next - this.last : 0);
      this.go(next > this.last && !PAGE.live ? again : next);
      this.turn = requestAnimationFrame(turn);
    };
    this.turn = requestAnimationFrame(turn);
  }

  pause() {
    this.playing = false;
    cancelAnimationFrame(this.turn);
    element("play").textContent = "▶";
  }

  draw() {
    if (!this.picture || !this.scene.parts.length || this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.picture.draw({
        frame: this.scene.frameAt(this.now),
        color: this.color,
        range: this.range,
        thickness: Number(element("thickness").value),
        frames: element("frames").checked,
        ports: element("ports").checked,
        selected: this.selected,
      });
    });
  }

  /** There are more frames: widen slider, room, colors and plots; stay at the end if the time was there. */
  grown(atEnd) {
    const { scene } = this;
    this.span();
    this.rescale();
    if (this.picture) this.picture.widen();
    const time = scene.time.column(0);
    this.plots.forEach((plot, i) => {
      const graph = scene.graphs[i];
      plot.set([time, ...graph.names.map((_, k) => graph.channel.column(k))]);
    });
    if (this.over) this.over.set(this.overData());
    this.go(atEnd && !this.playing ? this.last : this.now);
  }
}

function nearest(values, at) {
  return values.reduce((best, value, k) => (Math.abs(value - at) < Math.abs(values[best] - at) ? k : best), 0);
}

async function start() {
  try {
    const player = new Player();
    window.player = player; // for those who want to look inside
    await player.open(0);
    if (PAGE.live) follow(player);
  } catch (error) {
    element("trouble").hidden = false;
    element("trouble").textContent = `The player stopped: ${error.message}`;
    throw error;
  }
}

start();
