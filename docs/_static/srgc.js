/* What the theme leaves out for keyboards and screen readers. */
document.addEventListener("DOMContentLoaded", () => {
  // The arrow keys scroll a region only if it can have the focus.
  const scrolls = new ResizeObserver((entries) => {
    for (const { target } of entries) {
      if (target.scrollWidth > target.clientWidth) target.tabIndex = 0;
      else target.removeAttribute("tabindex");
    }
  });
  for (const region of document.querySelectorAll("article pre, .table-wrapper, math[display=block]")) {
    scrolls.observe(region);
  }
  document.querySelector(".sidebar-drawer")?.setAttribute("aria-label", "Pages of the site");
  document.querySelector(".toc-drawer")?.setAttribute("aria-label", "Contents of this page");
});
