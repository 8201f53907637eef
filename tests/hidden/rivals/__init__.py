"""Rivals of the product's diagnosis: what a competent user would make of common tools in a day.

`sindy.py` is a pySINDy discrepancy fit, `bic.py` a plain search by BIC. Both read the same folders as the product does,
know the nominal model through this program's own machine and camera (`../dynamics.py`, `../camera.py`) and the list of
effects by name, and never see an answer. See ../README.md.
"""
