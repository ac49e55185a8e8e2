// Hovering or focusing a symbol of the word, its module in the picture, its row in the table or its
// leaf in the derivation tree marks all four.
(function () {
  "use strict";
  const marks = Array.from(document.querySelectorAll("#robot [data-symbol], #derivation [data-symbol]"));

  function light(symbol) {
    marks.forEach((mark) => mark.classList.toggle("lit", mark.dataset.symbol === symbol));
  }

  marks.forEach((mark) => {
    mark.addEventListener("pointerenter", () => light(mark.dataset.symbol));
    mark.addEventListener("pointerleave", () => light(""));
    // Parts of pictures that listen to the focus would be stops of the tab key in some browsers.
    if (!(mark instanceof HTMLElement)) return;
    mark.addEventListener("focus", () => light(mark.dataset.symbol));
    mark.addEventListener("blur", () => light(""));
  });
})();
