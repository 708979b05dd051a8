// Begins: reads the data, draws, and follows the choice between light and dark.

const data = JSON.parse(document.getElementById("data").textContent);
const root = document.documentElement;
const dark = window.matchMedia("(prefers-color-scheme: dark)");
const button = document.getElementById("theme");
let chosen = null;
let view = null;
let plots = null;

function dress() {
  const isDark = chosen === null ? dark.matches : chosen === "dark";
  root.dataset.theme = isDark ? "dark" : "light";
  button.textContent = isDark ? "Light" : "Dark";
  button.setAttribute("aria-label", isDark ? "Switch to light colours" : "Switch to dark colours");
  view?.dress();
  plots?.draw();
}

button.addEventListener("click", () => {
  chosen = root.dataset.theme === "dark" ? "light" : "dark";
  dress();
});
dark.addEventListener("change", dress);
dress();

const hasWebgl = () => {
  const canvas = document.createElement("canvas");
  return Boolean(window.WebGL2RenderingContext && canvas.getContext("webgl2"));
};

plots = new Plots(data.plots);
if (data.view && hasWebgl()) {
  view = new View(data.view, data.fields);
  view.dress();
} else if (data.view) {
  document.getElementById("no-webgl").hidden = false;
}
root.dataset.ready = "true";
