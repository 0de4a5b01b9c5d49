"""Flight: steps in which no contact touches but those of blocks at rest."""

from lagc.kernels.contact.kept_blocks import is_at_rest, is_kept, recall_forces
from lagc.kernels.contact.touching import find_touching, forget_forces, sample_forces
from lagc.kernels.language.vocabulary import *


def begin_flight(x: Vec[NX], implicit: bool, w: Work) -> None:
    """If no contact touches at the beginning of a step, but those of blocks at rest, let its evaluations look
    for no others: neither the modes in x nor the states of these blocks change within it. Iterations of an
    implicit step do change these states."""
    w.contacts.touches = find_touching(x, w)
    w.contacts.constant_count = 0
    if w.contacts.touches and (implicit or size(NLOADED) > 0):
        return
    for r in range(NCROW):
        w.contacts.forces[r] = 0.0
        w.contacts.pushes[r] = 0.0
    for i in range(NCON):
        if w.contacts.touched[i] > 0:
            block = contact_block[i]
            if not (is_kept(block, x, w) and is_at_rest(block, w)):
                return
            recall_forces(block, w)
            w.contacts.constant[w.contacts.constant_count] = block
            w.contacts.constant_count += 1
    find_touching(x, w)  # recalled blocks were taken off the list
    forget_forces(w)
    sample_forces(w)
    w.contacts.flies = True
