"""States that the explorer's page can come to."""

from hypothesis import strategies as st

from susp_ss.explorer.state import MODELS, NOTHING, OPTIONAL
from susp_ss.explorer.table import Number


@st.composite
def states(draw, explorer=NOTHING, models=MODELS):
    """Any state that the page can come to."""
    model = draw(st.sampled_from(models))
    state = explorer.default(model)
    for table in OPTIONAL:
        rows = [row for row in explorer.tables[model] if row.table == table]
        if rows and draw(st.booleans()):
            state[table] = {row.key: row.default for row in rows}
    for row in explorer.tables[model]:
        part = state[row.table] if row.table else state
        if part is None or not draw(st.booleans()):
            continue
        if isinstance(row, Number):
            part[row.key] = row.plain(draw(st.floats(row.least, row.most)))
            continue
        options = [option for option in row.options if state["seat"] or option not in row.seated]
        one = st.sampled_from(options)
        part[row.key] = draw(st.lists(one, min_size=1, unique=True) if row.several else one)
    return state
