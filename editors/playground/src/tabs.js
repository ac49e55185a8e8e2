// Tabs as the ARIA Authoring Practices Guide has them: arrow keys move, Home and End too.

export class Tabs {
  // `shown` is called with the id of the panel that is now shown.
  constructor(list, shown) {
    this.tabs = [...list.querySelectorAll("[role=tab]")];
    this.shown = shown;
    this.tabs.forEach((tab) => tab.addEventListener("click", () => this.choose(tab.getAttribute("aria-controls"))));
    list.addEventListener("keydown", (event) => {
      const count = this.tabs.length;
      const now = this.tabs.indexOf(document.activeElement);
      const next = { ArrowRight: now + 1, ArrowLeft: now - 1 + count, Home: 0, End: count - 1 }[event.key];
      if (next === undefined) return;
      event.preventDefault();
      const tab = this.tabs[next % count];
      tab.focus();
      this.choose(tab.getAttribute("aria-controls"));
    });
    this.choose(this.tabs[0].getAttribute("aria-controls"));
  }

  choose(id) {
    this.chosen = id;
    for (const tab of this.tabs) {
      const own = tab.getAttribute("aria-controls");
      tab.setAttribute("aria-selected", String(own === id));
      tab.tabIndex = own === id ? 0 : -1;
      document.getElementById(own).hidden = own !== id;
    }
    this.shown(id);
  }
}
