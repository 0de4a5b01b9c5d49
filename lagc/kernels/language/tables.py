"""What the kernels know of a model besides sizes: constant arrays in the generated code."""

from __future__ import annotations

from lagc.kernels.language.sizes import (
    NBOUNDED,
    NE,
    NJUMP,
    NLIMITS,
    NMODE,
    NPARTED,
    NPARTS,
    NQUAT,
    NREAD,
    NSTRETCH,
    NU,
    NWHEN,
    NX,
    TWO,
)
from lagc.kernels.language.words import IVec, Mat

group: IVec[NX]  # of each coordinate and speed: those of one unit share a size; 0 are the angles
quaternion: IVec[NQUAT]  # where each begins in x
level: IVec[NU]  # how firmly each unknown of the start is stated
unit: IVec[NU]
angle: IVec[NU]  # 1: of an angle
row_piece: IVec[NE]  # that makes each condition; -1: none, or one of a unit quaternion
ends: IVec[NE]  # where the derivatives of each condition end
stretch_begins: IVec[NSTRETCH]  # the unknowns of these, condition by condition, where they follow each other
stretch_ends: IVec[NSTRETCH]  # behind the last
part_ends: IVec[NPARTED]  # the same by unknowns and sums: of each condition, then of each sum
part_column: IVec[NPARTS]  # an unknown, or behind these a sum
sources: IVec[NREAD]  # the places of parameters that `bind` reads
bounded: IVec[NBOUNDED]  # the places of parameters that have bounds
bounds: Mat[NBOUNDED, TWO]  # least and largest
has_edges: IVec[NMODE]  # 1: a switch that changes at the edges of its mode, else at zero
terminates: IVec[NWHEN]  # 1: this clause ends the run
reinit_clause: IVec[NJUMP]  # to which a new value belongs
reinit_target: IVec[NJUMP]  # the state that takes it
derived_bounds: Mat[NLIMITS, TWO]  # the same of values made of parameters
