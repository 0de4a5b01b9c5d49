"""The names that all kernels share."""

from lagc.kernels.language.contact_law import *
from lagc.kernels.language.model_functions import *
from lagc.kernels.language.model_tables import *
from lagc.kernels.language.parameters import *
from lagc.kernels.language.records import *
from lagc.kernels.language.sizes import *
from lagc.kernels.language.state_vectors import *
from lagc.kernels.language.statuses import *
from lagc.kernels.language.tableau import *
from lagc.kernels.language.tolerances import *
from lagc.kernels.language.trial import *
from lagc.kernels.language.verification import *
from lagc.kernels.language.words import *
