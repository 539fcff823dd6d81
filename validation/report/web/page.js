// Starts the views, and makes the page's terms, links and buttons work.

/// Shows what a row is about: a region, a valve, a surface or a mesh, in the colour that tells of it.
function showNamed(viewer, panel, name, color) {
  const { view, state } = viewer, parts = view.parts;
  const ofSurface = [...view.surfaces.values()].find((s) => s.name === name);
  const tests = [(part) => part.name === name, (part) => ofSurface && part.surface.includes(ofSurface.tag), (part) => part.mesh === name && part.group !== "valves"];
  const test = tests.find((t) => parts.some(t));
  if (!test) return;
  for (const part of parts) part.visible = test(part);
  const isSurface = test === tests[1];
  const known = color === "quality" || view.fields[color];
  Object.assign(state, { color: isSurface && !known ? "surface" : known ? color : state.color, highlight: isSurface ? name : null, cut: "none" });
  if (color === "helix" || color === "difference") state.fibers = "plain";
  viewer.fit();
  panel.refresh();
  const flattest = color === "quality" ? flattestHit(parts) : null;
  panel.showFacts(flattest);
  if (flattest) viewer.faceTo(flattest.point);
}

function addTerms() {
  const box = element("div", { id: "term", hidden: true, role: "status" });
  document.body.append(box);
  document.addEventListener("click", (event) => {
    const term = event.target.closest("[data-term]");
    box.hidden = !term;
    if (!term) return;
    const text = document.getElementById("term-" + term.dataset.term);
    box.replaceChildren(element("b", {}, term.textContent), " " + (text ? text.textContent : ""));
    const place = term.getBoundingClientRect();
    box.style.left = clamp(place.left, 12, Math.max(12, window.innerWidth - box.offsetWidth - 12)) + "px";
    box.style.top = (place.bottom + box.offsetHeight + 14 > window.innerHeight ? place.top - box.offsetHeight - 6 : place.bottom + 6) + "px";
  });
  window.addEventListener("scroll", () => (box.hidden = true), { passive: true });
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") box.hidden = true;
  });
}

function addCopyButtons() {
  for (const made of document.querySelectorAll("[data-copy]"))
    made.addEventListener("click", async () => {
      const source = document.getElementById(made.dataset.copy);
      const range = document.createRange();
      range.selectNodeContents(source);
      window.getSelection().removeAllRanges();
      window.getSelection().addRange(range);
      const isCopied = document.execCommand("copy");
      made.textContent = isCopied ? "copied" : "selected: copy it now";
    });
}

/// A link into something folded opens it.
function openFoldedTargets() {
  const open = () => {
    const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    for (let at = target; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
    if (target) target.scrollIntoView();
  };
  window.addEventListener("hashchange", open);
}

async function startPage() {
  addTerms();
  addCopyButtons();
  openFoldedTargets();
  const [model, image] = await Promise.all([pageData("model"), pageData("image")]);
  let slices = null, viewer = null, panel = null;
  const root = document.getElementById("viewer"), planes = document.getElementById("slices");
  if (model && root) viewer = makeViewer(root, model);
  if (image && planes) slices = makeSlices(planes, image, (lps) => viewer && viewer.markPlace(lps));
  if (viewer) {
    panel = addPanel(viewer, root.querySelector(".panel"));
    addHands(viewer, (hit) => {
      const lps = panel.showFacts(hit);
      if (lps && slices) slices.goTo(lps);
    });
    viewer.fit();
    for (const link of document.querySelectorAll("[data-show]"))
      link.addEventListener("click", () => showNamed(viewer, panel, link.dataset.show, link.dataset.color));
  }
  document.documentElement.dataset.ready = "true"; // for those who drive the page by a program
}

startPage().catch((error) => {
  document.documentElement.dataset.ready = "failed";
  for (const root of document.querySelectorAll("#viewer, #slices")) root.classList.add("no-webgl");
  console.error(error);
});
