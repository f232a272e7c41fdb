// Lists beside the scene: what can be shown, why a plan is refused, its limits, and the layers.

/** An element with properties and children. */
function made(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

/** Rows of tracks: one is shown, others beside it. */
function listTracks(element, tracks, shown, beside, choose, accompany) {
  element.querySelectorAll(".run").forEach((row) => row.remove());
  for (const track of tracks) {
    const radio = made("input", { type: "radio", name: "run", checked: track === shown });
    radio.addEventListener("change", () => choose(track));
    const swatch = made("i", { className: "swatch" });
    swatch.style.background = track.color;
    const label = made("label", {}, radio, swatch, made("span", { textContent: track.name }), " ",
      made("small", { textContent: track.verdict, className: verdictClass(track) }));
    const row = made("div", { className: "run" }, label);
    if (tracks.length > 1) {
      const box = made("input", { type: "checkbox", checked: beside.has(track), disabled: track === shown });
      box.setAttribute("aria-label", `Show ${track.name} beside the chosen one`);
      box.addEventListener("change", () => accompany(track, box.checked));
      row.append(made("label", { className: "beside", title: "Show beside the chosen one" }, box, "beside"));
    }
    element.append(row);
  }
}

function verdictClass(track) {
  return { feasible: "good", clear: "good", infeasible: "bad", inadmissible: "bad", "violates limits": "bad" }[track.verdict] || "";
}

/** Sentences as a list; the section hides where there are none. */
function listSentences(section, sentences) {
  section.hidden = !sentences.length;
  section.querySelector("ul").replaceChildren(...sentences.map((text) => made("li", { textContent: text })));
}

/** How it is known that a limit is kept: a mark, and what it means. */
const KEPT = {
  proved: ["✓", "proved at every instant"],
  sampled: ["○", "kept at the instants that were looked at"],
  broken: ["✗", "broken"],
};

/** The limits, the tightest first; a row with a moment goes there. */
function listLimits(section, track, seek) {
  section.querySelectorAll("table, .kept").forEach((element) => element.remove());
  section.hidden = !track.limits.length;
  if (section.hidden) return;
  const head = ["", "limit", "value", "allowed", "at"].map((text) => made("th", { textContent: text, scope: "col" }));
  head[0].setAttribute("aria-label", "how it is known");
  const rows = track.limits.map((row) => {
    const at = made("td");
    if (row.time === null) at.textContent = "–";
    else {
      const jump = made("button", { type: "button", textContent: `${row.time.toFixed(1)} s` });
      jump.setAttribute("aria-label", `Go to ${row.time.toFixed(1)} s: ${row.limit}`);
      jump.addEventListener("click", () => seek(row.time));
      at.append(jump);
    }
    const name = made("th", { scope: "row", textContent: row.limit }, made("small", { textContent: row.of }));
    const classes = [row.ok ? "" : "broken", row === track.tightest ? "tightest" : ""].join(" ");
    const [mark, meaning] = KEPT[row.kept];
    const known = made("td", { className: `mark ${row.kept}`, textContent: mark, title: [meaning, row.bound].filter(Boolean).join(", ") });
    known.setAttribute("aria-label", known.title);
    return made("tr", { className: classes.trim() }, known, name,
      made("td", { textContent: row.value }), made("td", { textContent: row.allowed }), at);
  });
  const used = Object.keys(KEPT).filter((name) => track.limits.some((row) => row.kept === name));
  const told = used.map((name) => KEPT[name].join(" ")).join(" · ");
  section.append(made("p", { className: "kept", textContent: told }));
  section.append(made("table", {}, made("thead", {}, made("tr", {}, ...head)), made("tbody", {}, ...rows)));
}

const LAYERS = {
  obstacles: "Obstacles", warning: "Warning areas", regions: "Free regions", route: "Way through regions",
  robots: "Robots", cables: "Load and cables", path: "Ways", ground: "Ground and scales",
  workspace: "Workspace", labels: "Labels",
};

/** Check boxes of the layers that a scene has. */
function listLayers(fieldset, stage, changed) {
  fieldset.querySelectorAll("label").forEach((label) => label.remove());
  const there = [...stage.layers.keys()], moving = stage.data.payload ? ["robots", "cables"] : [];
  const names = Object.keys(LAYERS).filter((name) => there.includes(name) || moving.includes(name) || name === "labels");
  names.push(...there.filter((name) => name.startsWith("shadow ")));
  for (const name of names) {
    const box = made("input", { type: "checkbox", checked: !stage.hidden.has(name), value: name });
    box.addEventListener("change", () => changed(name, box.checked));
    fieldset.append(made("label", {}, box, layerName(name, stage.data)));
  }
}

function layerName(name, data) {
  if (name === "regions") return `Free regions (${data.regions.count})`;
  if (!name.startsWith("shadow ")) return LAYERS[name];
  const who = name.slice(7);
  return who === "load" ? "Where the load would touch" : `Shadows for ${who}`;
}
