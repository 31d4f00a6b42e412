// How the search orders what it finds: what is to be read before tests and the grader's own pages.
const PLACES = [["course/", 8], ["articles/isoref/isoref.", 6], ["start/", 6], ["learn/", 4], ["papers/", 4],
  ["articles/isograde/", -4], ["reports/", -2], ["changelog", -8], ["tests/", -14]];
var Scorer = {
  score: ([page, title, anchor, description, score]) =>
    score + (PLACES.find(([start]) => page.startsWith(start)) ?? ["", 0])[1],
  // As Sphinx has them, but for names and titles, which tell a page better than its words do.
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 20,
  partialTitle: 10,
  term: 5,
  partialTerm: 2,
};
