"""Forward selection by BIC as a textbook has it: the column that lowers the criterion most comes in, until none does.

Data, windows and columns are those of `bic.py`; what makes that one strong is left out: refits of the best few before one is
chosen, pictures compared at one lattice, ties named beside the winner, a second look at what came in earlier.
Burnham and Anderson, *Model Selection and Multimodel Inference*, Springer 2002, section 6.4; `step` of R with k = log n.
"""

from . import bic, counts
from .data import CLOCK
from .windows import Model, changed, value_of

MOST = 6  # effects, as many as the product names


def select(search):
    """(model, its linearisation, effects in the order found)."""
    data = search.data
    model, linear, value = search.settle(Model(data.plant, data.camera, search.windows.guess(data.camera)), [])
    chosen = []
    while len(chosen) < MOST:
        promised, effect, at = search.screen(linear, chosen)[0]
        if promised >= value:
            break
        found = search.settle(changed(model, effect, at), [*chosen, effect])
        if found[2] >= value:
            break  # the fit doesn't keep what the column promised
        chosen.append(effect)
        model, linear, value = found
    return model, linear, chosen


def diagnose(data):
    """[(names, value, standard error, None)] in the order found."""
    search = bic.Search(data)
    model, linear, chosen = select(search)
    errors = bic.standard_errors(linear, chosen, search.off)
    found = [([e.name], value_of(model, e), errors.get(e), None) for e in chosen if e is not CLOCK]
    return found + [([e.name], value, None, None) for e, value, _ in counts.extras(data, model.camera)]
