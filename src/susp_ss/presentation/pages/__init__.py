"""Web pages of a study and of a fit: one file each, that opens from disk without a network.

The flow is a result -> ``figures`` (what plotly draws, as plain dicts) and tables -> a template -> ``page.render``.
"""
