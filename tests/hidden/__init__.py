"""Independent maker of blind test data for the diagnosis.

Shares no code and no numerics with the product: written from the paper and from `docs/` (formats, conventions, claims) only.
See README.md in this folder.
"""
