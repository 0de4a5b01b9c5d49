"""Forces that cannot have changed: a block in the same states as at the last evaluation of a step keeps them.

So bodies at rest are solved for once in a step. Kept forces belong to the modes and parameters of the step.
"""

from lagc.kernels.language.vocabulary import *


def keep_block(block: int, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> None:
    """Keep the rates and forces of a block that is solved, for other evaluations of this step."""
    if w.contacts.keeps and block_timed[block] == 0:
        w.contacts.known[block] = 1
        for c in range(state_begin[block], state_end[block]):
            i = block_state[c]
            w.contacts.kept_x[i] = x[i]
            w.contacts.kept_rates[i] = xdot[i]
        for k in range(NC):
            if equation_block[k] == block:
                w.contacts.kept_lam[k] = lam[k]
        for n in range(w.contacts.law.rows):
            row = w.contacts.touching_rows[n]
            w.contacts.kept_forces[row] = w.contacts.forces[row]
            w.contacts.kept_pushes[row] = w.contacts.pushes[row]


def recall_block(block: int, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> bool:
    """Take the rates and forces of a block that were solved for in these states, and clear w.contacts.touched
    of its contacts; return whether they were."""
    for c in range(state_begin[block], state_end[block]):
        i = block_state[c]
        if w.contacts.known[block] == 0 or not x[i] == w.contacts.kept_x[i]:
            w.contacts.known[block] = 0
            return False
    for c in range(state_begin[block], state_end[block]):
        xdot[block_state[c]] = w.contacts.kept_rates[block_state[c]]
    for k in range(NC):
        if equation_block[k] == block:
            lam[k] = w.contacts.kept_lam[k]
    for c in range(contact_begin[block], contact_end[block]):
        i = block_contact[c]
        if w.contacts.touched[i] > 0:
            w.contacts.touched[i] = 0
            for row in range(contact_first[i], contact_first[i] + contact_slips[i] + 1):
                w.contacts.forces[row] = w.contacts.kept_forces[row]
                w.contacts.pushes[row] = w.contacts.kept_pushes[row]
    return True


def recall_blocks(x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> bool:
    """Recall blocks whose states have not changed within the step, as those at rest. Return whether contacts
    of others touch."""
    if w.contacts.keeps:
        for block in range(NBLOCK):
            recall_block(block, x, xdot, lam, w)
    for i in range(NCON):
        if w.contacts.touched[i] > 0:
            return True
    return False


def keep_blocks(keeps: bool, w: Work) -> None:
    """Let evaluations keep what they solve, or no longer; nothing is known yet, nor whether contacts touch."""
    w.contacts.flies = False
    w.contacts.keeps = keeps
    for block in range(NBLOCK):
        w.contacts.known[block] = 0
