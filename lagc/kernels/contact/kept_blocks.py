"""Forces that cannot have changed: a block in the same states as at the last evaluation keeps them.

So bodies at rest are solved for once. Kept forces belong to the parameters of a call and the modes of
relations.
"""

from lagc.kernels.language.vocabulary import *


def keep_block(block: int, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> None:
    """Keep the rates and forces of a block that is solved, for other evaluations in the same states and modes
    of contacts."""
    w.contacts.known[block] = 1 if w.contacts.keeps and block_timed[block] == 0 else 0
    if w.contacts.known[block] > 0:
        for c in range(contact_begin[block], contact_end[block]):
            i = NX - NCON + block_contact[c]
            w.contacts.kept_x[i] = x[i]
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


def is_kept(block: int, x: Vec[NX], w: Work) -> bool:
    """Return whether a block was solved for in these states and modes."""
    if w.contacts.known[block] == 0:
        return False
    for c in range(contact_begin[block], contact_end[block]):
        i = NX - NCON + block_contact[c]
        if not x[i] == w.contacts.kept_x[i]:
            return False
    for c in range(state_begin[block], state_end[block]):
        i = block_state[c]
        if not x[i] == w.contacts.kept_x[i]:
            return False
    return True


def is_at_rest(block: int, w: Work) -> bool:
    """Return whether the rates of a block that is kept are zero."""
    for c in range(state_begin[block], state_end[block]):
        if w.contacts.kept_rates[block_state[c]] != 0.0:
            return False
    return True


def recall_rates(block: int, xdot: Vec[NX], lam: Vec[NC], w: Work) -> None:
    """Take the rates of a block that is kept."""
    for c in range(state_begin[block], state_end[block]):
        xdot[block_state[c]] = w.contacts.kept_rates[block_state[c]]
    for k in range(NC):
        if equation_block[k] == block:
            lam[k] = w.contacts.kept_lam[k]


def recall_forces(block: int, w: Work) -> None:
    """Take the forces of a block that is kept, and clear w.contacts.touched of its contacts."""
    for c in range(contact_begin[block], contact_end[block]):
        i = block_contact[c]
        if w.contacts.touched[i] > 0:
            w.contacts.touched[i] = 0
            for row in range(contact_first[i], contact_first[i] + contact_slips[i] + 1):
                w.contacts.forces[row] = w.contacts.kept_forces[row]
                w.contacts.pushes[row] = w.contacts.kept_pushes[row]


def recall_blocks(x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> bool:
    """Recall blocks whose states have not changed, as those at rest. Return whether contacts of others
    touch."""
    if w.contacts.keeps:
        for block in range(NBLOCK):
            if is_kept(block, x, w):
                recall_rates(block, xdot, lam, w)
                recall_forces(block, w)
    for i in range(NCON):
        if w.contacts.touched[i] > 0:
            return True
    return False


def forget_blocks(w: Work) -> None:
    """Forget the forces of all blocks."""
    for block in range(NBLOCK):
        w.contacts.known[block] = 0


def keep_blocks(keeps: bool, w: Work) -> None:
    """Let evaluations within a step keep what they solve, or no longer."""
    w.contacts.flies = False
    w.contacts.keeps = keeps
    # Outside of a step modes of relations, signs, directions and impulses may change, which are not compared.
    if NPLAIN > 0 or NTWO > 0 or NSPACE > 0 or NIMPULSE > 0:
        forget_blocks(w)


def keep_blocks_at_rest(keeps: bool, w: Work) -> None:
    """Let evaluations beside a step keep what they solve, or no longer, if states and modes of contacts tell
    all that it depends on."""
    if NPLAIN > 0 or NTWO > 0 or NSPACE > 0 or NIMPULSE > 0:
        keep_blocks(False, w)
    else:
        keep_blocks(keeps, w)
