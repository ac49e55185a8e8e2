"use strict";

/**
 * What the end of `srgc synth` means to its user, by exit status.
 *
 * @param {number | undefined} status undefined if the run was ended from outside
 * @param {string} task
 * @returns {{ level: "information" | "warning" | "error", text: string, actions: string[] }}
 */
function synthesisOutcome(status, task) {
  switch (status) {
    case 0:
      return {
        level: "information",
        text: `${task}: a robot was found.`,
        actions: ["Open Report", "Verify"],
      };
    case 2:
      return {
        level: "warning",
        text: `${task}: srgc refused to begin; its terminal says why. Results of another file or seed are replaced only if you say so.`,
        actions: ["Replace Results"],
      };
    case 3:
      return {
        level: "warning",
        text: `${task}: impossible. No robot of the family can do it, which was proved.`,
        actions: ["Why", "Open Report", "Verify"],
      };
    case 4:
      return {
        level: "warning",
        text: `${task}: unknown. Neither a robot was found nor a proof that there is none.`,
        actions: ["Why"],
      };
    case 5:
      return { level: "error", text: `${task}: the file has errors.`, actions: ["Show Problems"] };
    case 130:
    case undefined:
      return {
        level: "information",
        text: `${task}: interrupted. The next synthesis goes on from there.`,
        actions: [],
      };
    default:
      return {
        level: "error",
        text: `${task}: srgc ended with status ${status}; see its terminal.`,
        actions: [],
      };
  }
}

/**
 * What the end of `srgc verify` means, by exit status.
 *
 * @param {number | null} status
 * @param {string} out what it printed; its first line is the verdict
 * @returns {{ level: "information" | "warning" | "error", text: string }}
 */
function verificationOutcome(status, out) {
  const first = out.split("\n", 1)[0].trim();
  if (status === 0) return { level: "information", text: first };
  if (status === 4) return { level: "warning", text: first || "undecided" };
  return { level: "error", text: first || "srgc verify did not come to an end" };
}

module.exports = { synthesisOutcome, verificationOutcome };
