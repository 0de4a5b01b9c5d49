"""Tables of a model: constant arrays in the generated code."""

from lagc.kernels.language.sizes import *
from lagc.kernels.language.words import IVec, Mat

scaling_group: IVec[NX]  # of each coordinate and speed; group 0: angles and other numbers without unit
quaternion: IVec[NQUAT]  # first index in x of each unit quaternion
level: IVec[NU]  # how firmly each unknown of the start is stated
unit: IVec[NU]
angle: IVec[NU]  # 1: of an angle
massless: IVec[NU]  # 1: a speed without inertia
ends: IVec[NE]  # where the derivatives of each condition end
stretch_begins: IVec[NSTRETCH]  # the unknowns of these, condition by condition, where they follow each other
stretch_ends: IVec[NSTRETCH]  # behind the last
part_ends: IVec[NPARTED]  # the same by unknowns and sums: of each condition, then of each sum
part_column: IVec[NPARTS]  # an unknown, or behind these a sum
sources: IVec[NREAD]  # indices of the parameters that `bind` reads
has_unit: IVec[NP]  # 1: a parameter or input with a unit
bounded: IVec[NBOUNDED]  # indices of the parameters that have bounds
bounds: Mat[NBOUNDED, TWO]  # lower and upper bound of each
has_edges: IVec[NMODE]  # 1: a stepwise relation, whose mode changes at edges; 0: it changes at zero
enclosed_state: IVec[NENCLOSED]  # the coordinates and speeds that bounds in a box depend on, as indices of x
clauses_only: IVec[NMODE]  # 1: clauses `when` alone ask for this relation
terminates: IVec[NWHEN]  # 1: this clause ends the run
reinit_clause: IVec[NJUMP]  # the clause that assigns each value
reinit_target: IVec[NJUMP]  # the state that it is assigned to
derived_bounds: Mat[NLIMITS, TWO]  # bounds of values computed from parameters
loading_row: IVec[NLOADED]  # the constraint equations whose multipliers loads depend on
load_held: IVec[NLOADED]  # 1: an actuator holds this equation, and its gradient does not act
pushed_contact: IVec[NPUSHED]  # the contacts whose normal forces loads depend on
block_contact: IVec[NCON]  # the contacts, block by block
contact_begin: IVec[NBLOCK]  # where those of each block begin in `block_contact`
contact_end: IVec[NBLOCK]
block_speed: IVec[NV]  # the speeds, block by block, then those that no contact moves
speed_begin: IVec[NBLOCK]
speed_end: IVec[NBLOCK]
block_state: IVec[NMOVED]  # the coordinates and speeds, as indices of x, in the same way
state_begin: IVec[NBLOCK]
state_end: IVec[NBLOCK]
block_timed: IVec[NBLOCK]  # 1: its motion depends on time itself
contact_block: IVec[NCON]  # the block of each contact
row_block: IVec[NCROW]  # that of each row of a contact
equation_block: IVec[NC]  # that of each constraint equation; -1: no contact acts on it
contact_first: IVec[NCON]  # first row of each contact, that of its gap; its slip rows follow
impulse_state: IVec[NCON]  # index in x of the impulse of the last impact of each; -1: it is not asked for
contact_slips: IVec[NCON]  # slip rows of each
contact_unit: IVec[NCON]  # unit of each gap: the first contact with this unit
contact_normals: IVec[NCON]  # components of the normal force of a two-sided contact; 0: one-sided
normal_first: IVec[NCON]  # first of these
contact_bounds_rate: IVec[NCON]  # 1: its gap is one between velocities
contact_poisson: IVec[NCON]  # 1: Poisson's law of impact, 0: Newton's
