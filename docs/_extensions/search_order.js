/* The order of search results: guides first, records of decisions last. The other scores are Sphinx's own. */
var Scorer = {
  score: ([page, , , , score]) => {
    if (page.startsWith("decisions/")) return score - 12;
    return /^(how-to\/|tutorial$)/.test(page) ? score + 2 : score;
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
