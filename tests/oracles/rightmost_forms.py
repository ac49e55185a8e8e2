"""What an LR(1) parser may do, by the definition: from rightmost derivations, without items.

Knuth 1965: after the prefix g with a next, reducing by A -> h is right where some rightmost
derivation ends in a step x A y => x h y with g = x h and a the first of y; shifting where some
right sentential form has a right side across g and the terminal a after it.  Forms are kept as
(part up to the last symbol not yet derived to its end, first terminal after it).
"""

from __future__ import annotations

from collections.abc import Sequence

Rules = Sequence[tuple[int, tuple[int, ...]]]
Actions = dict[tuple[tuple[int, ...], int], set[int | str]]


def first_sets(terminals: int, rules: Rules) -> tuple[dict[int, set[int]], set[int]]:
    """FIRST per symbol, and the nonterminals that derive the empty word, by repetition."""
    first: dict[int, set[int]] = {t: {t} for t in range(terminals)}
    empty: set[int] = set()
    before = None
    while before != (sum(map(len, first.values())), len(empty)):
        before = (sum(map(len, first.values())), len(empty))
        for left, right in rules:
            known = first.setdefault(left, set())
            for symbol in right:
                known |= first.get(symbol, set())
                if symbol not in empty:
                    break
            else:
                empty.add(left)
    return first, empty


def lr_actions(terminals: int, rules: Rules, start: int, longest: int) -> Actions:
    """All actions after all prefixes of up to ``longest`` symbols; all rules must be useful.

    A rule by number, "shift", or "accept"; the end is the number ``terminals``.
    """
    first, empty = first_sets(terminals, rules)
    actions: Actions = {}
    todo: list[tuple[tuple[int, ...], int]] = [((start,), terminals)] if rules else []
    seen = set(todo)
    if rules:
        actions[(start,), terminals] = {"accept"}
    for form, ahead in todo:
        if not form:
            continue
        head, last = form[:-1], form[-1]
        found = [(head, symbol) for symbol in first[last]]
        if last in empty:
            found.append((head, ahead))
        # What is expanded beyond ``longest`` cannot come back to act on a shorter prefix.
        for r in [r for r, rule in enumerate(rules) if rule[0] == last and len(head) <= longest]:
            right = rules[r][1]
            found.append((head + right, ahead))
            actions.setdefault((head + right, ahead), set()).add(r)
            _shifts(actions, terminals, head, right)
        todo += [state for state in dict.fromkeys(found) if state not in seen]
        seen.update(found)
    return {key: value for key, value in actions.items() if len(key[0]) <= longest}


def _shifts(
    actions: Actions, terminals: int, head: tuple[int, ...], right: tuple[int, ...]
) -> None:
    for i, symbol in enumerate(right):
        if symbol < terminals:
            actions.setdefault((head + right[:i], symbol), set()).add("shift")
