// SPDX-License-Identifier: MIT
// In pages of the API reference: the light or dark scheme that was chosen on the site, and a button to
// change it.
(() => {
  const key = `${new URL("..", location).pathname}.__palette`;
  const wants = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => {
    const stored = JSON.parse(localStorage.getItem(key));
    return stored ? stored.color.scheme === "slate" : wants.matches;
  };
  const apply = () => {
    document.documentElement.classList.toggle("dark-mode", isDark());
    document.documentElement.classList.toggle("light-mode", !isDark());
  };
  apply();
  wants.addEventListener("change", apply);
  addEventListener("DOMContentLoaded", () => document.getElementById("scheme").addEventListener("click", () => {
    const dark = !isDark();
    const color = { scheme: dark ? "slate" : "default", primary: "", accent: "" };
    localStorage.setItem(key, JSON.stringify({ index: Number(dark), color }));
    apply();
  }));
})();
