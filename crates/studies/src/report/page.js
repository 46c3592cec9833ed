// Shows the note of the point that is pointed at. Without this script browsers show the same note of an SVG title,
// but not to a finger.
(() => {
  const NEAR = 22; // pixels: half a fingertip
  const box = document.createElement("div");
  box.id = "note";
  box.setAttribute("role", "status");
  document.body.appendChild(box);
  let shown = null;
  const show = (hint) => {
    if (hint === shown) return;
    if (shown) shown.classList.remove("shown");
    shown = hint;
    box.classList.toggle("open", Boolean(hint));
    if (!hint) return;
    hint.classList.add("shown");
    box.textContent = hint.dataset.note;
    const at = hint.getBoundingClientRect();
    const size = box.getBoundingClientRect();
    const left = Math.min(Math.max(8, at.left + at.width / 2 - size.width / 2), innerWidth - size.width - 8);
    const above = at.top - size.height - 8;
    box.style.left = `${Math.max(0, left)}px`;
    box.style.top = `${above > 4 ? above : at.bottom + 8}px`;
  };
  const nearest = (svg, x, y) => {
    let best = null, least = NEAR;
    for (const hint of svg.querySelectorAll(".hint")) {
      const r = hint.getBoundingClientRect();
      const far = Math.hypot(x - r.left - r.width / 2, y - r.top - r.height / 2);
      if (far < least) { best = hint; least = far; }
    }
    return best;
  };
  for (const svg of document.querySelectorAll("figure svg")) {
    for (const hint of svg.querySelectorAll(".hint")) {
      const title = hint.querySelector("title");
      hint.dataset.note = title.textContent;
      hint.setAttribute("aria-label", title.textContent);
      title.remove(); // or the browser shows it a second time
    }
    svg.addEventListener("pointermove", (e) => { if (e.pointerType === "mouse") show(nearest(svg, e.clientX, e.clientY)); });
    svg.addEventListener("pointerleave", (e) => { if (e.pointerType === "mouse") show(null); });
    svg.addEventListener("click", (e) => show(nearest(svg, e.clientX, e.clientY)));
  }
  document.addEventListener("click", (e) => { if (!e.target.closest("figure svg")) show(null); });
  addEventListener("scroll", () => show(null), { passive: true });
})();
