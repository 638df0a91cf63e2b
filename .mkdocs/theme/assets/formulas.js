// SPDX-License-Identifier: MIT
// Typesets the formulas of a page with MathJax, from this site; loads it only for a page with formulas.
(() => {
  if (!document.querySelector(".arithmatex")) return;
  window.MathJax = {
    jax: ["input/TeX", "output/CommonHTML"],
    extensions: ["tex2jax.js"],
    tex2jax: {
      inlineMath: [["\\(", "\\)"]], displayMath: [["\\[", "\\]"]], processClass: "arithmatex", ignoreClass: ".*",
    },
    // Errors in formulas are shown, so that the test of the site finds them.
    TeX: {
      extensions: ["AMSmath.js", "AMSsymbols.js"], noErrors: { disabled: true }, noUndefined: { disabled: true },
    },
    CommonHTML: { linebreaks: { automatic: true, width: "container" }, undefinedFamily: "Roboto, sans-serif" },
    showMathMenu: false, showProcessingMessages: false, messageStyle: "none",
  };
  const script = document.createElement("script");
  script.src = new URL("mathjax/MathJax.js?config=TeX-AMS_CHTML", document.currentScript.src).href;
  document.head.append(script);
})();
